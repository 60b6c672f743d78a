"""The numbers of the figures against closed forms."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.model.body import Environment
from omni_vehicle_ros.model.steady_turn import steady_turn
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.thesis.claims.disturbances import held_bank
from omni_vehicle_ros.thesis.claims.vehicle import nearest_icr
from omni_vehicle_ros.thesis.disturbances import friction
from omni_vehicle_ros.thesis.drive import FOUR, FRONT, REAR, STRAIGHT, driven
from omni_vehicle_ros.thesis.tasks import Run, run
from omni_vehicle_ros.thesis.traction import BRAKE, TRACTION

LONG_CYCLE = ('plant.control_period=0.02',)
PLAIN = ('vehicle.front_roll_steer=0.0', 'vehicle.rear_roll_steer=0.0')
MASS, G, C, LF, LR = 1298.9, 9.81, 30000.0, 1.0, 1.454


def short(task: Run, duration: float, *settings_: str) -> Run:
    return Run(task.scenario, (*task.settings, f'duration={duration}', *LONG_CYCLE, *settings_))


@pytest.mark.parametrize(
    ('scenario', 'force', 'kilometres_per_hour'), [(TRACTION, 500.0, 11.1), (BRAKE, 1000.0, 22.2)]
)
def test_speed_on_the_straight_is_force_times_time(scenario: str, force: float, kilometres_per_hour: float) -> None:
    """Fig. 4.14 and 4.17: 4 F t / m. The wheels hold the vehicle below 0.02 m/s, which costs next to nothing."""
    speed = short(run(scenario), 7.0).work().vx[-1]
    assert speed == pytest.approx(4.0 * force * 2.0 / MASS, rel=1e-3)
    assert 3.6 * speed == pytest.approx(kilometres_per_hour, abs=0.05)


def test_two_driven_wheels_pull_half() -> None:
    """Fig. 4.51."""
    speeds = [short(driven(STRAIGHT, drive), 7.0).work().vx[-1] for drive in (FOUR, FRONT, REAR)]
    assert speeds[1] == pytest.approx(speeds[2], rel=1e-9)
    assert speeds[0] == pytest.approx(2.0 * speeds[1], rel=1e-3)


def test_steer_angles_are_those_of_the_closed_form() -> None:
    """Fig. 4.33: atan2(x - xc, yc - y) about (0, 10) m."""
    recording = short(friction(0.9), 0.1).work()
    places = ((LF, 0.718), (LF, -0.718), (-LR, 0.718), (-LR, -0.718))
    assert recording.steer_angle[-1] == pytest.approx([math.atan2(x, 10.0 - y) for x, y in places], abs=1e-12)


@pytest.mark.parametrize('speed', [20, 80])
def test_slip_on_a_bank(speed: int) -> None:
    """Fig. 4.19-4.24: both axles hold m g sin b / (1 + A v2) by their moments, A = m (lr - lf) / (2 C l2)."""
    task = held_bank(0.01, speed)
    recording = short(task, 6.0, *PLAIN).work()
    length = LF + LR
    held = MASS * G * math.sin(0.01) / (1.0 + MASS * (LR - LF) / (2.0 * C * length**2) * recording.vx[0] ** 2)
    front, rear = held * LR / (2.0 * C * length), held * LF / (2.0 * C * length)
    assert recording.side_slip[-1] == pytest.approx([-front, -front, -rear, -rear], rel=2e-3)
    assert sum(recording.side_slip[-1]) / 4.0 == pytest.approx(-held / (4.0 * C), rel=2e-3)


def test_where_an_aerodynamic_centre_ahead_stops_doing_harm() -> None:
    """Without roll steer the front slip does not depend on it at v2 = 2 C l / m; below it grows, above it falls."""
    vehicle = VehicleParameters(front_roll_steer=0.0, rear_roll_steer=0.0)
    ahead, wind = replace(vehicle, aerodynamic_centre=0.1), Environment(wind=2.0)
    neutral = math.sqrt(2.0 * C * (LF + LR) / MASS)

    def gain(speed: float) -> float:
        one, other = (steady_turn(body, math.inf, speed, wind) for body in (ahead, vehicle))
        assert one is not None
        assert other is not None
        return abs(one.side_slip[0]) / abs(other.side_slip[0]) - 1.0

    assert gain(neutral) == pytest.approx(0.0, abs=1e-4)
    assert gain(0.5 * neutral) > 0.01
    assert gain(2.0 * neutral) < -0.01


@given(track=st.floats(0.8, 3.0), x=st.floats(-3.0, 3.0))
@settings(max_examples=20, deadline=None)
def test_the_nearest_turn_centre_is_half_a_track_away(track: float, x: float) -> None:
    vehicle = VehicleParameters(front_track=track, rear_track=track)
    assert nearest_icr(vehicle, x) == pytest.approx(0.5 * track, abs=1e-5)
