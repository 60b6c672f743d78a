"""What is varied, and which values each turn has."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from omni_vehicle_ros.errors import OmniVehicleError
from omni_vehicle_ros.sweep.axes import DISTRIBUTIONS, Distribution
from omni_vehicle_ros.sweep.study import read_study

TURN = 'simple_turning'


def test_a_grid_has_every_combination_once():
    study = read_study(TURN, ['radius=2:4:3', 'vehicle.tyre_model=dugoff,brush', 'speed=1,2.5'])
    expected = itertools.product((2.0, 3.0, 4.0), ('dugoff', 'brush'), (1, 2.5))
    assert study.points(range(study.turns)) == list(expected)
    scenario = study.scenario((3.0, 'brush', 2.5))
    assert scenario.commands[0].icr == (0.0, 3.0) and scenario.commands[0].speed == 2.5
    assert scenario.vehicle.tyre_model == 'brush'


def test_a_parameter_goes_by_its_bare_name_and_one_friction_is_that_of_all_wheels():
    study = read_study(TURN, ['mass=1200,1300', 'friction=0.5,0.7'])
    scenario = study.scenario(study.points([1])[0])
    assert scenario.vehicle.mass == 1200.0 and scenario.plant.friction == (0.7,) * 4


def test_a_value_of_the_scenario_comes_before_a_parameter():
    study = read_study('thesis/friction', ['friction=0.5,0.7'])
    assert study.axes[0].setting == 'friction' and study.scenario((0.7,)).plant.friction == (0.7,) * 4


def test_a_scenario_says_by_itself_what_it_varies():
    study = read_study('thesis/bank', [])
    assert [axis.name for axis in study.axes] == ['bank', 'speed'] and study.turns == 8
    assert [axis.unit for axis in study.axes] == ['rad', 'm/s']


@settings(deadline=None, max_examples=30)
@given(turns=st.integers(1, 300_000))
def test_chunks_hold_every_turn_once(turns):
    study = read_study(TURN, ['friction=uniform(0.5,1)'], samples=turns)
    numbers = [study.numbers(chunk) for chunk in range(study.chunks)]
    assert numbers[0].start == 0 and numbers[-1].stop == turns
    assert all(one.stop == two.start for one, two in itertools.pairwise(numbers))
    assert max(map(len, numbers)) <= 4096


def test_points_do_not_depend_on_who_asks_for_which():
    study = read_study(TURN, ['radius=3,4', 'friction=normal(0.8,0.05)', 'mass=uniform(1200,1400)'], samples=500)
    whole = study.points(range(study.turns))
    assert study.points([999, 3]) == [whole[999], whole[3]]
    assert [point[1:] for point in whole[:500]] == [point[1:] for point in whole[500:]], 'common random numbers'


def test_seeds_draw_the_same_again_and_others_do_not():
    one, again, other = (
        read_study(TURN, ['friction=normal(0.8,0.05)'], samples=50, seed=seed).points(range(50)) for seed in (1, 1, 2)
    )
    assert one == again and not {*one} & {*other}


def test_a_latin_hypercube_fills_each_distribution_evenly():
    axes = ['friction=normal(0.8,0.05)', 'mass=triangular(1200,1300,1500)']
    study = read_study(TURN, axes, samples=200, sampling='latin')
    friction, mass = np.array(study.points(range(200))).T
    for values, distribution in ((friction, stats.norm(0.8, 0.05)), (mass, stats.triang(1 / 3, 1200, 300))):
        assert sorted(np.floor(200 * distribution.cdf(values)).astype(int)) == list(range(200))


@pytest.mark.parametrize(
    ('name', 'numbers', 'median', 'low', 'high'),
    [
        ('uniform', (2.0, 4.0), 3.0, 2.0, 4.0),
        ('normal', (0.8, 0.1), 0.8, -np.inf, np.inf),
        ('truncnormal', (0.8, 0.1, 0.7, 0.9), 0.8, 0.7, 0.9),
        ('lognormal', (1300.0, 0.1), 1300.0, 0.0, np.inf),
        ('triangular', (0.0, 1.0, 2.0), 1.0, 0.0, 2.0),
    ],
)
def test_distributions_mean_what_they_say(name, numbers, median, low, high):
    found = Distribution(name, numbers).quantiles(np.array([0.5, 0.0, 1.0]))
    np.testing.assert_allclose(found, (median, low, high), atol=1e-12)
    assert DISTRIBUTIONS[name].words.count(',') == len(numbers) - 1


@pytest.mark.parametrize(
    ('vary', 'options', 'words'),
    [
        (['rdius=1,2'], {}, "unknown name 'rdius'; did you mean 'radius'"),
        (['cornering_stifness=1,2'], {}, "did you mean 'cornering_stiffness'"),
        (['radius'], {}, 'start:stop:count'),
        (['radius=1:2:1'], {}, 'count'),
        (['radius=1:x:3'], {}, "'x' must be a number"),
        (['radius=2:2:3'], {}, 'start and stop'),
        (['radius=1,1'], {}, 'twice'),
        (['radius=1,2', 'radius=3,4'], {}, 'varied twice'),
        (['mass=norml(1,2)'], {'samples': 3}, "did you mean 'normal'"),
        (['mass=normal(1)'], {'samples': 3}, 'mean, deviation'),
        (['mass=uniform(2,1)'], {'samples': 3}, 'no such distribution'),
        (['mass=normal(1300,10)'], {}, '--samples'),
        (['radius=1,2'], {'samples': 3}, 'nothing is drawn'),
        (['mass=normal(1300,10)'], {'samples': 0}, '1 or more'),
        (['radius=1,2'], {'settings': ['radius=3']}, 'both set and varied'),
        ([], {}, 'such as --vary radius'),
        (['settled=1,2'], {}, 'unknown name'),
    ],
)
def test_what_can_not_be_is_one_line(vary, options, words):
    with pytest.raises(OmniVehicleError, match=words.replace('(', r'\(')) as error:
        read_study(TURN, vary, **options)
    assert '\n' not in str(error.value)


def test_a_point_that_can_not_be_is_named():
    study = read_study(TURN, ['mass=100:2000:20'])
    with pytest.raises(OmniVehicleError, match=r'mass=100.*sprung_mass'):
        study.scenario(study.points([0])[0])
