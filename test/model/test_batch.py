"""Many vehicles at once: each comes out as it would alone."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.model import batch, batch_compiled
from omni_vehicle_ros.model.batch import advance_batch, drive_batch, evaluate_batch, packed_batch
from omni_vehicle_ros.model.body import Environment, Inputs, evaluate
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.plant import advance
from omni_vehicle_ros.parameters import TYRE_MODELS, VehicleParameters

WIND = {'airflow_angles': (0.0, 0.6, 1.2), 'side_force_coefficients': (0.3, 0.8, 0.7)}
quiet = settings(deadline=None, max_examples=30, derandomize=True)


def fleet(count, seed):
    """Return states, inputs, rates and environments: standstill, walking pace and driving, with and without gains."""
    random = np.random.default_rng(seed)
    scale = random.uniform(0.0, 1.0, count) ** 3
    states = random.uniform(-1.0, 1.0, (10, count))
    states[:3] *= np.array([[30.0], [6.0], [2.0]]) * scale
    states[6:] *= 0.05
    gains = random.uniform(0.0, 8.0, (4, count)) * (random.random(count) < 0.3)
    inputs = np.vstack((random.uniform(-1.5, 1.5, (4, count)), random.uniform(-3e3, 3e3, (4, count)), gains))
    roads = np.vstack((
        random.uniform(-0.4, 0.4, count), random.uniform(-30.0, 30.0, count) * (random.random(count) < 0.5),
        random.uniform(0.0, 1.2, (4, count)),
    ))  # fmt: skip
    return states, inputs, random.uniform(-3.0, 3.0, (4, count)), roads


def alone(states, inputs, roads, number):
    """Return what one vehicle of a fleet has."""
    entries = tuple(inputs[:, number].tolist())
    road = roads[:, number].tolist()
    what = Inputs(entries[:4], entries[4:8], entries[8:])
    return states[:, number].copy(), what, Environment(road[0], road[1], tuple(road[2:]))


def assert_equal_alone(found, states, inputs, rates, roads, vehicle, constant_speed=False):
    for number in range(states.shape[1]):
        state, (angle, force, gain), road = alone(states, inputs, roads, number)
        rate = tuple(rates[:, number].tolist())
        model = constants(vehicle(number))
        end = advance(state, angle, rate, force, road, model, 0.015, 0.005, constant_speed, gain)
        assert found[:, number] == pytest.approx(end, rel=1e-12, abs=1e-12)


@quiet
@given(st.integers(1, 40), st.integers(0, 2**32 - 1), st.sampled_from(TYRE_MODELS), st.booleans(), st.booleans())
def test_each_vehicle_moves_as_it_would_alone(count, seed, tyre, circle, constant_speed):
    vehicle = VehicleParameters(tyre_model=tyre, friction_circle=circle, **WIND)
    drives = fleet(count, seed)
    model = packed_batch(constants(vehicle))
    found = advance_batch(*drives, model, 3, 0.005, constant_speed)
    assert_equal_alone(found, *drives, lambda number: vehicle, constant_speed)


@pytest.mark.parametrize('threads', [1, 2, 3, 50])
def test_neither_threads_nor_neighbours_change_anything(threads):
    states, inputs, rates, roads = fleet(83, 1)
    states[5, ::7] = 1e9  # so often turned that its cosine is that of the library
    model = packed_batch(constants(VehicleParameters(**WIND)))
    whole = advance_batch(states, inputs, rates, roads, model, 20, 0.005, threads=threads)
    one_by_one = [
        advance_batch(*(part[:, number : number + 1] for part in (states, inputs, rates, roads)), model, 20, 0.005)
        for number in range(83)
    ]
    assert np.array_equal(whole, np.hstack(one_by_one))


def test_vehicles_may_differ():
    random = np.random.default_rng(2)
    vehicles = [
        VehicleParameters(mass=mass, cornering_stiffness=stiffness, cg_to_front_axle=front)
        for mass, stiffness, front in random.uniform((1250.0, 2e4, 0.9), (1800.0, 6e4, 1.4), (21, 3)).tolist()
    ]
    drives = fleet(21, 3)
    found = advance_batch(*drives, packed_batch([constants(vehicle) for vehicle in vehicles]), 3, 0.005)
    assert_equal_alone(found, *drives, vehicles.__getitem__)


def test_a_single_column_holds_for_all_vehicles():
    states, inputs, rates, roads = fleet(10, 4)
    model = packed_batch(constants(VehicleParameters()))
    one = advance_batch(states, inputs[:, :1], rates[:, :1], roads[:, :1], model, 3, 0.005)
    spread = [np.repeat(part[:, :1], 10, axis=1) for part in (inputs, rates, roads)]
    assert np.array_equal(one, advance_batch(states, *spread, model, 3, 0.005))


@pytest.mark.parametrize('tyre', TYRE_MODELS)
def test_each_vehicle_is_evaluated_as_it_would_be_alone(tyre):
    states, inputs, _, roads = fleet(40, 5)
    model = constants(VehicleParameters(tyre_model=tyre, **WIND))
    found = evaluate_batch(states, inputs, roads, packed_batch(model))
    for number in range(40):
        state, what, road = alone(states, inputs, roads, number)
        wanted = evaluate(state, what, road, model)
        for field, values in found._asdict().items():
            # Forces to 1e-12 of the weight, angles and shares to 1e-12.
            size = 1e4 if field.endswith(('force', 'load')) else 1.0
            assert values[..., number] == pytest.approx(getattr(wanted, field), rel=1e-12, abs=1e-12 * size), field


def test_a_drive_keeps_the_largest_slips_and_uses_of_friction():
    states, inputs, rates, roads = fleet(12, 6)
    model, cycles = packed_batch(constants(VehicleParameters())), 6
    drive = drive_batch(states, inputs, rates, roads, model, cycles, 2, 0.005)
    slips, uses, angles = [], [], inputs.copy()
    for cycle in range(cycles + 1):
        if cycle:
            states = advance_batch(states, angles, rates, roads, model, 2, 0.005)
            angles[:4] += 2 * 0.005 * rates
        seen = evaluate_batch(states, angles, roads, model)
        slips.append(np.abs(seen.side_slip))
        uses.append(seen.friction_use)
    assert np.array_equal(drive.states, states)
    assert np.array_equal(drive.evaluation.side_slip, seen.side_slip)
    assert np.array_equal(drive.largest_slip, np.max(slips, axis=0))
    assert np.array_equal(drive.largest_use, np.max(uses, axis=0))


def test_plain_and_compiled_batches_are_one(monkeypatch):
    drives = fleet(9, 7)
    model = packed_batch(constants(VehicleParameters(**WIND)))
    fast = drive_batch(*drives, model, 2, 2, 0.005)
    monkeypatch.setattr(batch, 'WIDTH', 1)
    monkeypatch.setattr(batch, 'drive_kernel', batch_compiled.kernels('')[0])
    plain = drive_batch(*drives, model, 2, 2, 0.005)
    assert plain.states == pytest.approx(fast.states, rel=1e-12, abs=1e-12)
    assert plain.largest_slip == pytest.approx(fast.largest_slip, rel=1e-12, abs=1e-12)
