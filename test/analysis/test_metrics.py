import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from omni_vehicle_ros.analysis import compute_metrics
from omni_vehicle_ros.analysis.metrics import path_radius
from omni_vehicle_ros.analysis.topics import friction
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.model.tyres.dugoff import second_critical_slip
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.scenarios.scenario import make_scenario
from omni_vehicle_ros.simulation import record
from omni_vehicle_ros.wheels import WHEELS

Motions = Callable[..., Any]
Write = Callable[[Any], Any]
CAR = VehicleParameters()
UNKNOWN_LIMIT = {'limit_speed': None, 'limit_cause': None}


@pytest.mark.parametrize(('radius', 'speed'), [(10.0, 5.0), (-8.0, 3.0), (12.0, -2.0), (-6.0, -1.0)])
def test_a_circle(motion: Motions, bag_of: Write, radius: float, speed: float) -> None:
    metrics = compute_metrics(bag_of(motion(4.0, radius, speed)))
    assert metrics['path']['radius'] == pytest.approx(radius)
    assert metrics['yaw_rate']['steady_state'] == pytest.approx(speed / radius)
    assert metrics['speed'] == {'initial': speed, 'final': speed, 'ratio': 1.0}
    angle = 4.0 * speed / radius
    x, y, heading = metrics['path']['final']
    assert (x, y) == (pytest.approx(radius * math.sin(angle)), pytest.approx(radius * (1.0 - math.cos(angle))))
    assert math.remainder(heading - angle, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)
    assert metrics['side_slip']['front_left'] == {
        'steady_state': pytest.approx(0.04), 'peak': 0.04, 'overshoot': 0.0, 'settling_time': 0.0}
    assert metrics['friction_use']['rear_right'] == {'peak': pytest.approx(0.1)}
    assert metrics['load']['rear_left'] == {'minimum': 3000.0}
    assert metrics['steady'] == {'reached': True, 'reason': None, **UNKNOWN_LIMIT}


def test_keys_and_types_survive_json(motion: Motions, bag_of: Write) -> None:
    metrics = compute_metrics(bag_of(motion()))
    assert json.loads(json.dumps(metrics, allow_nan=False)) == metrics
    assert set(metrics['side_slip']) == set(WHEELS)
    figures = {'steady_state', 'peak', 'overshoot', 'settling_time'}
    assert all(set(slip) == figures for slip in metrics['side_slip'].values())
    assert set(metrics['speed']) == {'initial', 'final', 'ratio'}
    assert set(metrics['path']) == {'final', 'radius'}


def test_from_rest_there_is_no_speed_ratio(motion: Motions, bag_of: Write) -> None:
    start = motion()
    start.vx = np.minimum(start.time, 2.0)
    assert compute_metrics(bag_of(start))['speed'] == {'initial': 0.0, 'final': 2.0, 'ratio': None}


def test_straight_on_has_a_steady_state_and_no_radius(motion: Motions, bag_of: Write) -> None:
    straight = motion()
    straight.yaw_rate[:] = 0.0
    metrics = compute_metrics(bag_of(straight))
    assert metrics['path']['radius'] is None
    assert metrics['yaw_rate']['steady_state'] == 0.0
    assert metrics['steady']['reached']


def test_one_unsettled_tyre_leaves_the_others_their_steady_state(motion: Motions, bag_of: Write) -> None:
    trembling = motion()
    trembling.side_slip[:, 0] += 0.02 * np.sin(30.0 * trembling.time)
    slips = compute_metrics(bag_of(trembling))['side_slip']
    assert slips['front_left']['steady_state'] is None
    assert slips['front_left']['settling_time'] is None
    assert slips['front_right']['steady_state'] == pytest.approx(0.03)


@pytest.mark.parametrize('signal', ['yaw_rate', 'vy'])
def test_a_motion_that_still_changes_has_no_steady_state_at_all(motion: Motions, bag_of: Write, signal: str) -> None:
    spinning = motion()
    getattr(spinning, signal)[:] = spinning.time
    metrics = compute_metrics(bag_of(spinning))
    assert not metrics['steady']['reached']
    assert 'still changing' in metrics['steady']['reason']
    assert metrics['path']['radius'] is None
    assert metrics['yaw_rate']['steady_state'] is None
    assert all(slip['steady_state'] is None for slip in metrics['side_slip'].values())
    assert metrics['side_slip']['front_left']['peak'] == 0.04


