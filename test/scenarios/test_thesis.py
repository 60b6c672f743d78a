"""The scenarios of the package: each of them drives, and those of the thesis do what its chapters 4 and 5 say."""

import math

import numpy as np
import pytest

from omni_vehicle_ros.analysis.troubles import troubles
from omni_vehicle_ros.bags import Bag
from omni_vehicle_ros.scenarios import load_scenario, scenario_names, variants
from omni_vehicle_ros.simulation import record

THESIS = {
    'small_radius', 'turning_map', 'speed_loss', 'speed_loss_map', 'traction_in_turn', 'brake_in_turn', 'bank', 'wind',
    'friction', 'load_transfer', 'roll_steer', 'drive_straight', 'drive_in_turn', 'side_slip_control',
}  # fmt: skip
MASS, YAW_INERTIA = 1298.9, 1627.0
X, Y = np.array([1.0, 1.0, -1.454, -1.454]), np.array([0.718, -0.718, 0.718, -0.718])

# Every command of the thesis begins in a cycle of this length [s]; the integration inside it stays as fine as it is.
PERIOD = 0.02
LONG_CYCLE = f'plant.control_period={PERIOD}'

# The wheels of a vehicle at standstill are held up to 0.02 m/s, which costs an impulse of less than 1 N s.
HOLD = 1.0 / MASS


def at(time: float) -> int:
    return round(time / PERIOD)


@pytest.fixture(scope='module')
def traction() -> Bag:
    """Return the drive from rest into a turn with traction, up to the middle of the second traction."""
    return record(load_scenario('thesis/traction_in_turn', ['duration=16.0', LONG_CYCLE]))


def test_all_of_them_are_there() -> None:
    assert {name.removeprefix('thesis/') for name in scenario_names() if name.startswith('thesis/')} == THESIS


@pytest.mark.parametrize('name', scenario_names())
def test_every_scenario_drives(name: str) -> None:
    bag = record(load_scenario(name, ['duration=0.2']))
    odom = bag['odom']
    assert odom.stamp[-1] == pytest.approx(0.2)
    assert all(np.all(np.isfinite(column)) for column in (odom.x, odom.y, odom.vx, odom.vy, odom.yaw_rate))
    assert np.all(np.isfinite(bag['tyres/side_slip'].position))
    assert troubles(bag) == []


@pytest.mark.parametrize('name', sorted(THESIS))
def test_it_says_where_in_the_thesis_it_is_and_has_nothing_that_the_thesis_lacks(name: str) -> None:
    scenario = load_scenario(f'thesis/{name}')
    assert 'Fig. ' in scenario.description
    steering = scenario.steering
    assert (steering.steering_rule, steering.acceleration_limit, steering.motion_rate_limit) == ('road', 0.0, 0.0)
    assert not steering.alignment_slowdown
    assert scenario.wheel_module.ideal_actuators is (name != 'side_slip_control')
    assert scenario.vary
    for point, variant in variants(f'thesis/{name}'):
        assert set(point) == set(scenario.vary)
        assert variant.duration == scenario.duration


def test_500_n_on_four_wheels_for_2_s_give_3_08_m_s(traction: Bag) -> None:
    """Thesis sec. 4.3.1: 11.16 km/h; by Newton 4 x 500 N x 2 s / 1298.9 kg."""
    odom = traction['odom']
    assert np.all(odom.vx[: at(4.0) + 1] == 0.0)
    assert 3.0795 - HOLD < odom.vx[at(6.0)] < 4 * 500.0 * 2.0 / MASS
    assert np.all(odom.vx[at(6.0) : at(10.0) + 1] == odom.vx[at(6.0)])
    assert np.all(odom.y[: at(10.0)] == 0.0)


def test_1000_n_on_four_wheels_for_2_s_give_6_16_m_s() -> None:
    odom = record(load_scenario('thesis/brake_in_turn', ['duration=6.0', LONG_CYCLE]))['odom']
    assert 6.159 - HOLD < odom.vx[-1] < 4 * 1000.0 * 2.0 / MASS


def test_speed_after_a_straight_start_grows_with_the_number_of_driven_wheels() -> None:
    """Thesis Fig. 4.51: 1000 N on two wheels, front or rear, and on four."""
    speeds = {}
    for point, scenario in variants('thesis/drive_straight', ['duration=6.0', LONG_CYCLE]):
        speeds[tuple(point['drive_shares'])] = float(record(scenario)['odom'].vx[-1])
    front, rear, four = speeds.values()
    assert front == rear
    for speed, wheels in ((front, 2), (four, 4)):
        assert 0.0 < wheels * 1000.0 * 2.0 / MASS - speed < HOLD


