"""Files of our own writer: those of mcap's Writer record by record, in flat memory, with nothing left beside them."""

import errno
import io
import os
import signal
import subprocess
import sys
import tracemalloc
from unittest.mock import patch

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.records import Footer, SummaryOffset
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer

from omni_vehicle_ros import interface
from omni_vehicle_ros.bags import BagWriter, read_messages
from omni_vehicle_ros.bags.mcap import open_chunk, spill
from omni_vehicle_ros.bags.mcap.definitions import Attachment, ChannelDefinition, Metadata, SchemaDefinition
from omni_vehicle_ros.bags.mcap.file_writer import COMPRESSIONS
from omni_vehicle_ros.bags.mcap.spill import PORTION, Spill
from omni_vehicle_ros.bags.mcap.whole_writes import write_whole
from omni_vehicle_ros.bags.mcap.writer import LIBRARY, McapWriter
from omni_vehicle_ros.bags.repair.repair import repair
from omni_vehicle_ros.errors import BagError

CHUNK = 300
"""Small, so that a few messages make several."""
CYCLES = 1200
SCHEMA = SchemaDefinition('some_msgs/msg/Thing', 'ros2msg', b'\xff text')
CHANNELS = (
    ChannelDefinition(1, '/thing', 'cdr', (('key', 'ä'), ('', ''))),
    ChannelDefinition(0, '/without', 'json', ()),
    ChannelDefinition(1, '/silent', 'cdr', ()),
)
TIMES = st.integers(0, 2**63 - 1)
STEPS = st.one_of(
    st.tuples(st.integers(1, 2), st.integers(0, 2**32 - 1), TIMES, TIMES, st.binary(max_size=200)),
    st.builds(Attachment, TIMES, TIMES, st.text(), st.text(), st.binary()),
    st.builds(Metadata, st.text(), st.dictionaries(st.text(), st.text())),
    st.just('flush'),
)


def write_ours(path, steps, compression):
    """Write a file by our writer."""
    writer = McapWriter(path, 'ros2', compression, CHUNK)
    writer.add_schema(1, SCHEMA)
    for number, channel in enumerate(CHANNELS, 1):
        writer.add_channel(number, channel)
    for step in steps:
        if step == 'flush':
            writer.flush()
        elif isinstance(step, Attachment):
            writer.add_attachment(step)
        elif isinstance(step, Metadata):
            writer.add_metadata(step)
        else:
            writer.add_message(*step)
    writer.finish()


def write_theirs(file, steps, compression):
    """Write the same by mcap's writer."""
    writer = Writer(file, CHUNK, CompressionType[compression.upper()], enable_data_crcs=True)
    writer.start('ros2', LIBRARY)
    writer.register_schema(*SCHEMA)
    for channel in CHANNELS:
        writer.register_channel(channel.topic, channel.encoding, channel.schema, dict(channel.metadata))
    for step in steps:
        if step == 'flush':
            writer.flush()
        elif isinstance(step, Attachment):
            writer.add_attachment(step.create_time, step.log_time, step.name, step.media_type, step.data)
        elif isinstance(step, Metadata):
            writer.add_metadata(step.name, step.texts)
        else:
            channel, sequence, log_time, publish_time, data = step
            writer.add_message(channel, log_time, data, publish_time, sequence)
    writer.finish()


def records(file):
    """Return the records of a file, checksums compared, but for what depends on groups of no records at its end."""
    found = list(StreamReader(file, emit_chunks=True, validate_crcs=True).records)
    *others, footer = [one for one in found if not (isinstance(one, SummaryOffset) and not one.group_length)]
    assert isinstance(footer, Footer)
    return [*others, (footer.summary_start, footer.summary_offset_start)]


@settings(deadline=None, max_examples=60)
@given(steps=st.lists(STEPS, max_size=30), compression=st.sampled_from(sorted(COMPRESSIONS)))
def test_a_file_has_the_records_of_one_of_mcap(tmp_path_factory, steps, compression):
    path = tmp_path_factory.mktemp('file') / 'x.mcap'
    with patch.object(open_chunk, '_ZSTD_LEVEL', 3):  # theirs
        write_ours(path, steps, compression)
    theirs = io.BytesIO()
    write_theirs(theirs, steps, compression)
    theirs.seek(0)
    with path.open('rb') as file:
        assert records(file) == records(theirs)
        file.seek(0)
        reader = make_reader(file, validate_crcs=True)
        messages = [step for step in steps if type(step) is tuple]
        assert [
            (message.channel_id, message.sequence, message.log_time, message.publish_time, message.data)
            for _, _, message in reader.iter_messages(log_time_order=False)
        ] == messages


def write_cycles(writer, cycles, topics):
    """Write a chunk a cycle, with a message of each topic."""
    for cycle in cycles:
        for topic in topics:
            writer.write(topic, b'0123', cycle)
        writer.flush()


