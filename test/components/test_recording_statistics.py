"""What a recorder says about messages, bytes, rates and losses, and what it must not claim to know."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.components.recording_statistics import SECOND, RecordingStatistics, TopicStatistics


def heard(numbers, publishers=('a',), looks=1):
    topic = TopicStatistics()
    topic.look(publishers)
    for number in numbers:
        topic.add(10, number)
    for _ in range(looks):
        topic.look(publishers)
    return topic


@settings(deadline=None)
@given(st.lists(st.integers(1, 500), min_size=1, unique=True), st.integers(0, 1000))
def test_losses_are_the_gaps_after_the_first_message(numbers, first):
    numbers = sorted(number + first for number in numbers)
    topic = heard(numbers)
    assert topic.lost == numbers[-1] - numbers[0] + 1 - len(numbers)
    assert (topic.count, topic.size, topic.unknown) == (len(numbers), 10 * len(numbers), False)


def test_losses_of_several_publishers_are_not_claimed_to_be_known():
    topic = heard([1, 1, 2, 7, 3, 900], publishers=('a', 'b'))
    assert topic.lost == 0
    assert topic.unknown


def test_a_publisher_that_joins_between_looks_makes_no_false_losses():
    topic = TopicStatistics()
    topic.look(['a'])
    for number in (5000, 1, 5001, 2, 5002):
        topic.add(1, number)
    topic.look(['a', 'b'])
    assert (topic.lost, topic.unknown) == (0, True)


def test_a_publisher_that_starts_again_makes_no_false_losses():
    topic = heard([7, 8, 9, 1, 2])
    assert topic.lost == 0
    topic.look(['b'])  # the new one is seen
    topic.add(1, 400)
    topic.add(1, 402)
    topic.look(['b'])
    assert topic.lost == 1


def test_a_message_without_a_number_leaves_losses_unknown():
    topic = heard([None])
    assert topic.unknown


def test_rates_are_those_since_the_last_report():
    statistics = RecordingStatistics()
    topic = statistics.topics.setdefault('/odom', TopicStatistics())
    topic.look(['a'])
    statistics.values(5 * SECOND, {})
    for number in range(300):
        topic.add(20, number)
    values = dict(statistics.values(7 * SECOND, {'/image': 'its type is not installed'}))
    assert values['/odom'] == '150.0 messages/s, 3000 B/s, 300 messages, 0 lost'
    assert values['/image'] == 'not recorded: its type is not installed'
    assert (values['messages'], values['bytes'], values['losses']) == ('300', '6000', '0 lost')
    assert dict(statistics.values(8 * SECOND, {}))['/odom'].startswith('0.0 messages/s, 0 B/s, 300 messages')


def test_losses_are_fresh_once():
    statistics = RecordingStatistics()
    statistics.topics['/odom'] = heard([1, 5])
    assert [statistics.fresh_losses(), statistics.fresh_losses()] == [3, 0]


@pytest.mark.parametrize(
    ('publishers', 'tail'), [(('a',), ', 3 lost'), (('a', 'b'), ', 0 lost; losses not known on /odom')]
)
def test_the_summary_names_the_topics_whose_losses_are_not_known(publishers, tail):
    statistics = RecordingStatistics()
    statistics.topics['/odom'] = heard([1, 5], publishers)
    assert statistics.summary() == f'recorded 2 messages{tail}'
