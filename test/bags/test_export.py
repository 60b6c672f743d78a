"""Exported tables against the columns that they were made of."""

import csv
import json

import numpy as np
import pyarrow.parquet as parquet
import pytest
from numpy.testing import assert_array_equal

from omni_vehicle_ros import interface, messages
from omni_vehicle_ros.bags import BagWriter, open_bag
from omni_vehicle_ros.bags.columns.export import ROW_GROUP, export
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.messages import encode
from omni_vehicle_ros.wheels import WHEELS

JOINTS = 'sensor_msgs/msg/JointState'


def test_parquet_has_a_column_for_each_number_with_its_unit(tmp_path, bag, sent):
    found = export(bag, tmp_path)
    assert {path.name for path in found.files} == {path.name for path in tmp_path.iterdir()}
    assert sum(found.files.values()) == len(sent)
    opened, slip = open_bag(bag), parquet.read_table(tmp_path / 'tyres.side_slip.parquet')
    for number, wheel in enumerate(WHEELS):
        for field, unit in (('position', 'rad'), ('velocity', 'm/s'), ('effort', '1')):
            name = f'{field}_{wheel}'
            assert_array_equal(slip[name].to_numpy(), getattr(opened['tyres/side_slip'], field)[:, number])
            assert slip.schema.field(name).metadata == {b'unit': unit.encode()}
    force = parquet.read_table(tmp_path / 'tyres.force.parquet')
    assert_array_equal(force['forces_rear_left_z'].to_numpy(), opened['tyres/force'].forces[:, 2, 2])
    assert force.schema.field('forces_rear_left_z').metadata == {b'unit': b'N'}
    assert force.schema.metadata[b'topic'] == b'/tyres/force'
    assert force['stamp_ns'].to_pylist() == opened['tyres/force'].stamp_ns.tolist()
    assert parquet.read_table(tmp_path / 'diagnostics.parquet')['statuses'].to_pylist()[1] == '0 plant: cycle 60'


def test_csv_reads_back_as_the_same_numbers(tmp_path, bag):
    export(bag, tmp_path, kind='csv', topics=['/odom', '/environment/friction'])
    assert {path.name for path in tmp_path.iterdir()} == {'odom.csv', 'environment.friction.csv', 'units.json'}
    with (tmp_path / 'odom.csv').open(newline='') as file:
        rows = list(csv.DictReader(file))
    odom = open_bag(bag)['odom']
    for name in ('x', 'heading', 'yaw_rate', 'stamp'):
        assert_array_equal([float(row[name]) for row in rows], getattr(odom, name))
    with (tmp_path / 'environment.friction.csv').open(newline='') as file:
        friction = [[float(row[f'effort_{wheel}']) for wheel in WHEELS] for row in csv.DictReader(file)]
    assert_array_equal(friction, open_bag(bag)['environment/friction'].effort)
    units = json.loads((tmp_path / 'units.json').read_text())
    assert units['odom.csv'] | {'x': 'm', 'yaw_rate': 'rad/s', 'stamp': 's', 'frame': ''} == units['odom.csv']


def test_joints_that_come_late_have_columns_from_the_begin(tmp_path):
    """The first row group is full before the second joint is met."""
    with BagWriter(tmp_path / 'bag') as writer:
        writer.add_topic('/a', JOINTS, interface.STATE)
        for number in range(ROW_GROUP + 10):
            names = ('x',) if number <= ROW_GROUP else ('x', 'y')
            value = messages.Joints(number, names, (float(number),) * len(names))
            writer.write('/a', encode(JOINTS, value), number)
    (tmp_path / 'out').mkdir()
    export(tmp_path / 'bag', tmp_path / 'out')
    file = parquet.ParquetFile(tmp_path / 'out' / 'a.parquet')
    assert file.num_row_groups == 2
    table = file.read()
    assert_array_equal(table['position_x'].to_numpy(), np.arange(ROW_GROUP + 10.0))
    y = table['position_y'].to_numpy()
    assert np.isnan(y[: ROW_GROUP + 1]).all()
    assert_array_equal(y[ROW_GROUP + 1 :], np.arange(ROW_GROUP + 1.0, ROW_GROUP + 10.0))


def test_progress_rises_to_its_end(tmp_path, bag):
    told = []
    export(bag, tmp_path, progress=told.append)
    assert told == sorted(told)
    assert 0.9 < told[-1] <= 1.0


@pytest.mark.parametrize('error', [KeyboardInterrupt, OSError(28, 'No space left on device')])
def test_what_is_half_written_is_taken_away(tmp_path, bag, error):
    def fail(done):
        if done > 0.5:
            raise error

    with pytest.raises((KeyboardInterrupt, BagError), match=r'^$|No space left'):
        export(bag, tmp_path, progress=fail)
    assert not list(tmp_path.iterdir())


def test_an_unknown_topic_is_named_with_what_was_meant(tmp_path, bag):
    with pytest.raises(BagError, match="has no topic '/odm'; did you mean '/odom'"):
        export(bag, tmp_path, topics=['/odm'])
    assert not list(tmp_path.iterdir())