def new_bag(directory):
    """Begin a bag with some topics; return its writer and their names."""
    writer = BagWriter(directory)
    names = []
    for row in interface.TOPICS[:8]:
        names.append(interface.resolve(row.name, ''))
        writer.add_topic(names[-1], row.type, row.qos)
    return writer, names


def test_memory_does_not_grow_with_the_number_of_chunks(tmp_path):
    writer, topics = new_bag(tmp_path / 'bag')
    tracemalloc.start()
    try:
        write_cycles(writer, range(300), topics)
        before, _ = tracemalloc.get_traced_memory()
        write_cycles(writer, range(300, CYCLES), topics)
        after, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert after - before < 2 * PORTION
    writer.close()
    assert [path.name for path in sorted((tmp_path / 'bag').iterdir())] == ['bag_0.mcap', 'metadata.yaml']
    with writer.path.open('rb') as file:
        summary = make_reader(file, validate_crcs=True).get_summary()
    assert [index.message_start_time for index in summary.chunk_indexes] == list(range(CYCLES))
    assert all(len(index.message_index_offsets) == len(topics) for index in summary.chunk_indexes)


WRITE_FOR_EVER = """
import itertools, os, sys
from omni_vehicle_ros.bags import BagWriter
from omni_vehicle_ros import interface

writer = BagWriter(sys.argv[1])
row = interface.topic('/clock')
writer.add_topic(row.name, row.type, row.qos)
for number in itertools.count():
    writer.write(row.name, b'0123', number)
    writer.flush()
    if number % 1000 == 0:
        open_files = [os.readlink(each) for each in os.scandir('/proc/self/fd') if os.path.lexists(each)]
        print(sum(name.startswith(sys.argv[1]) and '(deleted)' in name for name in open_files), flush=True)
"""


def test_a_kill_leaves_no_stray_file(tmp_path):
    command = [sys.executable, '-c', WRITE_FOR_EVER, tmp_path / 'bag']
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert any(line == '1\n' for line in process.stdout)  # its index is in a file without a name
        process.kill()
    assert process.returncode == -signal.SIGKILL
    assert [path.name for path in sorted((tmp_path / 'bag').iterdir())] == ['bag_0.mcap', 'metadata.yaml']
    numbers = [message.log_time for message in read_messages(tmp_path / 'bag')]
    assert len(numbers) > 500
    assert numbers == list(range(len(numbers)))


def test_a_disk_too_full_for_the_index_is_said_and_all_messages_stay(tmp_path, monkeypatch):
    def refuse(file, data):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(spill, 'write_whole', refuse)
    writer, topics = new_bag(tmp_path / 'bag')
    with pytest.raises(BagError, match=r'bag_0\.mcap: No space left on device; what was written before stays readable'):
        write_cycles(writer, range(10_000), topics)
    writer.close()
    whole_cycles, rest = divmod(len(list(read_messages(tmp_path / 'bag'))), len(topics))
    assert whole_cycles > 50
    assert not rest


@settings(deadline=None)
@given(st.lists(st.binary(min_size=1, max_size=PORTION // 2), max_size=5), st.integers(1, 5))
def test_what_is_spilled_comes_back(tmp_path_factory, portions, times):
    taken = Spill(tmp_path_factory.getbasetemp())
    for data in portions * times:
        taken.add(data)
    assert b''.join(taken.pieces()) == b''.join(portions * times)
    taken.close()


def test_a_write_that_the_system_cuts_short_goes_on(tmp_path):
    class Hesitant(io.FileIO):
        def write(self, data):
            return super().write(bytes(data[:7]))

    with Hesitant(tmp_path / 'file', 'w') as file:
        write_whole(file, bytes(range(100)))
    assert (tmp_path / 'file').read_bytes() == bytes(range(100))


def test_a_repaired_file_keeps_the_numbers_of_its_channels(tmp_path):
    path = tmp_path / 'x.mcap'
    writer = McapWriter(path, 'ros1', 'lz4', CHUNK)
    writer.add_schema(65535, SCHEMA)
    for number in (65535, 0):
        writer.add_channel(number, ChannelDefinition(65535, f'/t{number}', 'cdr', ()))
        writer.add_message(number, 1, number, 3, b'data')
    writer.finish()
    with path.open('rb+') as file:
        file.truncate(path.stat().st_size - 1)
    repair(path, tmp_path / 'out')
    with (tmp_path / 'out' / 'x.mcap').open('rb') as file:
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_header().profile == 'ros1'
        found = [(s.id, c.id, c.topic, m.log_time) for s, c, m in reader.iter_messages(log_time_order=False)]
    assert found == [(65535, 65535, '/t65535', 65535), (65535, 0, '/t0', 0)]
