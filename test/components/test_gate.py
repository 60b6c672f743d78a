"""The gate: a cycle is complete when all that belongs to it is there, whatever the order."""

import itertools

from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.components.gate import Gate


def test_opens_only_with_the_beat() -> None:
    gate = Gate(['command'])
    gate.answer('command', 5)
    assert gate.ready() is None
    gate.open(5)
    assert gate.ready() == 5


def test_order_does_not_matter() -> None:
    events = ('beat', 'command', 'trim', 'icr', 'step')
    for order in itertools.permutations(events):
        gate = Gate(['command', 'trim', 'driver/step'])
        for event in order:
            assert gate.ready() is None
            if event == 'beat':
                gate.open(10)
            elif event == 'icr':
                gate.hear('driver/icr', 0)
            elif event == 'step':
                gate.announce(['driver/icr'])
                gate.answer('driver/step', 10)
            else:
                gate.answer(event, 10)
        assert gate.ready() == 10


def test_an_announced_message_is_waited_for() -> None:
    gate = Gate(['driver/step'])
    gate.open(0)
    gate.announce(['driver/icr'])
    gate.answer('driver/step', 0)
    assert gate.ready() is None
    assert gate.absent() == 'driver/icr'
    gate.hear('driver/icr', 0)
    assert gate.ready() == 0


def test_what_is_given_up_is_waited_for_again_after_it_answers() -> None:
    gate = Gate(['a', 'b'])
    gate.open(1)
    gate.answer('a', 1)
    assert gate.ready() is None
    gate.give_up()
    assert gate.ready() == 1
    assert gate.missing() == ('b',)
    gate.close()
    gate.open(2)
    gate.answer('a', 2)
    assert gate.ready() == 2
    gate.close()
    gate.answer('b', 2)
    gate.open(3)
    gate.answer('a', 3)
    assert gate.ready() is None
    gate.answer('b', 3)
    assert gate.ready() == 3


def test_a_new_beat_skips_the_old_cycle() -> None:
    gate = Gate(['a'])
    gate.open(1)
    gate.open(2)
    assert gate.ready() == 2
    assert gate.missing() == ('a',)


@settings(deadline=None)
@given(st.lists(st.tuples(st.sampled_from(['open', 'a', 'b', 'close', 'give up']), st.integers(0, 5)), max_size=40))
def test_never_ready_while_a_source_that_counts_is_behind(events: list[tuple[str, int]]) -> None:
    gate = Gate(['a', 'b'])
    latest = {'a': -1, 'b': -1}
    for event, stamp in events:
        if event == 'open':
            gate.open(stamp)
        elif event == 'close':
            gate.close()
        elif event == 'give up':
            gate.give_up()
        else:
            gate.answer(event, stamp)
            latest[event] = max(latest[event], stamp)
        ready = gate.ready()
        if ready is not None:
            assert all(latest[source] >= ready or source in gate.lost for source in latest)


def test_a_clock_that_goes_back_is_waited_for_anew() -> None:
    """Answers from before count no more, but one for the new time that came ahead of the beat does."""
    gate = Gate(['odom', 'imu'])
    gate.open(100)
    gate.answer('odom', 100)
    gate.answer('imu', 100)
    assert gate.ready() == 100
    gate.close()
    gate.answer('odom', 40)
    gate.open(40)
    assert gate.ready() is None
    assert gate.absent() == 'imu'
    gate.answer('imu', 40)
    assert gate.ready() == 40
    gate.close()
    gate.open(45)
    assert gate.absent() == 'odom, imu'


def test_what_belongs_to_the_cycle_before_is_awaited_from_the_second_cycle_on() -> None:
    gate = Gate([], ['state'])
    gate.open(0)
    assert gate.ready() == 0
    gate.close()
    gate.open(5)
    assert gate.ready() is None and gate.missing() == ('state',)
    gate.answer('state', 0)
    assert gate.ready() == 5 and gate.missing() == ()
    gate.close()
    gate.answer('state', 5)
    gate.open(10)
    assert gate.ready() == 10


def test_what_belongs_to_the_cycle_before_can_be_given_up_alone() -> None:
    gate = Gate(['command'], ['state'])
    gate.open(0)
    gate.answer('command', 0)
    gate.close()
    gate.open(5)
    gate.give_up_previous()
    assert gate.lost == {'state'} and gate.ready() is None
    gate.answer('command', 5)
    assert gate.ready() == 5 and gate.missing() == ('state',)
    gate.close()
    gate.answer('state', 5)
    gate.open(10)
    gate.answer('command', 10)
    assert gate.ready() == 10 and gate.lost == set()


def test_a_clock_that_goes_back_awaits_nothing_of_the_cycle_before() -> None:
    gate = Gate([], ['state'])
    for stamp in (100, 105):
        gate.open(stamp)
        gate.answer('state', 100)
        gate.close()
    gate.open(10)
    assert gate.ready() == 10


def test_what_only_waits_to_be_fetched_is_known():
    gate = Gate(('a', 'b'))
    assert not gate.awaits_only({'a', 'b'})
    gate.open(1)
    assert gate.awaits_only({'a', 'b'}) and not gate.awaits_only({'a'})
    gate.hear('b', 1)
    assert gate.awaits_only({'a'})
    gate.hear('a', 1)
    assert not gate.awaits_only({'a'})


def test_who_is_always_late_keeps_nobody_waiting_who_is_not_patient() -> None:
    """Two answers to a cycle, one in time and one after the next beat: each cycle is acted on, without the late one."""
    gate, acted = Gate(['command', 'trim'], patient=False), []

    def act() -> None:
        if gate.ready() is not None:
            acted.append((gate.ready(), gate.missing()))
            gate.close()

    for k in range(1, 100):
        gate.open(k)
        act()
        if k > 1:
            gate.answer('trim', k - 1)
            act()
        gate.answer('command', k)
        act()
    assert acted == [(k, ('trim',)) for k in range(2, 100)]


def test_who_is_in_time_again_is_waited_for_again() -> None:
    gate = Gate(['a'], patient=False)
    gate.open(1)
    gate.open(2)
    assert gate.ready() == 2
    gate.close()
    gate.answer('a', 2)
    gate.open(3)
    assert gate.ready() is None
    gate.answer('a', 3)
    assert gate.ready() == 3


def test_one_source_can_be_given_up_before_and_while_it_is_awaited() -> None:
    """The others are waited for as before, and it is, too, once it answers again."""
    gate = Gate(['a', 'b'], ['state'])
    gate.open(0)
    gate.give_up_on(['a', 'nobody'])
    assert gate.ready() is None and gate.absent() == 'b'
    gate.answer('b', 0)
    assert gate.ready() == 0 and gate.missing() == ('a',)
    gate.close()
    gate.give_up_on(['state'])
    gate.open(5)
    gate.answer('b', 5)
    assert gate.ready() == 5 and gate.missing() == ('a', 'state')
    gate.close()
    gate.answer('a', 5)
    gate.open(10)
    assert gate.absent() == 'a, b'


def test_nothing_that_was_announced_by_a_dead_driver_is_awaited() -> None:
    gate = Gate(['driver/step'])
    gate.open(0)
    gate.announce(['driver/icr'])
    gate.give_up_on(['driver/step'])
    assert gate.ready() is None
    gate.forget_announced()
    assert gate.ready() == 0
