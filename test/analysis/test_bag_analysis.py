"""Bags made from numbers: what was put into them is what the analysis finds, exactly."""

import json
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from omni_vehicle_ros import messages
from omni_vehicle_ros.analysis.bags.analysis import analyse, read_subjects
from omni_vehicle_ros.analysis.bags.report import write_analysis
from omni_vehicle_ros.analysis.stream.limits import limits_of
from omni_vehicle_ros.analysis.stream.reading import BagReader
from omni_vehicle_ros.analysis.stream.summary import metrics_of
from omni_vehicle_ros.analysis.stream.survey import Survey, survey_bag
from omni_vehicle_ros.bags import BagWriter, open_bag
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.interface import topic
from omni_vehicle_ros.messages import Diagnostics, Forces, Imu, Joints, Odometry, Status, Twist
from omni_vehicle_ros.wheels import WHEELS, steer_joint

MS = 1_000_000
JOINTS = tuple(map(steer_joint, WHEELS))
Said = tuple[str, int, Any]
Motions = Callable[..., Any]


@pytest.fixture
def bag(tmp_path: Path) -> Callable[..., Path]:
    """Write what is said on topics, at log times, as a bag."""

    def write(said: list[Said], namespace: str = '', name: str = 'said') -> Path:
        with BagWriter(tmp_path / name) as writer:
            for role, log_time, value in sorted(said, key=lambda entry: entry[1]):
                row, full = topic(role), role if role.startswith('/') else f'{namespace}/{role}'
                writer.add_topic(full, row.type, row.qos)
                writer.write(full, messages.encode(row.type, value), log_time)
        return tmp_path / name

    return write


def odom(k: int, speed: float = 1.0) -> Odometry:
    return Odometry(k * 10 * MS, speed * k * 0.01, 0.0, 0.0, speed, 0.0, 0.0)


def survey(path: Path, **options: Any) -> Survey:
    return survey_bag(path, limits_of(None), **options)


def events(found: Survey, kind: str) -> list[tuple[float, float, str]]:
    listed = metrics_of(found)['events']['list']
    return [
        (pytest.approx(event['begin']), pytest.approx(event['end']), event['source'])
        for event in listed if event['kind'] == kind
    ]


def test_missed_cycles_are_found_where_they_are(bag: Callable[..., Path]) -> None:
    path = bag([('odom', k * 10 * MS, odom(k)) for k in range(600) if k not in (100, 101, 450)])
    found = survey(path)
    timing = metrics_of(found)['timing']['/odom']
    assert (timing['period'], timing['missed_cycles'], timing['cyclic']) == (0.01, 3, True)
    assert timing['jitter']['shortest'] == pytest.approx(0.01)
    assert timing['jitter']['longest'] == pytest.approx(0.03)
    periods = np.array([0.01] * 594 + [0.03, 0.02])
    assert timing['jitter']['deviation'] == pytest.approx(np.std(periods), rel=1e-9)
    assert events(found, 'missed cycles') == [(0.99, 1.02, '/odom'), (4.49, 4.51, '/odom')]
    assert metrics_of(found)['events']['counts'] == {'missed cycles': 2}


def test_latency_is_log_time_less_stamp(bag: Callable[..., Path]) -> None:
    """Every fourth message is 2 ms later than the 3 ms of the others: so log times jitter and stamps don't."""
    said = [('odom', (k * 10 + 3 + 2 * (k % 4 == 0)) * MS, odom(k)) for k in range(1, 401)]
    timing = metrics_of(survey(bag(said)))['timing']['/odom']
    assert timing['latency']['mean'] == pytest.approx(0.0035)
    assert timing['latency']['shortest'] == pytest.approx(0.003)
    assert timing['latency']['longest'] == pytest.approx(0.005)
    assert timing['latency']['p99'] == pytest.approx(0.005, rel=0.012)
    assert timing['jitter']['deviation'] == pytest.approx(0.0, abs=1e-12)
    assert timing['log_jitter']['longest'] == pytest.approx(0.012)
    assert timing['missed_cycles'] == 0


