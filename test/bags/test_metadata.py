"""``metadata.yaml`` and its copy in the MCAP file hold what rosbag2 Jazzy decodes, with the types that it asks for.

The fields are those of rosbag2 0.26, ``rosbag2_storage/yaml.hpp`` and ``qos.cpp``, whose yaml-cpp converts the text of
a scalar: no null becomes a string, no negative number or fraction an unsigned one, no number beyond 32 bits an int.
"""

import re

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader

from omni_vehicle_ros.bags.metadata import (
    INFINITE,
    FileRecord,
    OfferedQos,
    TopicRecord,
    as_yaml,
    bag_information,
    qos_profiles,
)

HASH = 'RIHS01_' + '0123456789abcdef' * 4
WORDS = {  # of rmw/qos_string_conversions.c
    'history': ('system_default', 'keep_last', 'keep_all', 'unknown'),
    'reliability': ('system_default', 'reliable', 'best_effort', 'best_available', 'unknown'),
    'durability': ('system_default', 'transient_local', 'volatile', 'best_available', 'unknown'),
    'liveliness': ('system_default', 'automatic', 'manual_by_topic', 'best_available', 'unknown'),
}
TIME = {'sec': 'uint64', 'nsec': 'uint64'}
QOS = {
    'history': WORDS['history'],
    'depth': 'int',
    'reliability': WORDS['reliability'],
    'durability': WORDS['durability'],
    'deadline': TIME,
    'lifespan': TIME,
    'liveliness': WORDS['liveliness'],
    'liveliness_lease_duration': TIME,
    'avoid_ros_namespace_conventions': ('true', 'false'),
}
DURATION, START = {'nanoseconds': 'uint64'}, {'nanoseconds_since_epoch': 'uint64'}
TOPIC = {
    'name': 'string', 'type': 'string', 'serialization_format': 'string', 'offered_qos_profiles': [QOS],
    'type_description_hash': 'string',
}
INFORMATION = {
    'version': 'int',
    'storage_identifier': 'string',
    'duration': DURATION,
    'starting_time': START,
    'message_count': 'uint64',
    'topics_with_message_count': [{'topic_metadata': TOPIC, 'message_count': 'uint64'}],
    'compression_format': 'string',
    'compression_mode': 'string',
    'relative_file_paths': ['string'],
    'files': [{'path': 'string', 'starting_time': START, 'duration': DURATION, 'message_count': 'uint64'}],
    'custom_data': {},
    'ros_distro': 'string',
}
"""Names, and for each the type: of C++, the words that it may be, that of each entry, or names again."""

LIMITS = {'int': 2**31, 'uint64': 2**64}


def check(node, wanted, path='metadata'):
    """Go through a YAML document by the nodes, before a reader of YAML guesses types."""
    if isinstance(wanted, dict):
        assert isinstance(node, yaml.MappingNode), path
        entries = {key.value: value for key, value in node.value}
        assert len(entries) == len(node.value), f'{path}: a key stands twice'
        if wanted:
            assert set(entries) == set(wanted), path
        for name, value in entries.items():
            check(value, wanted.get(name, 'string'), f'{path}.{name}')
    elif isinstance(wanted, list):
        assert isinstance(node, yaml.SequenceNode), path
        for number, value in enumerate(node.value):
            check(value, wanted[0], f'{path}[{number}]')
    else:
        assert isinstance(node, yaml.ScalarNode), path
        assert not node.tag.endswith(':null'), f'{path} is null'
        if isinstance(wanted, tuple):
            assert node.value in wanted, f'{path}: {node.value}'
        elif wanted in LIMITS:
            assert re.fullmatch(r'0|[1-9]\d*', node.value), f'{path}: {node.value}'
            assert int(node.value) < LIMITS[wanted], f'{path}: {node.value}'


def compose(text):
    return yaml.compose(text, Loader=yaml.SafeLoader)


def test_metadata_of_a_bag_is_what_rosbag2_decodes(bag):
    text = (bag / 'metadata.yaml').read_text(encoding='utf-8')
    assert not re.search(r'[:-] [&*]', text), 'anchors'
    check(compose(text), {'rosbag2_bagfile_information': INFORMATION})
    with next(bag.glob('*.mcap')).open('rb') as file:
        reader = make_reader(file)
        (record,) = reader.iter_metadata()
        summary = reader.get_summary()
    check(compose(record.metadata['serialized_metadata']), INFORMATION)
    information = yaml.safe_load(text)['rosbag2_bagfile_information']
    topics = {
        entry['topic_metadata']['name']: (entry['topic_metadata'], entry['message_count'])
        for entry in information['topics_with_message_count']
    }
    assert len(summary.channels) == len(topics), 'rosbag2 lists a topic for each channel'
    for number, channel in summary.channels.items():
        entry, count = topics[channel.topic]
        words = channel.metadata
        assert set(words) == {'offered_qos_profiles', 'topic_type_hash'}
        check(compose(words['offered_qos_profiles']), [QOS])
        assert yaml.safe_load(words['offered_qos_profiles']) == entry['offered_qos_profiles']
        assert words['topic_type_hash'] == entry['type_description_hash']
        assert channel.message_encoding == entry['serialization_format'] == 'cdr'
        schema = summary.schemas[channel.schema_id]
        assert (schema.name, schema.encoding) == (entry['type'], 'ros2msg')
        assert summary.statistics.channel_message_counts.get(number, 0) == count


durations = st.integers(0, INFINITE)
offers = st.builds(
    OfferedQos, st.sampled_from(WORDS['history']), st.integers(0, 2**31 - 1), st.sampled_from(WORDS['reliability']),
    st.sampled_from(WORDS['durability']), durations, durations, st.sampled_from(WORDS['liveliness']), durations,
    st.booleans(),
)
stamps = st.integers(0, 2**63 - 1)
texts = st.text(st.characters(exclude_categories=('Cs', 'Cc')), max_size=12)
words = st.sampled_from(['null', '~', 'yes', '1e3', '0x10', '', '- a: &b', '2026-01-01']) | texts


@settings(deadline=None)
@given(
    st.lists(st.builds(TopicRecord, words, words, st.sampled_from(['', HASH]), st.lists(offers, max_size=2).map(tuple),
                       st.integers(0, 2**63)), max_size=3),
    st.lists(st.tuples(words, stamps, stamps, st.integers(0, 2**62)), min_size=1, max_size=3),
    st.dictionaries(words, words, max_size=3),
)
def test_metadata_of_any_bag_is_what_rosbag2_decodes(topics, files, custom):
    records = [FileRecord(name, (min(one, other), max(one, other)), count) for name, one, other, count in files]
    check(compose(as_yaml(bag_information(records, topics, custom))), INFORMATION)
    for topic in topics:
        check(compose(as_yaml(qos_profiles(topic.offers))), [QOS])


@pytest.mark.parametrize(('name', 'wrong'), [
    ('version', 2**31), ('message_count', -1), ('compression_format', None), ('files', None), ('custom_data', []),
    ('duration', {'nanoseconds': 1.5}), ('relative_file_paths', [None]),
])
def test_what_rosbag2_would_refuse_is_found(name, wrong):
    information = bag_information([FileRecord('a.mcap', (1, 2), 3)], [], {})
    check(compose(as_yaml(information)), INFORMATION)
    with pytest.raises(AssertionError):
        check(compose(as_yaml({**information, name: wrong})), INFORMATION)
