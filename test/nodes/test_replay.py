"""Replay over Fast DDS: the recorded bytes reach others, and a run drives itself again."""

import re
import signal
import struct
from operator import itemgetter
from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.rosbag2.metadata import parse_qos
from rosbags.typesys import Stores, get_typestore

from omni_vehicle_ros.bags import BagWriter, read_messages
from omni_vehicle_ros.bags.metadata import offer, qos_profiles
from omni_vehicle_ros.bags.schema import Schema
from omni_vehicle_ros.interface import LATCHED, STATE
from omni_vehicle_ros.messages import Clock, Text, Vector, encode
from omni_vehicle_ros.messages.stamps import stamp_of

from .conftest import Lab, finish, until

pytestmark = pytest.mark.graph

AUDIENCE = str(Path(__file__).with_name('audience.py'))
MS = 1_000_000
TEXT, VECTOR, CLOCK = 'std_msgs/msg/String', 'geometry_msgs/msg/Vector3Stamped', 'rosgraph_msgs/msg/Clock'
BEGIN = 1_700_000_000_000 * MS

SHORT = """
duration: 1.0
side_slip_control: true
plant: {initial_speed: 3.0}
commands:
  - {at: 0.0, icr: straight, speed: 3.0}
  - {at: 0.3, icr: [0.5, 12.0], speed: 4.0}
environment:
  - {at: 0.5, bank: 0.02, wind: 3.0, friction: 0.7}
"""


def messages(period: int, number: int = 50) -> list[tuple[str, bytes, int]]:
    """Return texts, each after ``period`` [ms]; a bank comes with the first and the fifth of them."""
    found = []
    for i in range(number):
        time = BEGIN + i * period * MS
        found.append(('/said', encode(TEXT, Text(f'text {i}')), time))
        if i in (0, 4):
            found.append(('/bank', encode(VECTOR, Vector(time, 0.1 * i, 0.0)), time))
    return found


def write_sqlite(path: Path, entries: list[tuple[str, bytes, int]]) -> None:
    """Write a bag as ROS users had them before MCAP; one type in it is not installed anywhere."""
    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        topics = {
            name: writer.add_connection(
                name, kind, typestore=store, offered_qos_profiles=parse_qos(qos_profiles([offer(qos)]))
            )
            for name, kind, qos in (('/said', TEXT, STATE), ('/bank', VECTOR, LATCHED))
        }
        odd = writer.add_connection('/odd', 'odd_msgs/msg/Odd', msgdef='int32 odd\n', rihs01=f'RIHS01_{"0" * 64}')
        for name, data, time in entries:
            writer.write(topics[name], time, data)
            writer.write(odd, time, struct.pack('<Ii', 256, 1))


def write_mcap(path: Path, entries: list[tuple[str, bytes, int]]) -> None:
    with BagWriter(path) as writer:
        for name, kind, qos in (('/said', TEXT, STATE), ('/bank', VECTOR, LATCHED), ('/clock', CLOCK, STATE)):
            writer.add_topic(name, kind, qos)
        writer.add_topic('/odd', 'odd_msgs/msg/Odd', STATE, Schema('int32 odd\n', f'RIHS01_{"0" * 64}'))
        for name, data, time in entries:
            writer.write('/clock', encode(CLOCK, Clock(time - BEGIN)), time)
            writer.write(name, data, time)
            writer.write('/odd', struct.pack('<Ii', 256, 1), time)


def audience(lab: Lab, *arguments: str):
    """Start an audience and wait until it listens."""
    profile = str(Path(__file__).parents[2] / 'config' / 'fastdds.xml')  # to be found soon
    process = lab.start(AUDIENCE, *arguments, environment={'FASTRTPS_DEFAULT_PROFILES_FILE': profile})
    assert process.stdout.readline() == 'listening\n'
    return process


def heard(output: str) -> dict[str, list[bytes]]:
    lines = [line.split() for line in output.splitlines() if line.startswith('/')]
    return {topic: [bytes.fromhex(word) for word in words] for topic, *words in lines}


def contents(directory: Path) -> list[tuple[str, str, int, bytes]]:
    """Return what a run recorded, topic by topic: between topics the order may differ."""
    return sorted((message[:4] for message in read_messages(directory / 'bag')), key=itemgetter(0))


def test_a_run_drives_itself_again_byte_for_byte(lab: Lab) -> None:
    """Ten processes, driven by the bag alone, say on every topic what the recorded run says."""
    finish(lab.command('run', str(lab.scenario(SHORT)), '--namespace', 'car', '--no-clock', '--out', 'first'))
    (lab.path / 'short.yaml').unlink()
    finish(lab.command('replay', 'first/bag', '--commands-only', '--out', 'again'))
    expected = contents(lab.path / 'first')
    assert sum(topic == '/car/odom' for topic, *_ in expected) == 201
    assert contents(lab.path / 'again') == expected
    for mode in ('one-process', 'offline'):
        finish(lab.command('replay', 'first/bag', '--commands-only', '--out', mode, '--mode', mode))
        assert contents(lab.path / mode) == expected


