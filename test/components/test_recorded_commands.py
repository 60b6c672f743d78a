"""A run that is driven again by its own recording is the same run, byte for byte."""

from pathlib import Path

import pytest

from omni_vehicle_ros.bags import BagWriter, open_bag, read_messages
from omni_vehicle_ros.components.recorded_commands import COMMANDS, RecordedCommands, command_of
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.interface import COMMAND, topic
from omni_vehicle_ros.messages import Point, Twist, encode
from omni_vehicle_ros.results import scenario_beside
from omni_vehicle_ros.run import run_scenario
from omni_vehicle_ros.scenarios import load_scenario

DRIVE = """
duration: 1.5
side_slip_control: true
plant: {initial_speed: 3.0, friction: [0.9, 0.8, 0.9, 0.8]}
commands:
  - {at: 0.0, icr: straight, speed: 3.0}
  - {at: 0.3, icr: [0.5, 12.0], traction: 200.0}
  - {at: 0.9, teleop: [2.0, 1.0, 0.2]}
  - {at: 1.1, cmd_vel: [2.0, 1.0, 0.2], emergency_stop: true}
environment:
  - {at: 0.4, bank: 0.02, wind: 3.0, friction: 0.7}
  - {at: 0.6, wind: 5.0}
faults:
  - {at: 0.5, component: front_left/steering, failure: slow, value: 0.3, for: 0.2}
  - {at: 0.6, component: messages/driver/speed, failure: intermittent}
"""


@pytest.fixture(scope='module')
def recorded(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp('recorded')
    (path / 'drive.yaml').write_text(DRIVE)
    run_scenario(load_scenario(str(path / 'drive.yaml')), path / 'run', mode='offline', namespace='car')
    return path / 'run'


def contents(directory: Path) -> list[tuple[str, str, int, bytes]]:
    return [tuple(message)[:4] for message in read_messages(directory / 'bag')]


def write(path: Path, *entries: tuple[str, object, int]) -> Path:
    with BagWriter(path) as writer:
        for name, value, time in entries:
            kind = topic(command_of(name)[1]).type
            writer.add_topic(name, kind, COMMAND)
            writer.write(name, encode(kind, value), time)
    return path


def test_a_recorded_run_drives_itself_again_byte_for_byte(recorded, tmp_path):
    """The commands come from the bag alone: the scenario's own are taken away before."""
    scenario = load_scenario(str(scenario_beside(recorded / 'bag')))
    run_scenario(scenario, tmp_path / 'again', mode='offline', namespace='car', commands=recorded / 'bag')
    expected = contents(recorded)
    assert {name for name, *_ in expected} >= {f'/car/{name}' for name in COMMANDS}
    script = RecordedCommands(recorded / 'bag', scenario)
    assert (script.namespace, script.has_clock) == ('/car', True)
    assert contents(tmp_path / 'again') == expected
    left = load_scenario(str(tmp_path / 'again' / 'scenario.yaml'))
    assert not left.commands
    assert not left.environment
    run_scenario(left, tmp_path / 'third', mode='offline', namespace='car', commands=tmp_path / 'again' / 'bag')
    assert contents(tmp_path / 'third') == expected


def test_a_run_without_a_clock_is_driven_again_without_one(recorded, tmp_path):
    scenario = load_scenario(str(recorded / 'scenario.yaml'))
    options = {'mode': 'offline', 'namespace': 'car', 'publish_clock': False}
    run_scenario(scenario, tmp_path / 'quiet', commands=recorded / 'bag', **options)
    script = RecordedCommands(tmp_path / 'quiet' / 'bag', scenario)
    assert not script.has_clock
    assert contents(tmp_path / 'quiet') == [message for message in contents(recorded) if message[0] != '/clock']


def test_the_same_commands_drive_another_vehicle(recorded, tmp_path):
    scenario = load_scenario(str(recorded / 'scenario.yaml'), ['vehicle.mass=1500'])
    run_scenario(scenario, tmp_path / 'heavy', mode='offline', commands=recorded / 'bag')
    before, after = open_bag(recorded / 'bag'), open_bag(tmp_path / 'heavy' / 'bag')
    assert (before['cmd_vel'].vx == after['cmd_vel'].vx).all()
    assert (before['driver/traction'].stamp_ns == after['driver/traction'].stamp_ns).all()
    assert before['odom'].y[-1] != after['odom'].y[-1]


def test_commands_between_cycles_wait_for_the_next(tmp_path):
    """None acts before it was said, and none gets lost or changes its order."""
    period = 5_000_000
    icr, speed = '/driver/icr', '/driver/speed'
    bag = write(
        tmp_path / 'bag', (icr, Point(0, 1.0, 2.0), 0), (speed, Twist(0, 1.0), 1), (icr, Point(0, 3.0, 4.0), period),
        (speed, Twist(0, 2.0), 3 * period - 1), (speed, Twist(0, 3.0), 3 * period),
    )
    script = RecordedCommands(bag, load_scenario('demo'))
    said = [[value[1] for _, value in script.messages(cycle)] for cycle in range(5)]
    assert said == [[1.0], [1.0, 3.0], [], [2.0, 3.0], []]
    assert script.trouble == ''


def test_a_broken_bag_is_said_by_the_driver(recorded, tmp_path):
    (tmp_path / 'bag').mkdir()
    whole = (recorded / 'bag' / 'bag_0.mcap').read_bytes()
    (tmp_path / 'bag' / 'bag_0.mcap').write_bytes(whole[: len(whole) // 2])
    scenario = load_scenario(str(recorded / 'scenario.yaml'))
    run_scenario(scenario, tmp_path / 'again', mode='offline', commands=tmp_path / 'bag')
    said = [status for row in open_bag(tmp_path / 'again' / 'bag')['/diagnostics'].statuses for status in row]
    assert any(one.name == '/driver' and one.level == 2 and 'ends after' in one.message for one in said)


@pytest.mark.parametrize(
    ('entries', 'reason'),
    [
        ([], 'holds no commands: driver/icr'),
        ([('/driver/icr', Point(0, 0.0, 8.0), 10**18)], 'recorded at simulated time'),
        ([('/a/driver/icr', Point(0, 0.0, 8.0), 0), ('/b/cmd_vel', Twist(0, 1.0), 0)], 'several vehicles: /a, /b'),
    ],
    ids=['none', 'wall time', 'two vehicles'],
)
def test_what_can_not_drive_is_refused_and_leaves_nothing(tmp_path, entries, reason):
    bag = write(tmp_path / 'bag', *entries)
    with pytest.raises(BagError, match=reason):
        run_scenario(load_scenario('demo'), tmp_path / 'run', mode='offline', commands=bag)
    assert not (tmp_path / 'run').exists()
