"""What is due when, on a clock of the test."""

from itertools import chain

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.bags import RecordedMessage
from omni_vehicle_ros.bags.player import BATCH, CLOCK, Entry, Player, PlayerSettings
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.messages import decode

MS = 1_000_000
LATCHED = {'/map': 1, '/tf_static': 3}


def message(topic: str, time: int) -> RecordedMessage:
    return RecordedMessage(topic, 'std_msgs/msg/String', time, f'{topic} {time}'.encode())


class Bag:
    """Messages that can be read again and again; knows how many were asked for."""

    def __init__(self, *messages: tuple[str, int]) -> None:
        self.messages = [message(topic, time) for topic, time in messages]
        self.read = 0

    def __iter__(self):
        for one in self.messages:
            self.read += 1
            yield one


def player(bag, chosen=lambda topic: True, **options) -> Player:
    return Player(bag, chosen, lambda topic: LATCHED.get(topic, 0), PlayerSettings(**options))


def said(entries: list[Entry]) -> list[tuple[str, int]]:
    """Return topics and recorded times, the latter from the bytes."""
    return [(entry.data.decode().split()[0], int(entry.data.decode().split()[1])) for entry in entries]


def everything(played: Player, step: int = MS) -> list[tuple[str, int]]:
    found, now = [], 0
    while not played.finished:
        found += said(played.due(now))
        now += step
    return found


@given(
    st.lists(st.tuples(st.sampled_from(['/a', '/b']), st.integers(0, 50)), min_size=1, max_size=30),
    st.sampled_from([0.5, 1.0, 4.0]),
    st.lists(st.integers(0, 30), min_size=1, max_size=20),
)
@settings(deadline=None)
def test_all_is_given_in_order_and_nothing_before_its_time(entries, rate, waits):
    times = sorted(time * MS for _, time in entries)
    bag = Bag(*((topic, time) for (topic, _), time in zip(entries, times, strict=True)))
    played = player(bag, rate=rate)
    now, found = 7_000 * MS, []
    for wait in [*waits, 1000]:
        due = said(played.due(now))
        elapsed = (now - 7_000 * MS) * rate
        assert all(time - times[0] <= elapsed for _, time in due)
        found += due
        late = [time for time in times[len(found) :] if time - times[0] <= elapsed]
        assert not late
        now += wait * MS
    found += said(played.due(now))
    assert found == [(one.topic, one.log_time) for one in bag.messages]


def test_wait_tells_when_the_next_is_due():
    played = player(Bag(('/a', 0), ('/a', 20 * MS), ('/a', 10_000 * MS)), rate=2.0)
    assert said(played.due(0)) == [('/a', 0)]
    assert played.wait(0) == pytest.approx(0.010)
    assert played.wait(4 * MS) == pytest.approx(0.006)
    assert played.due(9 * MS) == []
    assert said(played.due(10 * MS)) == [('/a', 20 * MS)]
    assert played.wait(10 * MS) == 0.05


def test_latched_topics_come_first_even_within_the_first_instant():
    bag = Bag(('/a', 5), ('/b', 5), ('/map', 5), ('/a', 6))
    assert everything(player(bag)) == [('/map', 5), ('/a', 5), ('/b', 5), ('/a', 6)]


def test_a_begin_in_the_middle_sends_what_was_latched_before():
    before = [('/map', 1), ('/tf_static', 1), ('/a', 2), ('/map', 3), *(('/tf_static', time) for time in range(4, 8))]
    bag = Bag(('/a', 0), *before, ('/a', 1000), ('/map', 1000), ('/b', 1001))
    expected = [*(('/tf_static', time) for time in range(5, 8)), ('/map', 1000), ('/a', 1000), ('/b', 1001)]
    assert everything(player(bag, start=1000e-9)) == [('/map', 3), *expected]


def test_duration_ends_before_the_end():
    bag = Bag(*(('/a', time * MS) for time in range(100)))
    found = everything(player(bag, start=0.010, duration=0.005))
    assert found == [('/a', time * MS) for time in range(10, 15)]


def test_parts_put_together_are_the_whole():
    bag = Bag(*((topic, time * MS) for time in range(20) for topic in ('/a', '/b')))
    parts = [everything(player(bag, start=begin * 1e-3, duration=5e-3)) for begin in (0, 5, 10, 15)]
    assert [*chain.from_iterable(parts)] == everything(player(bag))


def test_loop_begins_again_and_keeps_the_time_between_messages():
    bag = Bag(('/map', 0), ('/a', 0), ('/a', 10 * MS))
    played = player(bag, loop=True)
    found = {}
    for now in range(0, 200):
        for entry in said(played.due(now * MS)):
            found.setdefault(entry, []).append(now)
    assert not played.finished
    first, last = found['/a', 0], found['/a', 10 * MS]
    assert len(last) >= 3
    assert found['/map', 0] == first
    assert all(end - begin == 10 for begin, end in zip(first, last, strict=False))


def test_a_loop_of_one_instant_is_no_flood():
    played = player(Bag(('/map', 5 * MS)), loop=True, clock=True)
    said = [entry.topic for now in range(1000) for entry in played.due(now * MS)]
    assert said.count('/map') == 20
    assert said[:2] == [CLOCK, '/map']


@pytest.mark.parametrize('chosen', [lambda topic: False, lambda topic: True], ids=['nothing chosen', 'empty'])
def test_nothing_to_loop_is_an_end(chosen):
    played = player(Bag(('/a', 0)) if not chosen('') else Bag(), chosen, loop=True)
    assert played.due(0) == []
    assert played.finished