def test_steer_angles_jump_at_10_s_and_hold_during_traction(traction: Bag) -> None:
    angles = traction['joint_states'].position[:, :4]
    turned = np.arctan2(X, 5.0 - Y)
    assert np.all(angles[: at(10.0) + 1] == 0.0)
    np.testing.assert_allclose(angles[at(10.0) + 1 :], np.tile(turned, (at(6.0), 1)), rtol=0.0, atol=1e-12)


def test_forces_act_between_their_times_and_are_those_of_the_wheels(traction: Bag) -> None:
    forces, time = traction['tyres/force'].forces[:, :, 0], traction['tyres/force'].stamp
    moving = (time > 4.1) & (time < 5.999) | (time > 15.01)
    np.testing.assert_allclose(forces[moving], 500.0, rtol=1e-9)
    idle = (time <= 4.0) | (time > 6.0) & (time <= 15.0)
    assert np.all(forces[idle] == 0.0)


def test_traction_is_per_driven_wheel() -> None:
    for point, scenario in variants('thesis/drive_in_turn'):
        driven = sum(share > 0.0 for share in point['drive_shares'])
        assert [command.traction for command in scenario.commands] == [0.0, 500.0 * driven, 0.0]
        assert scenario.plant.initial_speed == pytest.approx(4 * 500.0 * 2.0 / MASS, abs=0.005)
    brake = load_scenario('thesis/brake_in_turn').commands[4]
    assert (brake.at, brake.traction) == (15.0, -2000.0)


@pytest.mark.parametrize('radius', [5.0, 10.0])
def test_a_turn_without_drive_only_loses_energy(radius: float) -> None:
    odom = record(load_scenario('thesis/speed_loss', ['duration=3.0', f'radius={radius}']))['odom']
    energy = 0.5 * MASS * (odom.vx**2 + odom.vy**2) + 0.5 * YAW_INERTIA * odom.yaw_rate**2
    assert odom.vx[0] == 6.2
    assert np.all(np.diff(energy) < 0.0)


MIRRORED = [
    ('small_radius', 'radius', '2.0', ['duration=1.0']),
    ('speed_loss', 'radius', '5.0', ['duration=1.0']),
    ('bank', 'bank', '0.02', ['duration=11.0', LONG_CYCLE]),
    ('wind', 'wind', '2.0', ['duration=11.0', LONG_CYCLE, 'aerodynamic_centre=0.1']),
]


@pytest.mark.parametrize(('name', 'value', 'left', 'overrides'), MIRRORED)
def test_the_mirrored_scenario_drives_the_mirrored_path(
    name: str, value: str, left: str, overrides: list[str]
) -> None:
    one, other = (
        record(load_scenario(f'thesis/{name}', [f'{value}={sign}{left}', *overrides])) for sign in ('', '-')
    )
    assert np.ptp(one['odom'].y) > 1e-4
    np.testing.assert_allclose(one['odom'].x, other['odom'].x, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(one['odom'].y, -other['odom'].y, rtol=0.0, atol=1e-9)
    slip = one['tyres/side_slip'].position
    np.testing.assert_allclose(slip, -other['tyres/side_slip'].position[:, [1, 0, 3, 2]], rtol=0.0, atol=1e-9)


@pytest.mark.parametrize('name', ['bank', 'wind'])
def test_a_disturbance_acts_from_10_to_12_s(name: str) -> None:
    bag = record(load_scenario(f'thesis/{name}', ['duration=12.5', LONG_CYCLE]))
    topic = bag[f'environment/{name}']
    values = topic.x if name == 'bank' else topic.y
    assert list(zip(topic.stamp.tolist(), values.tolist(), strict=True)) == [
        (0.0, 0.0), (10.0, {'bank': 0.01, 'wind': 2.0}[name]), (12.0, 0.0)
    ]
    assert np.all(bag['tyres/side_slip'].position[: at(10.0)] == 0.0)
    assert np.all(np.abs(bag['tyres/side_slip'].position[at(11.9)]) > 1e-6)


def test_side_slip_control_begins_with_the_step_of_the_steer_angles() -> None:
    """The exact loop starts at delta0 / (1 + K), with delta0 the angle of the front left wheel at R = 5 m."""
    step = math.atan2(1.0, 5.0 - 0.718)
    exact = ['wheel_module.ideal_actuators=true', 'plant.control_period=0.001', 'duration=0.002']
    level = ['vehicle.front_roll_steer=0', 'vehicle.rear_roll_steer=0']
    for point, scenario in variants('thesis/side_slip_control', [*exact, *level]):
        assert scenario.plant.initial_speed * 3.6 == pytest.approx(15.0, abs=1e-3)
        slip = record(scenario)['tyres/side_slip'].position[:, 0]
        # It dies away at about 10 1/s, so that a straight line back from 1 and 2 ms misses (10 1/s x 1 ms)^2 of it.
        assert 2.0 * slip[1] - slip[2] == pytest.approx(step / (1.0 + point['gains'][0]), rel=1e-3)
