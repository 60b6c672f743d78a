"""Which topics are played, and with what quality of service."""

import pytest

from omni_vehicle_ros.bags.metadata import INFINITE, OfferedQos
from omni_vehicle_ros.bags.source import TopicFacts
from omni_vehicle_ros.components.topic_playing import TopicPlaying, combined_offer, latched_depth, unplayable
from omni_vehicle_ros.errors import BagError

KNOWN = ('/odom', '/car/driver/icr', '/car/driver/step', '/environment/bank', '/tf_static')
LATCHED = OfferedQos(depth=1, durability='transient_local')


def played(playing):
    return {name for name in KNOWN if playing.plays(name)}


def test_choice():
    assert played(TopicPlaying()) == {*KNOWN}
    assert played(TopicPlaying(['odom', '/tf_static'])) == {'/odom', '/tf_static'}
    assert played(TopicPlaying(commands_only=True)) == {'/car/driver/icr', '/environment/bank'}
    assert played(TopicPlaying(['/odom', '/environment/bank'], commands_only=True)) == {'/environment/bank'}


def test_what_is_not_there_is_said():
    TopicPlaying(['odom']).check('bag', KNOWN)
    with pytest.raises(BagError, match=r"bag has no topic /odm; did you mean '/odom'\?"):
        TopicPlaying(['odm']).check('bag', KNOWN)
    with pytest.raises(BagError, match='bag holds no commands: driver/icr'):
        TopicPlaying(commands_only=True).check('bag', ['/odom'])
    with pytest.raises(BagError, match='bag holds no messages'):
        TopicPlaying().check('bag', [])


def test_one_publisher_offers_what_it_offered():
    exact = OfferedQos('keep_last', 7, 'best_effort', 'volatile', 10**7, 10**8, 'manual_by_topic', 10**9, True)
    assert combined_offer([exact]) == exact
    assert combined_offer([LATCHED]) == LATCHED


def test_one_publisher_in_the_place_of_several_serves_all_who_listened():
    mixed = combined_offer([LATCHED, OfferedQos(depth=5, reliability='best_effort', deadline=10**7)])
    assert (mixed.reliability, mixed.durability, mixed.depth) == ('reliable', 'transient_local', 6)
    assert mixed.deadline == INFINITE
    assert combined_offer([LATCHED] * 3).depth == 3


def test_an_unknown_depth_is_no_depth_of_zero():
    """As rosbag2 records publishers over Fast DDS, whose history can't be seen."""
    unknown = OfferedQos(history='unknown', depth=0)
    assert combined_offer([unknown]).history == 'keep_last'
    assert combined_offer([unknown]).depth >= 10
    assert combined_offer([]).depth >= 10


def test_depth_of_what_is_latched():
    assert latched_depth([]) == latched_depth([OfferedQos()]) == 0
    assert latched_depth([LATCHED, LATCHED, OfferedQos()]) == 2
    assert latched_depth([LATCHED._replace(history='unknown', depth=0)]) == 1
    assert latched_depth([LATCHED._replace(depth=10**9)]) <= 1000


def test_messages_of_another_definition_or_encoding_are_not_played():
    facts = TopicFacts('std_msgs/msg/String', type_hash='RIHS01_aa')
    assert unplayable(facts, 'RIHS01_aa') == unplayable(facts, '') == ''
    assert unplayable(facts._replace(type_hash=''), 'RIHS01_aa') == ''
    assert 'another definition' in unplayable(facts, 'RIHS01_bb')
    assert 'json' in unplayable(facts._replace(encoding='json'), '')