def test_a_begin_after_the_end_plays_nothing():
    assert everything(player(Bag(('/map', 0), ('/a', 10)), start=1.0)) == []


def test_choice_of_topics():
    bag = Bag(('/a', 0), ('/b', 1), ('/map', 2))
    assert everything(player(bag, lambda topic: topic == '/b')) == [('/b', 1)]


def test_pause_stops_time_and_resume_goes_on_from_there():
    played = player(Bag(('/a', 0), ('/a', 10 * MS), ('/a', 20 * MS)))
    played.due(0)
    played.pause(4 * MS)
    assert played.due(500 * MS) == []
    played.resume(1000 * MS)
    assert played.due(1005 * MS) == []
    assert said(played.due(1006 * MS)) == [('/a', 10 * MS)]
    played.pause(1010 * MS)
    played.pause(1012 * MS)
    played.resume(1013 * MS)
    assert said(played.due(1019 * MS)) == [('/a', 20 * MS)]


def test_a_step_is_all_that_has_one_time():
    played = player(Bag(('/a', 0), ('/a', 10 * MS), ('/b', 10 * MS), ('/a', 50 * MS), ('/a', 60 * MS)))
    played.due(0)
    played.pause(MS)
    assert said(played.step(2 * MS)) == [('/a', 10 * MS), ('/b', 10 * MS)]
    assert said(played.step(3 * MS)) == [('/a', 50 * MS)]
    assert played.due(900 * MS) == []
    played.resume(1000 * MS)
    assert played.due(1009 * MS) == []
    assert said(played.due(1010 * MS)) == [('/a', 60 * MS)]
    assert played.step(1011 * MS) == []
    assert played.finished


def test_the_position_counts_from_the_first_message_as_the_start_does():
    played = player(Bag(('/a', 5000 * MS), ('/a', 5250 * MS), ('/a', 5500 * MS)), start=0.2)
    assert (played.first, played.position) == (None, 0.0)
    played.pause(0)
    played.step(MS)
    assert (played.first, played.position) == (5000 * MS, 0.25)
    played.step(2 * MS)
    assert played.finished
    assert played.position == 0.5
    empty = player(Bag())
    assert empty.due(0) == []
    assert (empty.finished, empty.first, empty.position) == (True, None, 0.0)


def test_a_made_clock_runs_with_the_bag_and_replaces_its_own():
    bag = Bag(('/a', 1000 * MS), (CLOCK, 1001 * MS), ('/a', 1100 * MS))
    played = player(bag, rate=2.0, clock=True)
    times, others = [], []
    for now in range(0, 60):
        for entry in played.due(now * MS):
            if entry.topic == CLOCK:
                times.append((now, decode(entry.type_name, entry.data).stamp))
            else:
                others.append(entry)
                assert times[-1][1] <= entry.time
    assert times == [(now, (1000 + 2 * now) * MS) for now in range(0, 60, 10) if now <= 50]
    assert said(others) == [('/a', 1000 * MS), ('/a', 1100 * MS)]


@given(st.lists(st.integers(1, 400), min_size=10, max_size=30))
@settings(deadline=None)
def test_a_made_clock_never_passes_what_is_still_to_come(waits):
    """However late it is asked, so that nobody hears of a time before its messages, nor of one after the end."""
    played, now, clock = player(Bag(*(('/a', number * 50 * MS) for number in range(40))), clock=True), 0, 0
    for wait in waits:
        for entry in played.due(now * MS):
            if entry.topic == CLOCK:
                assert clock <= entry.time <= 39 * 50 * MS
                clock = entry.time
            else:
                assert entry.time >= clock
        now += wait


def test_a_made_clock_stands_still_in_a_pause_and_jumps_in_a_step():
    played = player(Bag(('/a', 0), ('/a', 500 * MS)), clock=True)
    played.due(0)
    played.pause(2 * MS)
    assert played.due(400 * MS) == []
    clock, entry = played.step(401 * MS)
    assert decode(clock.type_name, clock.data).stamp == entry.time == 500 * MS


def test_messages_out_of_order_go_out_at_once_and_time_does_not_go_back():
    bag = Bag(('/a', 0), ('/a', 20 * MS), ('/b', 15 * MS), ('/a', 30 * MS))
    played = player(bag)
    assert said(played.due(0)) == [('/a', 0)]
    late = played.due(20 * MS)
    assert said(late) == [('/a', 20 * MS), ('/b', 15 * MS)]
    assert [entry.time for entry in late] == [20 * MS, 20 * MS]


def test_no_more_is_read_than_is_due():
    bag = Bag(*(('/a', time * MS) for time in range(100_000)))
    played = player(bag)
    for now in range(0, 100, 7):
        played.due(now * MS)
        assert bag.read <= now + 3


def test_much_comes_in_parts_and_a_search_gives_way():
    bag = Bag(*(('/a', 0) for _ in range(3 * BATCH)))
    played = player(bag)
    assert [len(played.due(MS)) for _ in range(3)] == [BATCH] * 3
    long = Bag(*(('/a', time) for time in range(10_000)))
    played = player(long, start=9_999e-9)
    assert played.due(0) == []
    assert long.read < 5_000
    assert played.wait(0) == 0.0
    assert everything(played) == [('/a', 9_999)]


@pytest.mark.parametrize('wrong', [{'rate': 0.0}, {'rate': float('nan')}, {'start': -1.0}, {'duration': 0.0}])
def test_numbers_are_checked(wrong):
    with pytest.raises(BagError, match=f'--{next(iter(wrong))}: .* is outside'):
        PlayerSettings(**wrong)
