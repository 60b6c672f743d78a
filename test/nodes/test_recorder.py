"""The recorder on topics of any type: what it takes, what it leaves, and that nothing is lost."""

import re
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import yaml
from rosbags.highlevel import AnyReader

from omni_vehicle_ros.bags import read_messages
from omni_vehicle_ros.messages import decode

from .conftest import Lab, finish, until

pytestmark = pytest.mark.graph
PUBLISHERS = str(Path(__file__).with_name('publishers.py'))
DIAGNOSTICS = 'diagnostic_msgs/msg/DiagnosticArray'


def recorder(lab: Lab, *arguments: str, name: str = 'bag') -> 'subprocess.Popen[str]':
    options = [word for argument in (f'directory:={lab.path / name}', *arguments) for word in ('-p', argument)]
    process = lab.node('recorder', *options)
    until(lambda: (lab.path / name).exists(), 'the recorder')
    return process


def end(process: 'subprocess.Popen[str]') -> str:
    process.send_signal(signal.SIGTERM)
    return finish(process)[0]


def counts(bag: Path) -> dict[str, int]:
    tree = yaml.safe_load((bag / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    return {entry['topic_metadata']['name']: entry['message_count'] for entry in tree['topics_with_message_count']}


def heard(bag: Path, topic: str, count: int = 10) -> bool:
    """Whether so many messages of a topic have come to the disk."""
    return bag.exists() and sum(message.topic == topic for message in read_messages(bag)) >= count


def statuses(bag: Path) -> list:
    return [
        status
        for message in read_messages(bag) if message.topic == '/diagnostics'
        for status in decode(DIAGNOSTICS, message.data).statuses
    ]


def named(bag: Path, topic: str) -> bool:
    """Whether the recorder has said of a topic, or of one of its types, that it is not recorded."""
    values = [value for one in statuses(bag) for value in one.values]
    return any(name.split(' as ')[0] == topic and text.startswith('not recorded') for name, text in values)


def test_nothing_is_lost_at_10000_messages_a_second_from_other_processes(lab: Lab) -> None:
    """Two processes, five topics each, 1,000 messages a second on each: every number of every topic is in the bag.

    A busy machine may not reach this rate: then nothing is lost at the one that it reaches, which is printed.
    """
    process = recorder(lab, 'all:=true')
    floods = [lab.start(PUBLISHERS, 'flood', first, '5', '1000', '4.0') for first in ('0', '5')]
    sent = [finish(flood)[0].split() for flood in floods]
    said = end(process)
    rate = sum(int(words[2]) for words in sent)
    print(f'{rate} messages/s sent')
    numbers: dict[str, list[int]] = {}
    times = []
    for message in read_messages(lab.path / 'bag'):
        times.append(message.log_time)
        number = int.from_bytes(message.data[4:8], 'little', signed=True)
        if message.topic.startswith('/flood/') and number >= 0:
            numbers.setdefault(message.topic, []).append(number)
    for first, (_, count, _) in zip((0, 5), sent, strict=True):
        for topic in range(first, first + 5):
            assert numbers[f'/flood/t{topic}'] == list(range(int(count)))
    assert ' messages, 0 lost' in said
    assert times == sorted(times)
    values = dict(statuses(lab.path / 'bag')[-1].values)
    assert re.fullmatch(r'\d+\.\d messages/s, \d+ B/s, \d+ messages, 0 lost', values['/flood/t0'])


def test_any_type_and_quality_of_service(lab: Lab) -> None:
    publishers = lab.start(PUBLISHERS, 'mixed')
    blind = "import sys; sys.modules['stereo_msgs'] = None; from omni_vehicle_ros.executables import main; "
    process = lab.start(
        '-c', f"{blind}main('nodes.recorder')", '--ros-args', '-p', 'directory:=bag', '-p', 'all:=true',
        '-p', 'compression:=lz4', '-p', 'exclude:=[/rosout]',
    )
    bag = lab.path / 'bag'
    for topic in ('/both', '/unreliable'):
        until(lambda topic=topic: heard(bag, topic), f'messages on {topic}')
    until(lambda: named(bag, '/two_types'), 'two types')
    process.send_signal(signal.SIGTERM)
    _, errors = finish(process)
    publishers.kill()
    found = counts(bag)
    assert {topic for topic, count in found.items() if count} >= {'/latched', '/unreliable', '/both'}
    assert not {'/_hidden', '/rare', '/rosout'} & set(found)
    assert errors.count("/rare is not recorded: No module named 'stereo_msgs") == 1
    if '/two_types' in found:  # one of its publishers was found before the other
        assert errors.count('/two_types as std_msgs/msg/') == 1
    else:
        words = '/two_types is not recorded: it has several types: std_msgs/msg/Bool, std_msgs/msg/Header'
        assert errors.count(words) == 1
    with AnyReader([bag]) as reader:
        offers = {one.topic: one.ext.offered_qos_profiles for one in reader.connections}
        (data,) = [data for one, _, data in reader.messages() if one.topic == '/latched']
    assert b'from before' in data
    assert offers['/latched'][0].durability.name == 'TRANSIENT_LOCAL'
    assert {qos.reliability.name for qos in offers['/both']} == {'RELIABLE', 'BEST_EFFORT'}


def test_what_is_not_recorded_is_named(lab: Lab) -> None:
    """A topic that nobody publishes, and one whose next publisher has another type."""
    bag = lab.path / 'bag'
    process = recorder(lab, 'topics:=[changing, /diagnostics, nobody]')
    first = lab.start(PUBLISHERS, 'typed', 'Bool')
    until(lambda: heard(bag, '/changing'), 'messages of the first type')
    first.kill()
    second = lab.start(PUBLISHERS, 'typed', 'Header')
    other = '/changing as std_msgs/msg/Header'
    until(lambda: any(other in dict(one.values) for one in statuses(bag)), 'the other type')
    process.send_signal(signal.SIGTERM)
    out, errors = finish(process)
    second.kill()
    values = dict(statuses(bag)[-1].values)
    assert values[other] == 'not recorded: in this bag the topic has the type std_msgs/msg/Bool'
    assert values['/nobody'] == 'not recorded: nobody publishes it'
    assert errors.count(f'{other} is not recorded') == 1
    assert '; nobody published /nobody; ' in out
    assert set(counts(bag)) == {'/changing', '/diagnostics'}


def test_a_list_takes_the_clock_along(lab: Lab) -> None:
    process = recorder(lab, 'topics:=[unreliable, /_hidden]', 'split_time:=0.3')
    publishers = lab.start(PUBLISHERS, 'mixed')
    for topic in ('/unreliable', '/_hidden'):
        until(lambda topic=topic: heard(lab.path / 'bag', topic), f'messages on {topic}')
    until(lambda: len(list((lab.path / 'bag').glob('*.mcap'))) >= 3, 'the third file')
    end(process)
    publishers.kill()
    assert set(counts(lab.path / 'bag')) == {'/unreliable', '/_hidden', '/clock'}
    with AnyReader([lab.path / 'bag']) as reader:
        assert reader.message_count == sum(counts(lab.path / 'bag').values())


def test_snapshot_on_demand(lab: Lab) -> None:
    process = recorder(lab, 'all:=true', 'snapshot:=true', 'snapshot_time:=0.5')
    publishers = lab.start(PUBLISHERS, 'mixed')
    said = ''
    for number in range(20):
        said, _ = finish(lab.start(PUBLISHERS, 'call', '/recorder/snapshot'))
        words = re.fullmatch(rf'True (\d+) messages of (0\.\d+) s in (.*/bag/snapshot_{number})\n', said)
        assert words, said
        if int(words[1]) > 20:
            break
    end(process)
    publishers.kill()
    with AnyReader([Path(words[3])]) as reader:
        assert reader.message_count == int(words[1]) > 20
        assert (reader.end_time - reader.start_time) * 1e-9 <= 0.5


def test_killed_recorder_keeps_all_but_the_last_second(lab: Lab) -> None:
    process = recorder(lab, 'regex:=^/unreliable$')
    publishers = lab.start(PUBLISHERS, 'mixed')
    until(lambda: heard(lab.path / 'bag', '/unreliable', 100), 'messages in the bag')
    process.kill()
    killed = time.time_ns()
    process.communicate()
    publishers.kill()
    stream = read_messages(lab.path / 'bag')
    last = [message.log_time for message in stream][-1]
    assert not stream.complete
    assert (killed - last) * 1e-9 < 1.0


def test_full_disk_is_said_and_what_was_written_stays(lab: Lab) -> None:
    """A limit of the file size stands for a full disk; a second recorder hears what the first one says."""
    witness = recorder(lab, 'topics:=[/diagnostics]', name='witness')
    limit = 1_500_000
    arguments = ['-p', f'directory:={lab.path / "bag"}', '-p', 'regex:=^/flood/', '-p', 'compression:=none']
    process = subprocess.Popen(
        [sys.executable, '-m', 'omni_vehicle_ros.executables', 'nodes.recorder', '--ros-args', *arguments],
        env=lab.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
    )
    lab.processes.append(process)
    flood = lab.start(PUBLISHERS, 'flood', '0', '4', '1000', '60.0')
    out, errors = process.communicate(timeout=60)
    flood.kill()
    assert process.returncode == 2
    (line,) = [line for line in errors.splitlines() if line.startswith('error: ')]
    assert line.endswith('File too large; what was written before stays readable')
    assert 'Traceback' not in errors
    kept = len(list(read_messages(lab.path / 'bag')))
    written = int(re.search(r'recorded (\d+) messages', out)[1])
    # The message at which the disk was full does not count, but may have come through.
    assert 0 < kept <= written + 1
    assert written - kept < 4000
    end(witness)
    assert any('the recording has ended' in one.message and one.level == 2 for one in statuses(lab.path / 'witness'))


def test_a_choice_in_lock_step_is_refused(lab: Lab) -> None:
    process = lab.node('recorder', '-p', 'all:=true', '-p', 'pacing:=lockstep', '-p', f'directory:={lab.path / "bag"}')
    _, errors = finish(process, 2)
    assert 'error: topics, regex and all need pacing realtime' in errors
    assert not (lab.path / 'bag').exists()


def test_a_bad_pattern_is_one_plain_line(lab: Lab) -> None:
    process = lab.node('recorder', '-p', 'regex:="["', '-p', f'directory:={lab.path / "bag"}')
    _, errors = finish(process, 2)
    assert re.search(r"error: regex: '\[' is no regular expression", errors)
    assert not (lab.path / 'bag').exists()




def test_statistics_of_the_vehicle_in_real_time(lab: Lab) -> None:
    """Cycles are numbered by their stamps, so losses are known of the topics that have a message in each."""
    plant = lab.node('plant')
    process = recorder(lab)
    bag = lab.path / 'bag'
    until(lambda: heard(bag, '/joint_states', 500), 'some cycles')
    end(process)
    plant.send_signal(signal.SIGTERM)
    finish(plant)
    found = [dict(one.values) for one in statuses(bag) if one.name == '/recorder' and one.values]
    assert re.fullmatch(r'\d+\.\d messages/s, \d+ B/s, \d+ messages, \d+ lost', found[-1]['/joint_states'])
    assert int(found[-1]['messages']) > 200