@pytest.mark.parametrize('write', [write_sqlite, write_mcap], ids=['sqlite3', 'mcap'])
def test_recorded_bytes_reach_an_audience(lab: Lab, write) -> None:
    """Also when it begins in the middle: first comes what was latched before."""
    entries = messages(20)
    write(lab.path / 'bag', entries)
    listener = audience(lab, 'listen', '30', '2')
    out, errors = finish(lab.command('replay', 'bag', '--start', '0.4', '--rate', '2'))
    assert errors.count('/odd is not replayed: its type odd_msgs/msg/Odd is not installed') == 1
    found = heard(finish(listener)[0])
    assert found['/said'] == [data for topic, data, time in entries if topic == '/said' and time >= BEGIN + 400 * MS]
    assert found['/bank'] == [data for topic, data, _ in entries if topic == '/bank']
    played = len(found['/said']) + 2 + (30 if write is write_mcap else 0)
    assert f'replayed {played} messages' in out


def test_pause_step_and_resume(lab: Lab) -> None:
    """A step is one message here, for no two have the same time; without a pause there is none."""
    write_sqlite(lab.path / 'bag', [entry for entry in messages(100, 600) if entry[0] == '/said'])
    replay = lab.command('replay', 'bag', '--topics', 'said')
    worker = audience(lab, 'work')
    out, _ = finish(worker)
    assert 'step False not paused: call pause first' in out
    assert re.search(r'pause True paused, at \d\.\d{3} s of the bag', out)
    assert out.count('step True 1 messages, at ') == out.count('heard 1\n') == 2
    assert 'resume True playing, at ' in out
    replay.send_signal(signal.SIGINT)
    replay.send_signal(signal.SIGINT)
    finish(replay)


def test_there_is_one_clock(lab: Lab) -> None:
    """The bag's own or a made one, never both; and none beside that of somebody else."""
    write_mcap(lab.path / 'bag', messages(20))
    own, made = ['--topics', '/said', '--topics', 'clock'], ['--clock', '--topics', '/said, /clock']
    for options, low, high in ((own, 0, 980 * MS), (made, BEGIN, BEGIN + 980 * MS)):
        listener = audience(lab, 'listen', '50', '0')
        finish(lab.command('replay', 'bag', *options))
        stamps = [stamp_of(data) for data in heard(finish(listener)[0])['/clock']]
        assert len(stamps) > 20
        assert stamps == sorted(stamps)
        assert low <= stamps[0] <= stamps[-1] <= high
    clock = audience(lab, 'tick')
    assert clock.stdout.readline() == 'ticking\n'
    _, errors = finish(lab.command('replay', 'bag'), 2)
    assert '/clock has more than one publisher (/audience, /replay); there can be one clock only' in errors
    finish(lab.command('replay', 'bag', '--topics', '/said'))
    clock.kill()


def test_a_step_before_the_begin_and_a_bag_without_messages_are_said(lab: Lab) -> None:
    """Nobody listens to what is played, so that the replay waits for as long as it ever does."""
    write_sqlite(lab.path / 'bag', messages(100, 600))
    early = audience(lab, 'early')
    code = 'from omni_vehicle_ros.executables import replay; replay()'
    remap = ['-r', '/said:=/unheard', '-r', '/bank:=/unheard_too']
    replay = lab.start('-c', code, 'bag', '--ros-args', *remap)
    out, _ = finish(early)
    assert 'pause True paused, at 0.000 s of the bag\nstep False it has not begun: ' in out
    assert 'step True 2 messages, at 0.000 s of the bag\nstep True 1 messages, at 0.100 s of the bag' in out
    replay.send_signal(signal.SIGINT)
    finish(replay)
    write_mcap(lab.path / 'cut', messages(3))
    (lab.path / 'cut' / 'cut_0.mcap').write_bytes(b'')
    _, errors = finish(lab.command('replay', 'cut'), 2)
    assert 'error: cut holds no messages that can be read' in errors


def test_the_node_takes_ros_arguments(lab: Lab) -> None:
    write_sqlite(lab.path / 'bag', messages(10))
    listener = audience(lab, 'listen', '0', '2')
    code = 'from omni_vehicle_ros.executables import replay; replay()'
    replay = lab.start('-c', code, 'bag', '--ros-args', '-r', '/said:=/elsewhere', '-r', '__node:=player')
    finish(replay)
    assert heard(finish(listener)[0])['/said'] == []


def test_a_live_vehicle_follows_the_commands_of_a_bag(lab: Lab) -> None:
    """Stamps of the recording would be those of another time: they arrive as now."""
    finish(lab.command('run', str(lab.scenario(SHORT)), '--mode', 'offline', '--out', 'first'))
    vehicle = lab.command('start', '--out', 'live')
    vehicle.stdout.readline()
    bag = lab.path / 'live' / 'bag' / 'bag_0.mcap'
    until(lambda: bag.exists() and any(message.topic == '/odom' for message in read_messages(bag)), 'the vehicle')
    finish(lab.command('replay', 'first/bag', '--commands-only'))
    vehicle.send_signal(signal.SIGINT)
    finish(vehicle)
    said = [message for message in read_messages(bag) if message.topic.startswith(('/driver/', '/environment/'))]
    recorded = [message for message in read_messages(lab.path / 'first' / 'bag') if message.topic == '/driver/speed']
    assert sum(message.topic == '/driver/speed' for message in said) == len(recorded)
    assert all(stamp_of(message.data) == 0 for message in said)
    assert '/driver/step' not in {message.topic for message in said}
