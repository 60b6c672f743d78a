"""The journal: the order of a recording does not depend on the order of arrival, and gaps are counted."""

import random

from omni_vehicle_ros.components.journal import Journal
from omni_vehicle_ros.faults import faults_message, make_fault
from omni_vehicle_ros.interface import Qos, topic
from omni_vehicle_ros.messages import Diagnostics, Joints, Point, Status, encode

PERIOD = 5_000_000


class Memory:
    """Keeps what is written."""

    def __init__(self) -> None:
        self.rows: list[tuple[str, bytes, int]] = []

    def add_topic(self, name: str, type_name: str, qos: Qos) -> None:
        """Do nothing."""

    def write(self, name: str, data: bytes, log_time: int) -> None:
        """Keep a message."""
        self.rows.append((name, data, log_time))


def message(name: str, stamp: int, text: str = '') -> tuple[str, bytes]:
    if name == '/diagnostics':
        return name, encode(topic(name).type, Diagnostics(stamp, (Status(0, text, ''),)))
    return name, encode(topic(name).type, Joints(stamp, ('a',), (1.0,)))


def cycle(number: int) -> list[tuple[str, bytes]]:
    stamp = number * PERIOD
    names = ('front_left/command', 'front_left/state', 'joint_states')
    return [*(message(name, stamp) for name in names), *(message('/diagnostics', stamp, node) for node in 'ab')]


def test_order_of_arrival_within_a_cycle_does_not_matter() -> None:
    written = []
    for seed in range(20):
        memory = Memory()
        journal = Journal(memory, 'car', PERIOD)
        for number in range(6):
            arrivals = cycle(number)
            random.Random(seed * 100 + number).shuffle(arrivals)
            for name, data in arrivals:
                journal.add(name, data)
        journal.flush()
        written.append(memory.rows)
        assert journal.lost == 0
        assert journal.written == 30
    assert all(rows == written[0] for rows in written)
    assert [row[2] for row in written[0]] == sorted(row[2] for row in written[0])
    assert {row[0] for row in written[0]} == {
        '/car/front_left/command',
        '/car/front_left/state',
        '/car/joint_states',
        '/diagnostics',
    }


def test_missing_cycles_are_counted() -> None:
    journal = Journal(Memory(), '', PERIOD)
    for number in (0, 1, 2, 5, 6):
        for name, data in cycle(number):
            journal.add(name, data)
    journal.flush()
    assert journal.lost == 3 * 2
    assert not journal.complete(7 * PERIOD)
    assert journal.complete(6 * PERIOD)


def test_of_a_clock_that_jumps_nothing_is_missing_but_what_is() -> None:
    """Ahead by 30 cycles, which the topic of faults tells, and back by 20; one cycle is really missing."""
    journal = Journal(Memory(), '', PERIOD)
    told = {10: 30 * PERIOD / 1e9, 50: -20 * PERIOD / 1e9}
    for number in (*range(11), *range(41, 51), *range(31, 60), *range(61, 100)):
        for name, data in cycle(number):
            journal.add(name, data)
        if number in told:
            fault = make_fault('clock', 'wrong', told.pop(number))
            journal.add('faults', encode(topic('faults').type, faults_message(number * PERIOD, [fault])))
    journal.flush()
    assert journal.lost == 3  # topics of cycle 60
    assert journal.complete(99 * PERIOD)


def test_stamps_of_other_clocks_are_logged_at_simulated_time() -> None:
    memory = Memory()
    journal = Journal(memory, '', PERIOD)
    for number in range(400):
        journal.add(*message('joint_states', number * PERIOD))
    for stamp in (0, 1_700_000_000 * 10**9):
        journal.add('driver/icr', encode('geometry_msgs/msg/PointStamped', Point(stamp, 0.0, 5.0)))
    journal.flush()
    assert [row[2] for row in memory.rows if row[0] == '/driver/icr'] == [399 * PERIOD] * 2


def test_what_was_said_at_the_start_is_logged_there_however_late_it_comes() -> None:
    """In lock step the plant may be cycles ahead when the first message of another node comes in."""
    memory = Memory()
    journal = Journal(memory, '', PERIOD)
    for number in range(16):
        journal.add(*message('joint_states', number * PERIOD))
    journal.add(*message('/diagnostics', 0, 'a'))
    journal.flush()
    assert [row[2] for row in memory.rows if row[0] == '/diagnostics'] == [0]


def test_a_recording_is_complete_without_what_a_dead_node_would_say() -> None:
    journal = Journal(Memory(), 'car', PERIOD)
    for name, data in cycle(0):
        journal.add(name, data)
    journal.add(*message('front_left/command', PERIOD))
    journal.add(*message('joint_states', PERIOD))
    assert not journal.complete(PERIOD)
    journal.miss(['front_left/state', 'ready'])
    assert journal.complete(PERIOD)
    journal.add(*message('front_left/state', 0))
    assert not journal.complete(PERIOD)
