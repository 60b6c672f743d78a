import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as numpy_st

from omni_vehicle_ros.analysis.regions import UNKNOWN, Regions, region_metrics, regions, spans
from omni_vehicle_ros.model.tyres.dugoff import first_critical_slip, second_critical_slip
from omni_vehicle_ros.model.tyres.region import Region
from omni_vehicle_ros.parameters import VehicleParameters

CAR = VehicleParameters()
SPEED, LOAD = 5.0, 3000.0
GRIP = SPEED, 0.9 * LOAD, CAR.cornering_stiffness, CAR.adhesion_reduction


def test_a_tyre_goes_through_its_regions_at_its_critical_slips(motion, bag_of):
    turning = motion(4.0)
    first, second = first_critical_slip(*GRIP), second_critical_slip(*GRIP)
    turning.side_slip[:, 0] = 0.999 * first
    turning.side_slip[100:, 0] = 1.001 * first
    turning.side_slip[200:, 0] = -0.999 * second
    turning.side_slip[300:, 0] = -1.001 * second
    found = regions(bag_of(turning), CAR)
    assert spans(found, 0, Region.LINEAR) == [(0.0, pytest.approx(1.0))]
    assert spans(found, 0, Region.NONLINEAR) == [(pytest.approx(1.0), pytest.approx(3.0))]
    assert spans(found, 0, Region.SLIDING) == [(pytest.approx(3.0), pytest.approx(4.0))]
    metrics = region_metrics(found)['front_left']
    assert metrics['linear'] == pytest.approx(0.25, abs=0.005)
    assert metrics['nonlinear'] == pytest.approx(0.5, abs=0.005)
    assert metrics['sliding'] == pytest.approx(0.25, abs=0.005)
    assert (metrics['left_linear'], metrics['slid']) == (pytest.approx(1.0), pytest.approx(3.0))
    assert region_metrics(found)['rear_right'] == {
        'linear': 1.0, 'nonlinear': 0.0, 'sliding': 0.0, 'left_linear': None, 'slid': None}


def test_load_friction_and_traction_count_at_their_time(motion, bag_of):
    turning = motion(5.0)
    turning.side_slip[:] = 0.9 * first_critical_slip(*GRIP)
    turning.friction = [(0.0, {'front_left': 0.9}), (1.0, {'front_left': 0.5}), (2.0, {'front_left': 0.9})]
    turning.load[200:300, 1] = 0.5 * LOAD
    turning.long_force[300:400, 2] = -0.8 * 0.9 * LOAD
    found = regions(bag_of(turning), CAR)
    for wheel, (begin, end) in enumerate([(1.0, 2.0), (2.0, 3.0), (3.0, 4.0)]):
        assert spans(found, wheel, Region.NONLINEAR) == [(pytest.approx(begin), pytest.approx(end))]
    assert not spans(found, 3, Region.NONLINEAR)


def test_without_friction_circle_traction_costs_nothing(motion, bag_of):
    turning = motion(2.0)
    turning.side_slip[:] = 0.9 * first_critical_slip(*GRIP)
    turning.long_force[:] = -0.8 * 0.9 * LOAD
    bag = bag_of(turning)
    assert np.all(regions(bag, CAR).place == Region.NONLINEAR)
    assert np.all(regions(bag, VehicleParameters(friction_circle=False)).place == Region.LINEAR)


def test_with_wheel_spin_slip_counts_and_not_the_force(motion, bag_of):
    """Straight on, lambda = 1 at S / (1 - S) = capacity (1 - eps_r u S) / (2 C_s) of a driven wheel."""
    car = VehicleParameters(body_model='eight_dof', adhesion_reduction=0.0)
    straight = motion(4.0, radius=1e9)
    straight.side_slip[:] = 0.0
    first = 0.9 * LOAD / (2.0 * car.longitudinal_stiffness)
    straight.slipping[:, 0] = 0.99 * first * SPEED
    straight.slipping[:, 1] = 1.01 * first * SPEED
    straight.slipping[:, 2] = -0.5 * SPEED
    straight.long_force[:, 3] = 0.89 * LOAD
    found = regions(bag_of(straight), car)
    assert found.place[-1].tolist() == [Region.LINEAR, Region.NONLINEAR, Region.NONLINEAR, Region.LINEAR]


def test_a_slow_spinning_wheel_counts_by_its_force(motion, bag_of):
    """Below walking pace the spin says little about the slip of the tyre."""
    creeping = motion(2.0, speed=0.1)
    creeping.side_slip[:] = 0.0
    creeping.slipping[:] = 0.1
    found = regions(bag_of(creeping), VehicleParameters(body_model='eight_dof'))
    assert np.all(found.place == Region.LINEAR)


def test_a_slip_that_is_not_a_number_is_in_no_region(motion, bag_of):
    turning = motion(2.0)
    turning.side_slip[100:, 1] = math.nan
    turning.side_slip[:, 2] = math.nan
    found = regions(bag_of(turning), CAR)
    assert set(found.place[100:, 1]) == {UNKNOWN}
    metrics = region_metrics(found)
    assert metrics['front_right']['linear'] == 1.0
    assert set(metrics['rear_left'].values()) == {None}


@settings(deadline=None, max_examples=50)
@given(numpy_st.arrays(np.int64, st.tuples(st.integers(1, 30), st.just(4)), elements=st.integers(0, 2)))
def test_the_stretches_of_all_regions_tile_the_time(place):
    found = Regions(np.linspace(0.0, 1.0, len(place)) if len(place) > 1 else np.zeros(1), place)
    metrics = region_metrics(found)
    for wheel, figures in enumerate(metrics.values()):
        stretches = sorted(stretch for region in Region for stretch in spans(found, wheel, region))
        assert (stretches[0][0], stretches[-1][1]) == (found.stamp[0], found.stamp[-1])
        assert all(one[1] == other[0] for one, other in pairwise(stretches))
        assert sum(figures[region.name.lower()] for region in Region) == pytest.approx(1.0)
        assert (figures['left_linear'] is None) == (figures['linear'] == 1.0)
        assert (figures['slid'] is None) == (figures['sliding'] == 0.0)
