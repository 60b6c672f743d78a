"""A bag in memory is the bag that a file would hold."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from omni_vehicle_ros.bags import Bag, open_bag
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.scenarios import load_scenario
from omni_vehicle_ros.simulation import record, simulate


@pytest.fixture(scope='module')
def bags(tmp_path_factory) -> tuple[Bag, Bag]:
    """Return the bag of a short run in memory and in a file."""
    scenario = load_scenario('demo', ['duration=0.5'])
    path = tmp_path_factory.mktemp('bags') / 'bag'
    simulate(scenario, path)
    return record(scenario), open_bag(path)


def test_topics_and_counts_are_those_of_the_file(bags) -> None:
    memory, file = bags
    assert memory.topics == file.topics
    assert memory.complete
    assert memory.namespace == file.namespace == ''


def test_columns_are_those_of_the_file(bags) -> None:
    memory, file = bags
    for topic in (topic for topic, info in file.topics.items() if info.message_count):
        one, other = memory[topic], file[topic]
        assert one.names == other.names
        assert list(one.arrays) == list(other.arrays)
        for name, column in one.arrays.items():
            if column.dtype == np.float64:
                assert_array_equal(column, other.arrays[name], err_msg=f'{topic}.{name}')
            else:
                assert column.tolist() == other.arrays[name].tolist(), f'{topic}.{name}'


def test_an_error_names_the_run(bags) -> None:
    with pytest.raises(BagError, match='demo has no topic'):
        bags[0]['odometry']
