import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.model import traction
from omni_vehicle_ros.model.traction import brake_forces, share_force, within_grip, yaw_moment_forces
from omni_vehicle_ros.parameters import VehicleParameters

quiet = settings(deadline=None, max_examples=60, derandomize=True)


@pytest.mark.parametrize('drive', ['FOUR_WHEEL_DRIVE', 'FRONT_WHEEL_DRIVE', 'REAR_WHEEL_DRIVE'])
def test_shares_give_the_whole_force(drive):
    assert sum(share_force(2000.0, getattr(traction, drive))) == pytest.approx(2000.0)


@quiet
@given(st.floats(-5000.0, 5000.0))
def test_left_right_difference_makes_the_moment_and_no_net_force(moment):
    vehicle = VehicleParameters(rear_track=1.2)
    forces = yaw_moment_forces(moment, vehicle)
    assert sum(forces) == 0.0
    made = -sum(y * force for y, force in zip(vehicle.wheel_y, forces, strict=True))
    assert made == pytest.approx(moment)


def test_forces_stay_within_the_grip():
    assert within_grip((5000.0, -5000.0, 100.0, 5.0), (3000.0, 3000.0, 3000.0, 0.0), (0.5,) * 4) == (
        1500.0,
        -1500.0,
        100.0,
        0.0,
    )


@quiet
@given(st.floats(-30.0, 30.0), st.floats(0.0, 5000.0), st.floats(0.001, 0.1))
def test_brake_opposes_and_never_reverses(speed, brake, period):
    mass = 1298.9
    forces = brake_forces((brake,) * 4, (speed,) * 4, mass, period)
    after = speed + sum(forces) / mass * period
    assert all(force * speed <= 0.0 and abs(force) <= brake for force in forces)
    assert after * speed >= 0.0
    assert abs(after) <= abs(speed)
