"""Which topics are recorded, and that a subscription never asks for more than all publishers offer."""

import itertools

import pytest

from omni_vehicle_ros.bags.metadata import OfferedQos
from omni_vehicle_ros.components.topic_choice import Request, TopicChoice, request_for, weaker
from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.interface import resolve
from omni_vehicle_ros.parameters import RecorderParameters

TOPICS = ('/odom', '/car/odom', '/car/image', '/car/_hidden/status', '/rosout', '/clock')


def taken(namespace='', **values):
    choice = TopicChoice(RecorderParameters(**values), lambda name: resolve(name, namespace))
    return [topic for topic in TOPICS if choice.takes(topic)]


@pytest.mark.parametrize(
    ('values', 'expected'),
    [
        ({'all': True}, ['/odom', '/car/odom', '/car/image', '/rosout', '/clock']),
        ({'all': True, 'exclude': ('/rosout', '/car/.*')}, ['/odom', '/clock']),
        ({'all': True, 'exclude': ('odom', '.*image', '/clock')}, ['/car/odom', '/rosout']),
        ({'topics': ('/odom',)}, ['/odom', '/clock']),
        ({'topics': ('/car/_hidden/status',)}, ['/car/_hidden/status', '/clock']),
        ({'topics': ('odom',), 'namespace': '/car'}, ['/car/odom', '/clock']),
        ({'topics': ('/odom',), 'regex': 'image$'}, ['/odom', '/car/image', '/clock']),
        ({'regex': 'odom'}, ['/odom', '/car/odom', '/clock']),
        ({'regex': '.*'}, ['/odom', '/car/odom', '/car/image', '/rosout', '/clock']),
        ({'regex': 'odom', 'exclude': ('/car/odom',)}, ['/odom', '/clock']),
    ],
)
def test_what_is_taken(values, expected):
    assert taken(**values) == expected


def test_without_a_choice_it_is_the_vehicle_that_is_recorded():
    assert not RecorderParameters().chooses
    assert all(RecorderParameters(**one).chooses for one in ({'all': True}, {'topics': ('a',)}, {'regex': 'a'}))


def test_an_exclusion_from_nothing_is_refused_and_a_name_is_no_list():
    with pytest.raises(ParameterError, match='exclude: goes with all, topics or regex'):
        RecorderParameters(exclude=('/rosout',))
    with pytest.raises(ParameterError, match=r"topics: '/odom' must be a list, such as \[/odom\]"):
        RecorderParameters(topics='/odom')


def test_the_names_that_are_waited_for_are_those_that_are_taken():
    parameters = RecorderParameters(topics=('odom', '/imu', '/b'), exclude=('/b',))
    choice = TopicChoice(parameters, lambda name: resolve(name, 'car'))
    assert choice.named == {'/car/odom', '/imu'}


@pytest.mark.parametrize('values', [{'regex': '('}, {'exclude': ('a', '[')}])
def test_a_pattern_that_is_none_is_refused_by_name(values):
    with pytest.raises(ParameterError, match=f'{next(iter(values))}: .* is no regular expression'):
        RecorderParameters(all=True, **values)


OFFERS = [
    OfferedQos(reliability=reliability, durability=durability)
    for reliability in ('reliable', 'best_effort') for durability in ('transient_local', 'volatile')
]


@pytest.mark.parametrize('offers', list(itertools.product(OFFERS, repeat=2)))
def test_every_publisher_can_give_what_is_asked_for(offers):
    request = request_for(offers)
    for offer in offers:
        assert offer.reliability == 'reliable' or not request.reliable
        assert offer.durability == 'transient_local' or not request.latched
    assert request_for(offers[:1] * 2) == request_for(offers[:1])
    assert weaker(request, request_for(offers[:1])) == request


def test_what_all_offer_is_asked_for():
    assert request_for(OFFERS[:1] * 2) == Request(reliable=True, latched=True)
