"""The sampled side-slip controller with its actuators tends to the exact algebraic form (thesis, chapter 5)."""

import numpy as np
import pytest

from omni_vehicle_ros.control.actuator import SteerActuator
from omni_vehicle_ros.control.side_slip import SideSlipController
from omni_vehicle_ros.control.trim import Sensed
from omni_vehicle_ros.model.body import Environment, Inputs, evaluate
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.kinematics import Icr, road_steer_angles
from omni_vehicle_ros.model.plant import advance
from omni_vehicle_ros.model.state import initial_state
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters, WheelModuleParameters
from omni_vehicle_ros.wheels import per_wheel

VEHICLE = VehicleParameters()
MODEL = constants(VEHICLE)
ROAD, NONE = Environment(), (0.0, 0.0, 0.0, 0.0)
GAINS = (5.0, 5.0, 0.0, 0.0)
SPEED, TURN = 15.0 / 3.6, road_steer_angles(Icr(0.0, 5.0), VEHICLE)
RAMP = 0.5  # s, in which the set-points go into the turn
SAMPLE = 0.1  # s, from one comparison to the next

# The default actuator, but for a rate limit that is never reached; all times shrink together.
DELAY, TIME_CONSTANT, CYCLE = 0.005, 0.1, 0.005


def set_points(time):
    return per_wheel(lambda i: TURN[i] * min(time / RAMP, 1.0))


def sampled(scale, duration):
    """Return the states every `SAMPLE`, shape (n, 10), and the slips at the end."""
    period = CYCLE * scale
    module = WheelModuleParameters(
        steer_delay=DELAY * scale, steer_time_constant=TIME_CONSTANT * scale, steer_rate_limit=100.0
    )
    actuators = [SteerActuator(module) for _ in range(4)]
    controller = SideSlipController(SideSlipParameters(proportional_gains=GAINS))
    state, angles, states = initial_state(SPEED), NONE, [initial_state(SPEED)]
    for cycle in range(round(duration / period)):
        stamp = round(cycle * period * 1e9)
        slip = evaluate(state, Inputs(angles), ROAD, MODEL, True).side_slip
        trims = controller.update(stamp, Sensed(side_slip=slip, wheel_speed=(SPEED,) * 4)).steer_angle
        wanted = set_points(cycle * period)
        motions = [actuators[i].update(stamp, wanted[i] + trims[i], period) for i in range(4)]
        angles, rates = zip(*motions, strict=True)
        state = advance(state, angles, rates, NONE, ROAD, MODEL, period, 0.001, True)
        angles = tuple(angle + rate * period for angle, rate in motions)
        if (cycle + 1) % round(SAMPLE / period) == 0:
            states.append(state)
    return np.array(states), evaluate(state, Inputs(angles), ROAD, MODEL, True).side_slip


def exact(duration):
    state, states = initial_state(SPEED), [initial_state(SPEED)]
    for number in range(round(duration / SAMPLE)):
        begin = np.array(set_points(number * SAMPLE))
        rates = (np.array(set_points((number + 1) * SAMPLE)) - begin) / SAMPLE
        state = advance(state, begin, rates, NONE, ROAD, MODEL, SAMPLE, 0.001, True, GAINS)
        states.append(state)
    return np.array(states), evaluate(state, Inputs(TURN, slip_gain=GAINS), ROAD, MODEL, True).side_slip


def test_half_the_time_constant_and_period_leave_half_the_error():
    """Of vy, r and the pose, all along the way into the turn; (1 + K) dt / tau = 0.3 throughout."""
    reference = exact(1.5)[0][:, 1:6]
    paths = [sampled(scale, 1.5)[0][:, 1:6] for scale in (0.25, 0.125, 0.0625)]
    errors = np.array([np.abs(path - reference).max(axis=0) for path in paths])
    assert (errors[0] > 1e-4).all()
    assert errors[:-1] / errors[1:] == pytest.approx(np.full((2, 5), 2.0), rel=0.06)


def test_the_steady_turn_is_the_same_with_any_actuator():
    assert sampled(1.0, 4.0)[1] == pytest.approx(exact(4.0)[1], abs=1e-7)
