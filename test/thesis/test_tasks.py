"""What is computed for figures: runs, steady turns and speed ratios, held against each other."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.loads import static_loads
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.thesis.claims.balance import PulledTurn
from omni_vehicle_ros.thesis.steady import Limits, SlipMapTask, SpeedRatios, branch
from omni_vehicle_ros.thesis.tasks import Recording, km_per_h, run
from omni_vehicle_ros.wheels import WHEELS

LONG_CYCLE = {'plant.control_period': 0.02}
STUDY = run('turning_map')


@pytest.fixture(scope='module')
def turn() -> Recording:
    """Return the run of a turn of 5 m at 10 km/h."""
    return run('turning_map', radius=5.0, duration=4.0, **LONG_CYCLE).work()


def test_a_run_is_described_as_on_the_command_line() -> None:
    task = run('bank', bank=-0.01, **{'plant.bank': 0.02})
    assert task.settings == ('bank=-0.01', 'plant.bank=0.02')
    assert task == run('bank', bank=-0.01, **{'plant.bank': 0.02})
    scenario = task.load()
    assert scenario.name == 'thesis/bank'
    assert (scenario.values['bank'], scenario.plant.bank) == (-0.01, 0.02)


def test_a_recording_has_one_row_a_cycle(turn: Recording) -> None:
    assert_allclose(turn.time, np.arange(201) * 0.02, atol=1e-12)
    assert turn.side_slip.shape == turn.steer_angle.shape == turn.load.shape == turn.friction_use.shape == (201, 4)
    assert turn.rows(1.0, 2.0) == slice(50, 101)
    loads = static_loads(constants(turn.scenario.vehicle))
    assert_allclose(turn.load[:, :2].sum(axis=1), loads[0] + loads[1])


def test_step_figures_of_a_whole_run_are_those_of_its_metrics(turn: Recording) -> None:
    for i, wheel in enumerate(WHEELS):
        assert turn.step(i)._asdict() == pytest.approx(turn.metrics['side_slip'][wheel], rel=1e-12)


def test_a_run_settles_at_the_steady_turn_of_the_map(turn: Recording) -> None:
    """Two ways to the same physics: integration, and a root of the equations of motion."""
    found = SlipMapTask(STUDY, (5.0,), (km_per_h(10),)).work()
    assert_allclose(turn.side_slip[-1], found.side_slip[0, 0], rtol=1e-6)


def test_a_map_ends_where_steady_turns_end() -> None:
    radii, speeds = (2.0, 3.0, 5.0), tuple(map(km_per_h, (8, 12, 20)))
    found = SlipMapTask(STUDY, radii, speeds, mesh=4).work()
    limits = [limit.speed for limit in Limits(STUDY, radii, 20.0).work()]
    assert found.side_slip.shape == (3, 3, 4)
    for row, limit in zip(found.side_slip, limits, strict=True):
        assert np.isnan(row[:, 0]).tolist() == [speed > limit for speed in speeds]
    assert_allclose(found.top_speed, np.minimum(limits, speeds[-1]), rtol=1e-6)
    assert_allclose(found.mesh_speed[:, -1], found.top_speed)
    assert np.all(np.isfinite(found.mesh_slip))


def test_a_right_turn_is_the_mirror_image() -> None:
    left, right = (SlipMapTask(STUDY, (radius,), (3.0,)).work().side_slip[0, 0] for radius in (4.0, -4.0))
    assert_allclose(right, -left[[1, 0, 3, 2]], rtol=1e-8)


def test_a_wheel_lifts_where_its_load_is_used_up() -> None:
    """At the limit of a road with a friction of 2 the rear inner load, static minus transfer, is 0."""
    sticky = run('turning_map', **{'plant.friction': [2.0] * 4})
    turns = branch(sticky, 10.0, 30.0)
    assert turns.limit.cause == 'lift'
    assert turns.limit.speed is not None
    last, model = turns.turn(turns.limit.speed), constants(VehicleParameters())
    assert last is not None
    assert last.lateral_acceleration == pytest.approx(model.rear_load / model.rear_transfer, rel=1e-4)


def test_a_speed_ratio_is_that_of_the_run() -> None:
    speeds = (2.0, 6.2)
    ratios = SpeedRatios(4.0, speeds).work()
    recording = run('speed_loss', radius=4.0, speed=speeds[1], **LONG_CYCLE).work()
    assert ratios[1] == pytest.approx(recording.vx[-1] / recording.vx[0], rel=1e-9)
    assert ratios[1] < ratios[0] < 1.0


def test_a_turn_that_nothing_pulls_is_the_steady_one() -> None:
    pulled = PulledTurn(STUDY, 5.0, 2.8, (-500.0, 0.0, 500.0)).work()
    assert_allclose(pulled[1], SlipMapTask(STUDY, (5.0,), (2.8,)).work().side_slip[0, 0], rtol=1e-9)
    # In the linear region of the tyres a small force does half of what twice the force does, and brake the opposite.
    small = PulledTurn(STUDY, 5.0, 2.8, (-10.0, 0.0, 10.0, 20.0)).work() - pulled[1]
    assert_allclose(small[0], -small[2], rtol=0.02)
    assert_allclose(small[3], 2.0 * small[2], rtol=0.02)


def test_no_steady_turn_means_no_pulled_one() -> None:
    assert np.all(np.isnan(PulledTurn(STUDY, 2.0, 5.0, (0.0,)).work()))
    assert math.isnan(SlipMapTask(STUDY, (2.0,), (5.0,)).work().side_slip[0, 0, 0])
