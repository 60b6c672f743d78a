"""What the tests of the control share: a vehicle with its four modules, closed over the model's plant."""

import math

import pytest

from omni_vehicle_ros.control.controllers import make_controller
from omni_vehicle_ros.control.icr_steering import IcrSteering
from omni_vehicle_ros.control.trim import Sensed
from omni_vehicle_ros.control.wheel_module import Setpoint, Trim, WheelModule
from omni_vehicle_ros.messages import Point, Twist
from omni_vehicle_ros.model.body import Environment, Inputs, evaluate
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.kinematics import Twist as Motion
from omni_vehicle_ros.model.plant import advance
from omni_vehicle_ros.model.state import initial_state, state_view
from omni_vehicle_ros.parameters import SideSlipParameters, SteeringParameters, VehicleParameters, WheelModuleParameters
from omni_vehicle_ros.wheels import per_wheel

PERIOD = 0.005


class ClosedLoop:
    """ICR steering, four wheel modules, the controller of side slip and the plant, in lock step.

    All but the plant know the default vehicle; the plant may be another one.
    """

    def __init__(
        self, steering=None, module=None, slip=None, speed=0.0, bank=0.0, constant_speed=False, plant=None, friction=0.9
    ):
        self.vehicle = VehicleParameters()
        self.icr_steering = IcrSteering(self.vehicle, steering or SteeringParameters(), PERIOD)
        slip = slip or SideSlipParameters(proportional_gains=(0.0,) * 4)
        self.modules = [WheelModule(module or WheelModuleParameters(), PERIOD, slip.trim_limit) for _ in range(4)]
        self.slip = make_controller(slip, self.vehicle)
        self.environment = Environment(bank=bank, friction=(friction,) * 4)
        self.constant_speed = constant_speed
        self.constants, self.vector = constants(plant or self.vehicle), initial_state(speed)
        self.angles = self.forces = (0.0,) * 4
        self.now, self.commanded = 0, True

    @property
    def state(self):
        return state_view(self.vector)

    def drive(self, speed, icr=None):
        if icr is not None:
            self.icr_steering.icr(Point(self.now, *icr), self.now)
        self.icr_steering.speed(Twist(self.now, speed), self.now)

    def twist(self, vx, vy=0.0, yaw_rate=0.0):
        self.icr_steering.cmd_vel(Twist(self.now, vx, vy, yaw_rate), self.now)

    def cycle(self):
        state, x, y = self.state, self.vehicle.wheel_x, self.vehicle.wheel_y
        ahead = per_wheel(lambda i: state.vx - y[i] * state.r)
        left = per_wheel(lambda i: state.vy + x[i] * state.r)
        speeds = per_wheel(lambda i: math.cos(self.angles[i]) * ahead[i] + math.sin(self.angles[i]) * left[i])
        inputs = Inputs(self.angles, self.forces)
        self.seen = evaluate(self.vector, inputs, self.environment, self.constants, self.constant_speed)
        radius = self.vehicle.wheel_radius
        spin = per_wheel(lambda i: speeds[i] / radius)
        self.setpoints = self.icr_steering.update(self.now, self.angles, spin)
        torque = per_wheel(lambda i: self.forces[i] * radius)
        motion, ay, commanded = Motion(state.vx, state.vy, state.r), self.seen.ay, self.setpoints.twist
        sensed = Sensed(self.seen.side_slip, speeds, self.angles, torque, motion, ay, commanded)
        self.trims = self.slip.update(self.now, sensed)
        doing = [self._module(i, spin[i]) for i in range(4)]
        angle, rate = per_wheel(lambda i: doing[i].steer_angle), per_wheel(lambda i: doing[i].steer_rate)
        self.forces = per_wheel(lambda i: doing[i].drive_torque / radius)
        self.vector = advance(
            self.vector, angle, rate, self.forces, self.environment, self.constants, PERIOD, 0.001, self.constant_speed
        )
        self.angles = per_wheel(lambda i: angle[i] + PERIOD * rate[i])
        self.now += round(PERIOD * 1e9)

    def _module(self, i, spin):
        module, wanted = self.modules[i], self.setpoints
        if self.commanded:
            module.command(Setpoint(self.now, wanted.steer_angle[i], wanted.wheel_speed[i], wanted.torque[i]))
            module.trim(Trim(self.now, self.trims.steer_angle[i], self.trims.torque[i]))
        return module.update(self.now, spin)

    def run(self, duration, command=lambda: None):
        """Go on for so long, commanded in every cycle; yield after each."""
        for _ in range(round(duration / PERIOD)):
            command()
            self.cycle()
            yield self.state


@pytest.fixture
def closed_loop():
    return ClosedLoop