def test_stamps_of_another_clock_tell_no_latency(bag: Callable[..., Path]) -> None:
    wall = 1_700_000_000_000_000_000
    timing = metrics_of(survey(bag([('odom', wall + k * 10 * MS, odom(k + 1)) for k in range(50)])))['timing']['/odom']
    assert timing['latency'] is None
    assert timing['other_clock'] == 50


def joints(k: int, angle: float) -> Joints:
    return Joints(k * 10 * MS, JOINTS, (angle, 0.0, 0.0, 0.0), (0.0,) * 4, (0.0,) * 4)


def test_limits_that_are_reached_and_wheels_that_lift_are_events(bag: Callable[..., Path]) -> None:
    said: list[Said] = []
    for k in range(301):
        stamp, limit = k * 10 * MS, 1.75
        said.append(('joint_states', stamp, joints(k, limit if 100 <= k <= 150 else 0.5)))
        loads = (3000.0, 0.0 if 200 <= k <= 220 else 3000.0, 3000.0, 3000.0)
        said.append(('tyres/force', stamp, Forces(stamp, WHEELS, tuple((0.0, 0.0, load) for load in loads))))
        use = (0.5, 0.5, 1.0 if k in (250, 251, 253) else 0.99, 0.5)
        said.append(('tyres/side_slip', stamp, Joints(stamp, WHEELS, (0.0,) * 4, (1.0,) * 4, use)))
    found = survey(bag(said))
    assert events(found, 'saturation') == [(1.0, 1.5, 'front_left'), (2.5, 2.53, 'rear_left')]
    assert events(found, 'wheel lift') == [(2.0, 2.2, 'front_right')]


def test_a_driver_who_falls_silent_is_a_time_out(bag: Callable[..., Path]) -> None:
    """He speaks up to 1 s, by another topic from 2 s to 3 s, and never again: the time-out is 0.5 s."""
    said: list[Said] = [('odom', k * 10 * MS, odom(k)) for k in range(501)]
    said += [('driver/speed', k * 100 * MS, Twist(k * 100 * MS, 1.0)) for k in range(11)]
    said += [('cmd_vel', k * 100 * MS, Twist(0, 1.0)) for k in range(20, 31)]
    assert events(survey(bag(said)), 'time-out') == [
        (1.5, 2.0, 'cmd_vel, driver/speed'), (3.5, 5.0, 'cmd_vel, driver/speed')]


def test_complaints_last_from_when_to_when_they_are_said(bag: Callable[..., Path]) -> None:
    said: list[Said] = [('odom', k * 10 * MS, odom(k)) for k in range(501)]
    states = [(0, 0, 'fine'), (1, 1, 'low'), (2, 1, 'low'), (3, 0, 'fine'), (4, 2, 'no command for module_timeout')]
    for second, level, text in states:
        stamp = second * 1000 * MS
        said.append(('/diagnostics', stamp, Diagnostics(stamp, (Status(level, '/node', text),))))
    found = survey(bag(said))
    assert events(found, 'warning') == [(1.0, 3.0, '/node')]
    assert events(found, 'time-out') == [(4.0, 4.0, '/node')]


def test_the_lag_of_a_response_is_found(bag: Callable[..., Path]) -> None:
    """A sine that comes 7 cycles late: the rms error is that of the difference of two sines."""
    period, late, amplitude = 100, 7, 0.2
    said: list[Said] = []
    for k in range(10 * period):
        for i, wheel in enumerate(WHEELS):
            wave = amplitude * math.sin(2.0 * math.pi * k / period) if i == 0 else 0.1
            command = Joints(k * 10 * MS, JOINTS[i : i + 1], (wave,), (0.0,), (0.0,))
            said.append((f'{wheel}/command', k * 10 * MS, command))
        angle = amplitude * math.sin(2.0 * math.pi * (k - late) / period)
        said.append(('joint_states', k * 10 * MS, Joints(k * 10 * MS, JOINTS, (angle, 0.1, 0.1, 0.1))))
    response = metrics_of(survey(bag(said)))['response']['steer_angle']
    assert response['front_left']['lag'] == pytest.approx(late * 0.01)
    expected = amplitude * 2.0 * math.sin(math.pi * late / period) / math.sqrt(2.0)
    assert response['front_left']['rms'] == pytest.approx(expected, rel=1e-9)
    assert response['rear_right'] == {'rms': 0.0, 'peak': 0.0, 'lag': None}


