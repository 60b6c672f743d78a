"""A turn of a sweep is the turn of `omni_vehicle run --mode offline`, and obeys what turns must obey."""

import io
import math

import numpy as np
import pytest
from pyarrow import parquet

from omni_vehicle_ros.analysis import compute_metrics
from omni_vehicle_ros.scenarios import load_scenario
from omni_vehicle_ros.simulation import record
from omni_vehicle_ros.sweep.open_loop import open_loop, why_closed
from omni_vehicle_ros.sweep.study import read_study
from omni_vehicle_ros.sweep.turns import chunk_table, results
from omni_vehicle_ros.wheels import WHEELS

TIMELINE = """
duration: 4.0
steering: {motion_rate_limit: 0.8, alignment_slowdown: false, acceleration_limit: 0.0}
wheel_module: {ideal_actuators: true}
plant: {constant_speed: true, initial_speed: 3.0}
commands:
  - {at: 0.3, icr: [0.0, -6.0], speed: 3.0}
  - {at: 2.0, teleop: [3.0, 0.4, 0.3]}
environment:
  - {profile: wind, points: [[0.5, 0.0], [1.5, 8.0]]}
  - {profile: friction, points: [[1.0, 0.9], [1.4, [0.9, 0.5, 0.9, 0.5]]]}
"""
CASES = {
    'settles': ('simple_turning', 'radius=3', 'speed=2.5', 'duration=4'),
    'spins': ('simple_turning', 'radius=3', 'speed=6', 'duration=4'),
    'creeps': ('simple_turning', 'radius=4', 'speed=0.4', 'duration=4'),
    'too short': ('simple_turning', 'duration=0.8'),
    'wind': ('thesis/wind', 'aerodynamic_centre=0.1', 'duration=10.5'),
    'traction': ('thesis/traction_in_turn', 'duration=10.5'),
    'exact side-slip control': (
        'thesis/side_slip_control', 'wheel_module.ideal_actuators=true', 'gains=[5.0, 1.0, 0.0, 0.0]', 'duration=3',
    ),
    'magic formula': ('simple_turning', 'vehicle.tyre_model=magic_formula', 'speed=4', 'duration=4'),
    'timeline': (TIMELINE,),
}  # fmt: skip


def load(tmp_path, case):
    name, *settings = CASES[case]
    if name == TIMELINE:
        path = tmp_path / 'timeline.yaml'
        path.write_text(TIMELINE)
        name = str(path)
    return load_scenario(name, settings)


@pytest.mark.parametrize('case', CASES)
def test_a_turn_is_that_of_an_offline_run(tmp_path, case):
    """By metrics.json and the recorded columns; 1e-9: metrics sums up otherwise, and stamps are rounded to 1 ns."""
    scenario = load(tmp_path, case)
    bag = record(scenario)
    metrics, odom = compute_metrics(bag, scenario.vehicle), bag['odom']
    found = {name: column[0] for name, column in results([open_loop(scenario)]).items()}
    assert bool(found['settled']) is metrics['steady']['reached']
    radius = metrics['path']['radius']
    radius = math.nan if radius is None else radius
    assert found['path_radius'] == pytest.approx(radius, rel=1e-9, nan_ok=True)
    last = odom.stamp >= odom.stamp[-1] - 1.0 - 1e-9
    close = {'rel': 1e-9, 'abs': 1e-12}
    if case != 'too short':
        assert found['final_speed'] == pytest.approx(np.mean(np.hypot(odom.vx, odom.vy)[last]), **close)
        assert found['yaw_rate'] == pytest.approx(np.mean(odom.yaw_rate[last]), **close)
        assert found['lateral_acceleration'] == pytest.approx(np.mean(bag['imu'].ay[last]), **close)
    assert found['lateral_acceleration_peak'] == pytest.approx(np.max(np.abs(bag['imu'].ay)), **close)
    for wheel in WHEELS:
        slip, steady = metrics['side_slip'][wheel], f'side_slip_{wheel}'
        assert found[f'side_slip_peak_{wheel}'] == pytest.approx(abs(slip['peak']), **close)
        if slip['steady_state'] is not None:
            assert found[steady] == pytest.approx(slip['steady_state'], **close)
        assert found[f'friction_use_peak_{wheel}'] == pytest.approx(metrics['friction_use'][wheel]['peak'], **close)
        assert found[f'load_minimum_{wheel}'] == pytest.approx(metrics['load'][wheel]['minimum'], **close)
    regions = metrics['region'].values()
    assert bool(found['left_linear']) is any(region['left_linear'] is not None for region in regions)


def test_company_changes_nothing():
    """Whoever drives beside a turn, and with which vehicle, its numbers are the same to the last bit."""
    study = read_study('simple_turning', ['radius=3,8,-5', 'mass=1200,1500', 'vehicle.tyre_model=dugoff,brush'],
                       ['duration=1.5'])
    points = study.points(range(study.turns))
    turns = [open_loop(study.scenario(point)) for point in points]
    together = results(turns)
    for number, turn in enumerate(turns):
        alone = results([turn])
        for name, column in together.items():
            np.testing.assert_array_equal(alone[name][0], column[number])


def test_left_and_right_are_mirror_images():
    turns = [open_loop(load_scenario('simple_turning', [f'radius={r}', 'duration=2'])) for r in (4.0, -4.0)]
    found = results(turns)
    for name in ('path_radius', 'yaw_rate', 'body_slip', 'lateral_acceleration'):
        assert found[name][1] == pytest.approx(-found[name][0], rel=1e-12)
    assert found['load_minimum_front_left'][0] == pytest.approx(found['load_minimum_front_right'][1], rel=1e-12)


def test_slow_turns_go_where_they_are_steered():
    """Without slip the path is the circle that was asked for, and the acceleration v^2 / R (what slip there is goes
    with v^2: 0.1 % at 0.5 m/s)."""
    radii = np.array([3.0, 5.0, 10.0])
    found = results([open_loop(load_scenario('simple_turning', [f'radius={r}', 'speed=0.5'])) for r in radii])
    np.testing.assert_allclose(found['path_radius'], radii, rtol=2e-3)
    np.testing.assert_allclose(found['lateral_acceleration'], 0.25 / radii, rtol=4e-3)
    assert np.all(found['settled']) and not np.any(found['spun'])


def test_what_is_too_fast_spins():
    found = results([open_loop(load_scenario('simple_turning', ['radius=3', f'speed={v}'])) for v in (3.0, 8.0)])
    assert found['spun'].tolist() == [False, True] and found['settled'].tolist() == [True, False]


@pytest.mark.parametrize('scenario', ['demo', 'crosswind', 'manoeuvres/turn', 'thesis/brake_in_turn'])
def test_what_needs_feedback_is_told_with_its_remedy(scenario):
    loaded = load_scenario(scenario)
    settings = []
    while reason := why_closed(loaded):
        settings.append(reason.partition('--set ')[2])
        loaded = load_scenario(scenario, settings)
    assert settings


def test_columns_have_units():
    study = read_study('thesis/wind', ['wind=1,2', 'vehicle.mass=1300,1400', 'friction=0.5,0.9'], ['duration=0.1'])
    schema = parquet.read_schema(io.BytesIO(chunk_table(study, 0)))
    units = {name: schema.field(name).metadata[b'unit'].decode() for name in schema.names}
    assert [units[name] for name in ('wind', 'vehicle.mass', 'friction')] == ['m/s', 'kg', '1']
    assert units['lateral_acceleration'] == 'm/s2' and units['settled'] == ''
