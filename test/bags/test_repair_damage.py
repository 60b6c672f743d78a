"""Whatever is cut off, overwritten or missing: what is left of a bag is saved, nothing wrong is, and nothing hangs."""

import io
import random
import shutil
import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType, Writer

from omni_vehicle_ros import interface, messages
from omni_vehicle_ros.bags import read_messages
from omni_vehicle_ros.bags.repair.repair import repair
from omni_vehicle_ros.errors import BagError

CLOCK = interface.topic('/clock')
CHUNKS, IN_CHUNK = 4, 2
ALL = CHUNKS * IN_CHUNK


def clock(number):
    return messages.encode(CLOCK.type, messages.Clock(number))


def read(path):
    stream = read_messages(path)
    found = [(message.topic, message.log_time, message.data) for message in stream]
    assert stream.complete, stream.damage
    return found


EXPECTED = [(CLOCK.name, number, clock(number)) for number in range(ALL)]


def small_file(compression):
    """Return a file of some chunks as bytes."""
    file = io.BytesIO()
    writer = Writer(file, compression=compression, enable_data_crcs=True)
    writer.start('ros2')
    channel = writer.register_channel(CLOCK.name, 'cdr', writer.register_schema(CLOCK.type, 'ros2msg', b'text'))
    for number in range(ALL):
        writer.add_message(channel, number, clock(number), number + 7)
        if number % IN_CHUNK == IN_CHUNK - 1:
            writer.flush()
    writer.finish()
    return file.getvalue()


SMALL = {compression: small_file(compression) for compression in CompressionType}


@pytest.fixture(scope='module', params=SMALL, ids=str)
def content(request):
    return SMALL[request.param]


@pytest.fixture(scope='module')
def scratch(tmp_path_factory):
    return tmp_path_factory.mktemp('scratch')


def repair_bytes(directory, content):
    """Repair a file with this content; return its messages, None if there are none, and whether it is whole."""
    damaged, out = directory / 'damaged.mcap', directory / 'out'
    damaged.write_bytes(content)
    try:
        result = repair(damaged, out)
    except BagError as error:
        assert len(str(error).splitlines()) == 1
        assert not out.exists()
        return None, False
    finally:
        assert damaged.read_bytes() == content
    if result.directory is None:
        return read(damaged), True
    try:
        found = read(out)
        assert len(found) == result.saved
        assert f'message_count: {len(found)}\n' in (out / 'metadata.yaml').read_text(encoding='utf-8')
    finally:
        shutil.rmtree(out)
    return found, False


def record_places(content):
    """Return where the records of a file that is whole begin."""
    position = 8
    while position < len(content) - 8:
        yield position
        position += 9 + struct.unpack_from('<Q', content, position + 1)[0]


def chunk_places(content):
    """Return begin and end of each chunk of a file that is whole."""
    begins = [place for place in record_places(content) if content[place] == 6]
    return [(place, place + 9 + struct.unpack_from('<Q', content, place + 1)[0]) for place in begins]


def is_part(found, whole):
    """Tell whether messages were left out, and nothing else."""
    rest = iter(whole)
    return all(message in rest for message in found)


def test_cut_off_anywhere_all_before_the_cut_is_saved(scratch, content):
    places = chunk_places(content)
    ends = [end for _, end in places]
    near = {edge + away for place in places[::2] for edge in place for away in range(-9, 10)}  # headers have 9 bytes
    for cut in sorted(near | {*range(0, len(content), 41)}):
        found, whole = repair_bytes(scratch, content[:cut])
        assert not whole
        least = IN_CHUNK * sum(end <= cut for end in ends)
        assert (found or []) == EXPECTED[: len(found or [])]
        assert len(found or []) >= least
        assert (found is None) <= (least == 0)


def test_one_bit_flipped_costs_one_chunk_at_most(scratch, content):
    dice = random.Random(4)
    places = {(place, dice.randrange(8)) for place in dice.sample(range(len(content)), 50)}
    kinds = {(place, bit) for place in record_places(content) for bit in range(4)}  # one kind of record for another
    for place, bit in sorted(places | kinds | {(10, 1), (10, 2)}):  # and a header of any length
        damaged = bytearray(content)
        damaged[place] ^= 1 << bit
        found, whole = repair_bytes(scratch, bytes(damaged))
        assert not whole, place
        assert is_part(found, EXPECTED), place
        assert len(found) >= ALL - IN_CHUNK, place