def test_grip_use_follows_the_friction(bag: Callable[..., Path]) -> None:
    """3, 4, 5: 500 N of 0.9 x 1000 N, and of half the friction from 1 s on, said once only."""
    said: list[Said] = [('environment/friction', 1000 * MS, Joints(1000 * MS, ('front_left',), effort=(0.45,)))]
    for k in range(200):
        forces = tuple((300.0, 400.0, load) for load in (1000.0, 1000.0, 1000.0, 0.0))
        said.append(('tyres/force', k * 10 * MS, Forces(k * 10 * MS, WHEELS, forces)))
        said.append(('imu', k * 10 * MS, Imu(k * 10 * MS, 0.0, 0.0, 0.0, 3.0, -4.0, 9.81)))
    found = survey(bag(said))
    grip = metrics_of(found)['grip']
    assert grip['front_left'] == pytest.approx(5.0 / 4.5)
    assert grip['rear_left'] == pytest.approx(5.0 / 9.0)
    assert 'rear_right' not in grip
    assert grip['body'] == pytest.approx(5.0 / 9.81)
    along, across, share = found.tyre_grip[0].cells()
    assert sorted(share.tolist()) == [0.5, 0.5]
    assert across / along == pytest.approx(np.full(2, 4.0 / 3.0), rel=0.1)


def test_without_an_imu_the_body_accelerates_as_its_twist_says(motion: Motions, tmp_path: Path) -> None:
    """On a circle: v^2 / R to the left, in g."""
    circle = motion(4.0, 10.0, 5.0)
    circle.topics_left_out = {'imu', 'tyres/force'}
    circle.write(tmp_path / 'bag')
    assert metrics_of(survey(tmp_path / 'bag'))['grip'] == {'body': pytest.approx(2.5 / 9.81)}