@pytest.mark.parametrize('axle', [(0, 1), (2, 3)])
def test_past_the_grip_limit_settled_signals_are_not_steady(
    motion: Motions, bag_of: Write, axle: tuple[int, int]
) -> None:
    sliding = motion()
    limit = second_critical_slip(5.0, 0.9 * 3000.0, CAR.cornering_stiffness, CAR.adhesion_reduction)
    sliding.side_slip[:, axle[0]] = -1.01 * limit
    sliding.side_slip[:, axle[1]] = 1.01 * limit
    metrics = compute_metrics(bag_of(sliding))
    assert metrics['steady']['reason'] == f'{"front" if axle == (0, 1) else "rear"} tyres sliding, past the grip limit'
    assert metrics['path']['radius'] is None


def test_one_sliding_tyre_is_not_the_limit_of_its_axle(motion: Motions, bag_of: Write) -> None:
    turning = motion()
    turning.side_slip[:, 0] = 1.0
    assert compute_metrics(bag_of(turning))['side_slip']['front_left']['steady_state'] == pytest.approx(1.0)


def test_less_friction_brings_the_limit_nearer(motion: Motions, bag_of: Write) -> None:
    sliding = motion()
    sliding.side_slip[:, :2] = 0.99 * second_critical_slip(5.0, 0.9 * 3000.0, 30000.0, 0.015)
    sliding.friction = [(0.0, dict.fromkeys(WHEELS, 0.9)), (1.0, {'front_left': 0.5}), (2.0, {'front_right': 0.5})]
    bag = bag_of(sliding)
    time, friction_now = friction(bag)
    assert time.tolist() == [0.0, 1.0, 2.0]
    assert friction_now.tolist() == [[0.9] * 4, [0.5, 0.9, 0.9, 0.9], [0.5, 0.5, 0.9, 0.9]]
    assert compute_metrics(bag)['steady']['reason'] == 'front tyres sliding, past the grip limit'


def test_without_a_word_about_friction_the_plants_default_counts(motion: Motions, bag_of: Write) -> None:
    quiet = motion()
    quiet.topics_left_out = {'environment/friction'}
    assert compute_metrics(bag_of(quiet))['steady']['reached']


def test_a_short_run_has_no_steady_state(motion: Motions, bag_of: Write) -> None:
    metrics = compute_metrics(bag_of(motion(0.5)))
    assert metrics['steady'] == {'reached': False, 'reason': 'shorter than a second', **UNKNOWN_LIMIT}
    assert metrics['side_slip']['front_left']['peak'] == 0.04


def test_wheel_lift_and_what_is_not_finite(motion: Motions, bag_of: Write) -> None:
    rolling = motion()
    rolling.load[200:, 2] = 0.0
    rolling.side_slip[100:, 3] = math.nan
    rolling.vx[-1] = math.inf
    metrics = compute_metrics(bag_of(rolling))
    json.dumps(metrics, allow_nan=False)
    assert metrics['load']['rear_left']['minimum'] == 0.0
    assert metrics['side_slip']['rear_right']['peak'] == 0.01
    assert metrics['speed']['final'] is None


@pytest.mark.parametrize('missing', ['odom', 'tyres/side_slip', 'tyres/force'])
def test_a_bag_without_a_needed_topic_is_refused(motion: Motions, bag_of: Write, missing: str) -> None:
    partial = motion()
    partial.topics_left_out = {missing}
    with pytest.raises(BagError, match=missing):
        compute_metrics(bag_of(partial))


def test_a_spin_in_place_has_radius_0() -> None:
    time = np.arange(301) * 0.01
    assert path_radius(time, 0.0 * time, 0.0 * time, np.full(301, 0.8)) == 0.0


def test_a_crab_has_no_radius() -> None:
    time = np.arange(301) * 0.01
    assert path_radius(time, np.full(301, 1.0), np.full(301, 0.5), 0.0 * time) is None


def test_a_sensor_that_lies_does_not_deceive_the_metrics() -> None:
    """Without a controller nobody acts on odom and tyres/side_slip: with their faults the metrics are the same."""
    drive = {
        'duration': 2.0,
        'plant': {'initial_speed': 4.0},
        'commands': [{'at': 0.0, 'icr': [0.0, 10.0], 'speed': 4.0}],
    }
    events = [
        {'at': 0.5, 'component': 'odom', 'failure': 'wrong', 'for': 1.0},
        {'at': 0.5, 'component': 'tyres/side_slip', 'failure': 'intermittent', 'value': 0.1},
    ]
    sound, faulty = (make_scenario('x', {**drive, 'faults': faults}) for faults in ([], events))
    bag = record(faulty)
    assert bag['odom'].vx.max() > 4.5
    assert compute_metrics(bag, faulty.vehicle) == compute_metrics(record(sound), sound.vehicle)