@settings(deadline=None, max_examples=60)
@given(
    edits=st.lists(st.tuples(st.floats(0, 1), st.binary(min_size=1, max_size=12)), min_size=1, max_size=4),
    cuts=st.tuples(st.floats(0, 1), st.floats(0, 1)),
    compression=st.sampled_from(CompressionType),
)
def test_whatever_is_overwritten_or_missing_nothing_wrong_is_saved(scratch, edits, cuts, compression):
    content = SMALL[compression]
    damaged = bytearray(content)
    for place, text in edits:
        begin = int(place * len(content))
        damaged[begin : begin + len(text)] = text
    begin, end = sorted(int(cut * len(damaged)) for cut in cuts)
    for text in (damaged, damaged[:begin] + damaged[end:]):
        found, whole = repair_bytes(scratch, bytes(text))
        if whole:
            assert found == EXPECTED
        assert is_part(found or [], EXPECTED) or compression != CompressionType.ZSTD  # cut chunks have no checksum


@settings(deadline=None, max_examples=100)
@given(st.binary(max_size=400), st.booleans(), st.lists(st.integers(1, 15), max_size=6))
def test_random_bytes_are_refused_in_one_line(scratch, text, magic, opcodes):
    begin = b'\x89MCAP0\r\n' if magic else b''
    records = b''.join(struct.pack('<BQ', opcode, len(text)) + text for opcode in opcodes)
    found, whole = repair_bytes(scratch, begin + (records or text))
    assert not found
    assert not whole


def test_a_damaged_chunk_in_the_middle_is_left_out_and_counted(tmp_path, content):
    begin, end = chunk_places(content)[1]
    damaged = bytearray(content)
    damaged[begin + 60 : end] = random.Random(5).randbytes(end - begin - 60)
    (tmp_path / 'x.mcap').write_bytes(damaged)
    result = repair(tmp_path / 'x.mcap', tmp_path / 'out')
    assert read(tmp_path / 'out') == EXPECTED[:IN_CHUNK] + EXPECTED[2 * IN_CHUNK :]
    (file,) = result.files
    assert (file.saved, file.lost, file.all_known) == (ALL - IN_CHUNK, IN_CHUNK, True)
    assert file.lost_bytes == end - begin
    assert result.lines[0] == (
        f'x.mcap: {ALL - IN_CHUNK} messages saved, {IN_CHUNK} lost; {end - begin} of {len(content)} bytes lost'
    )
    assert f'byte {begin}: a chunk ' in result.lines[1]
    assert result.lines[-1] == f'bag     {tmp_path / "out"}'


def test_without_its_end_a_file_tells_by_its_indexes_what_is_lost(tmp_path, content):
    places = chunk_places(content)
    damaged = bytearray(content[: places[3][0]])
    damaged[places[1][1] - 1] ^= 1
    damaged[places[1][1] - 9] ^= 255
    (tmp_path / 'x.mcap').write_bytes(damaged)
    (file,) = repair(tmp_path / 'x.mcap', tmp_path / 'out').files
    assert (file.saved, file.lost, file.all_known) == (2 * IN_CHUNK, IN_CHUNK, False)
    assert f'at least {IN_CHUNK} lost' in file.lines[0]


def test_bytes_missing_in_the_middle_cost_what_they_touch(scratch, content):
    places = chunk_places(content)
    found, _ = repair_bytes(scratch, content[: places[1][0] + 70] + content[places[1][0] + 90 :])
    assert found == EXPECTED[:IN_CHUNK] + EXPECTED[2 * IN_CHUNK :]


def test_lost_definitions_are_taken_from_the_summary(scratch, content):
    begin, end = chunk_places(content)[0]
    found, _ = repair_bytes(scratch, content[:begin] + bytes(end - begin) + content[end:])
    assert found == EXPECTED[IN_CHUNK:]


def test_files_without_chunks_are_repaired(tmp_path):
    path = tmp_path / 'plain.mcap'
    with path.open('wb') as file:
        writer = Writer(file, use_chunking=False)
        writer.start()
        channel = writer.register_channel(CLOCK.name, 'cdr', writer.register_schema(CLOCK.type, 'ros2msg', b''))
        for number in range(ALL):
            writer.add_message(channel, number, clock(number), number)
        writer.finish()
    content = bytearray(path.read_bytes())
    record = struct.pack('<BQ', 5, 22 + len(clock(0)))
    content[content.index(record) + 2] = 77  # a length that leads nowhere
    path.write_bytes(content)
    (file,) = repair(path, tmp_path / 'out').files
    assert (file.saved, file.unchecked, file.lost) == (ALL - 1, ALL - 1, 1)
    assert read(tmp_path / 'out') == EXPECTED[1:]
    assert file.lines[-1] == f'  {ALL - 1} of the saved messages have no checksum: they may be damaged inside'


def test_private_records_are_passed_over_and_counted(tmp_path, content):
    begin = chunk_places(content)[1][0]
    private = struct.pack('<BQ', 0x80, 5) + b'words'
    (tmp_path / 'x.mcap').write_bytes(content[:begin] + private + content[begin:-1])
    (file,) = repair(tmp_path / 'x.mcap', tmp_path / 'out').files
    assert read(tmp_path / 'out') == EXPECTED
    assert file.lines[-1] == '  1 private records (of kinds from 0x80 on) are not saved'