def test_block_by_block_is_the_same_as_all_at_once(motion: Motions, tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    moved = motion(12.0)
    moved.side_slip = rng.normal(size=moved.side_slip.shape)
    moved.load += rng.normal(size=moved.load.shape)
    whole = moved.write(tmp_path / 'bag')
    found = {}
    for rows in (7, 100, 65536):
        found[rows] = survey(tmp_path / 'bag', reader=BagReader(tmp_path / 'bag', rows))
    metrics = metrics_of(found[65536])
    for rows in (7, 100):
        assert json.dumps(rounded(metrics_of(found[rows]))) == json.dumps(rounded(metrics))
        for name, signals in found[rows].signals.items():
            for one, other in zip(signals.envelope.line(0), found[65536].signals[name].envelope.line(0), strict=True):
                np.testing.assert_array_equal(one, other)
    slip = whole['tyres/side_slip']
    for i, wheel in enumerate(WHEELS):
        figures = metrics['signals']['side_slip'][wheel]
        assert figures['mean'] == pytest.approx(np.mean(slip.position[:, i]), rel=1e-9)
        assert figures['deviation'] == pytest.approx(np.std(slip.position[:, i]), rel=1e-9)
        assert figures['maximum'] == np.max(slip.position[:, i])
        assert figures['maximum_at'] == pytest.approx(slip.stamp[np.argmax(slip.position[:, i])])
        assert metrics['signals']['load'][wheel]['minimum'] == np.min(whole['tyres/force'].forces[:, i, 2])
    track = whole['odom']
    assert metrics['path']['length'] == pytest.approx(np.sum(np.hypot(np.diff(track.x), np.diff(track.y))))


def rounded(value: Any) -> Any:
    """Return the same with all numbers to 12 digits: sums in another order."""
    if isinstance(value, dict):
        return {key: rounded(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(entry) for entry in value]
    if isinstance(value, float):
        return float(f'{value:.12g}') if abs(value) > 1e-12 else 0.0
    return value


def test_a_bag_of_others_gets_a_report_of_what_it_has(bag: Callable[..., Path], tmp_path: Path) -> None:
    """Wall time, other joints, no more than two topics."""
    wall, said = 1_700_000_000_000_000_000, []
    for k in range(200):
        stamp = wall + k * 20 * MS
        said.append(('odom', stamp + 5 * MS, odom(k)._replace(stamp=stamp)))
        said.append(('joint_states', stamp, Joints(stamp, ('arm', 'left_wheel'), (0.1 * k, 0.2), (1.0, 2.0))))
    path = bag(said, '/robot')
    (tmp_path / 'out').mkdir()
    found = analyse(read_subjects([path]))
    write_analysis(found, tmp_path / 'out')
    metrics = json.loads((tmp_path / 'out' / 'metrics.json').read_text())['bags'][0]
    assert {'imu', 'tyres/force', 'tyres/side_slip', '/diagnostics'} <= set(metrics['missing'])
    assert not {'odom', 'joint_states'} & set(metrics['missing'])
    assert metrics['duration'] == pytest.approx(199 * 0.02)
    assert metrics['signals']['joint_position']['arm']['maximum'] == pytest.approx(19.9)
    assert metrics['timing']['/robot/odom']['latency']['mean'] == pytest.approx(0.005)
    page = (tmp_path / 'out' / 'report.html').read_text()
    expected = ('Path from above', 'steer angles are not known', 'no imu: without acceleration and roll', 'left_wheel')
    for words in expected:
        assert words in page
    assert 'http' not in page
    assert '<script' not in page


def test_two_bags_stand_side_by_side_with_their_differences(motion: Motions, tmp_path: Path) -> None:
    motion(4.0, 10.0, 5.0).write(tmp_path / 'fast' / 'bag')
    motion(4.0, 10.0, 4.0).write(tmp_path / 'slow' / 'bag')
    found = analyse(read_subjects([tmp_path / 'fast', tmp_path / 'slow' / 'bag']))
    differences = found.metrics['differences']
    assert differences['speed vx mean'] == [pytest.approx(-1.0)]
    assert differences['yaw_rate maximum'] == [pytest.approx(-0.1)]
    assert differences['path length'] == [pytest.approx(-4.0, rel=1e-4)]
    assert differences['duration'] == [0.0]
    (tmp_path / 'out').mkdir()
    write_analysis(found, tmp_path / 'out')
    page = (tmp_path / 'out' / 'report.html').read_text()
    for words in ('fast and slow', 'Path from above: fast', 'Path from above: slow', 'All paths', 'Difference'):
        assert words in page
    ids = [part.split('"')[0] for part in page.split(' id="')[1:]]
    assert len(ids) == len(set(ids))


def test_of_several_vehicles_one_must_be_named(bag: Callable[..., Path], tmp_path: Path) -> None:
    with BagWriter(tmp_path / 'two') as writer:
        for k in range(20):
            for speed, name in ((1.0, '/a/odom'), (2.0, '/b/odom')):
                writer.add_topic(name, topic('odom').type, topic('odom').qos)
                writer.write(name, messages.encode(topic('odom').type, odom(k, speed)), k * 10 * MS)
    with pytest.raises(BagError, match='several vehicles; name the namespace of one: /a, /b'):
        survey(tmp_path / 'two')
    found = metrics_of(survey(tmp_path / 'two', namespace='b'))
    assert found['signals']['speed']['vx']['mean'] == pytest.approx(2.0)


def write_sqlite3(directory: Path, said: list[Said]) -> None:
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    with Writer(directory, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        store, row = get_typestore(Stores.ROS2_JAZZY), topic('odom')
        connection = writer.add_connection('/odom', row.type, typestore=store)
        for _, log_time, value in said:
            writer.write(connection, log_time, messages.encode(row.type, value))


def test_a_sqlite3_bag_says_the_same(bag: Callable[..., Path], tmp_path: Path) -> None:
    said = [('odom', k * 10 * MS, odom(k)) for k in range(300) if k != 77]
    path = bag(said)
    write_sqlite3(tmp_path / 'other', said)
    ours, theirs = metrics_of(survey(path)), metrics_of(survey(tmp_path / 'other'))
    assert ours['timing']['/odom']['missed_cycles'] == 1
    assert {**rounded(theirs), 'bag': ''} == {**rounded(ours), 'bag': ''}


def test_a_number_that_no_quantity_has_counts_as_missing(bag: Callable[..., Path]) -> None:
    said = [('odom', k * 10 * MS, odom(k, 1e300 if k == 50 else 1.0)) for k in range(100)]
    figures = metrics_of(survey(bag(said)))['signals']['speed']['vx']
    assert (figures['count'], figures['mean'], figures['maximum']) == (99, 1.0, 1.0)


@pytest.mark.parametrize(('file', 'old', 'new'), [
    ('metadata.yaml', 'rosbag2', '['), ('metadata.yaml', 'bagfile', 'file'), ('other.db3', 'SQLite', 'nothing'),
])
def test_a_broken_sqlite3_bag_is_one_line(tmp_path: Path, file: str, old: str, new: str) -> None:
    write_sqlite3(tmp_path / 'other', [('odom', k * 10 * MS, odom(k)) for k in range(300)])
    path = tmp_path / 'other' / file
    path.write_bytes(path.read_bytes().replace(old.encode(), new.encode()))
    with pytest.raises(BagError) as error:
        survey(tmp_path / 'other')
    assert len(str(error.value).splitlines()) == 1


def test_a_bag_that_breaks_off_says_so(motion: Motions, tmp_path: Path) -> None:
    motion().write(tmp_path / 'bag')
    file = next((tmp_path / 'bag').glob('*.mcap'))
    file.write_bytes(file.read_bytes()[:-20000])
    metrics = analyse(read_subjects([tmp_path / 'bag'])).metrics['bags'][0]
    assert not metrics['complete']
    assert 'in the middle' in metrics['damage'][0]
    assert 0.0 < metrics['duration'] < 4.0


def test_a_bag_without_anything_to_say_is_an_error(tmp_path: Path) -> None:
    with BagWriter(tmp_path / 'bag') as writer:
        writer.add_topic('/odom', topic('odom').type, topic('odom').qos)
    with pytest.raises(BagError, match=r'no messages that are read here; its topics: .*odom'):
        analyse(read_subjects([tmp_path / 'bag']))
    with pytest.raises(BagError, match='7 bags are too many'):
        read_subjects([tmp_path / 'bag'] * 7)


def progress_of(path: Path) -> Iterator[float]:
    seen: list[float] = []
    analyse(read_subjects([path, path]), progress=seen.append)
    yield from seen


def test_progress_rises_to_the_size_of_all(motion: Motions, tmp_path: Path) -> None:
    motion().write(tmp_path / 'bag')
    seen = list(progress_of(tmp_path / 'bag'))
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(2e-6 * sum(file.stat().st_size for file in (tmp_path / 'bag').glob('*.mcap')))


def test_open_bag_gives_the_columns_of_the_notebook_example(motion: Motions, tmp_path: Path) -> None:
    odometry = motion(4.0, 10.0, 5.0).write(tmp_path / 'bag')['odom']
    assert open_bag(tmp_path / 'bag')['odom'].vx == pytest.approx(odometry.vx)
