"""Compiled and plain physics are one: the same numbers, from whatever input."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import omni_vehicle_ros
from omni_vehicle_ros.model import batch_compiled
from omni_vehicle_ros.model.body import Environment, Inputs, derivative, evaluate
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.dynamics import evaluation, state_rate
from omni_vehicle_ros.model.integrate import integrate
from omni_vehicle_ros.model.machine_code import can_compile
from omni_vehicle_ros.model.plant import advance
from omni_vehicle_ros.model.state import State, initial_state, state_vector, state_view
from omni_vehicle_ros.parameters import VehicleParameters

PACKAGE_ROOT = Path(omni_vehicle_ros.__file__).resolve().parents[1]
VEHICLES = (
    VehicleParameters(),
    VehicleParameters(
        friction_circle=False,
        airflow_angles=(0.2, 0.6, 1.2),
        side_force_coefficients=(0.3, 0.8, 0.7),
        front_roll_steer=0.1,
    ),
    VehicleParameters(tyre_model='brush'),
    VehicleParameters(tyre_model='magic_formula'),
    VehicleParameters(tyre_model='lugre'),
)
needs_numba = pytest.mark.skipif(not can_compile(), reason='numba is missing or switched off')

# Drives through standstill, a turn at the limit of grip, wind and bank, and prints what it finds.
DRIVE = """
import json
import sys
from omni_vehicle_ros.model.body import Environment, Inputs, evaluate
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.plant import advance
from omni_vehicle_ros.model.state import initial_state
from omni_vehicle_ros.parameters import VehicleParameters

model, road = constants(VehicleParameters()), Environment(0.02, 6.0, (0.9, 0.7, 0.9, 0.7))
state, angles, rates, found = initial_state(), (0.0,) * 4, (0.05, 0.04, -0.02, -0.02), []
for cycle in range(400):
    state = advance(state, angles, rates, (900.0,) * 4, road, model, 0.01, 0.005)
    angles = tuple(angle + 0.01 * rate for angle, rate in zip(angles, rates))
    now = evaluate(state, Inputs(angles, (900.0,) * 4), road, model)
    if cycle % 40 == 0:
        found += [*state.tolist(), *now.lateral_force, *now.side_slip, *now.vertical_load, now.ax, now.ay]
print(json.dumps({'found': found, 'numba': 'numba' in sys.modules}))
"""


def start(code, **environment):
    environment = {**os.environ, 'PYTHONPATH': str(PACKAGE_ROOT), **environment}
    command = [sys.executable, '-W', 'error', '-c', code]
    return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def result(process):
    out, err = process.communicate(timeout=600)
    assert process.returncode == 0, err
    return json.loads(out)


def flat(found):
    return [float(number) for field in found for number in np.atleast_1d(field)]


def four(low, high):
    entries = st.floats(low, high)
    return st.tuples(entries, entries, entries, entries)


# Standstill, walking pace and driving, in proportion.
twists = st.floats(0.0, 1.0).flatmap(
    lambda scale: st.tuples(*(st.floats(-limit, limit).map(lambda v: v * scale**3) for limit in (30.0, 6.0, 2.0)))
)
states = st.builds(lambda twist, z: state_vector(State(*twist, 3.0, -4.0, 5.0, *z)), twists, four(-0.05, 0.05))
gains = four(0.0, 10.0) | st.just((0.0, 0.0, 0.0, 0.0))
inputs = st.builds(Inputs, four(-1.5, 1.5), four(-3000.0, 3000.0), gains)
roads = st.builds(Environment, st.floats(-0.5, 0.5), st.floats(-30.0, 30.0), four(0.0, 1.2))


@needs_numba
@settings(deadline=None, max_examples=200, derandomize=True)
@given(states, inputs, four(-8.0, 8.0), roads, st.sampled_from(VEHICLES), st.booleans())
def test_compiled_and_plain_give_the_same_numbers(state, inputs, rates, road, vehicle, constant_speed):
    model = constants(vehicle)
    plain = evaluation(state_view(state), inputs, road, model, constant_speed)
    fast = evaluate(state, inputs, road, model, constant_speed)
    assert type(fast) is type(plain)
    assert all(type(number) in (float, bool) for field in fast for number in np.ravel(field).tolist())
    assert fast.lifted == plain.lifted
    assert flat(fast) == pytest.approx(flat(plain), rel=1e-12, abs=1e-12 * vehicle.mass * vehicle.gravity)
    rate = state_rate(state_view(state), inputs, road, model, constant_speed)
    found = derivative(state, inputs, road, model, constant_speed)
    assert found == pytest.approx(state_vector(rate), rel=1e-12, abs=1e-11)
    after = integrate(state_view(state), inputs, rates, road, model, 3, 0.002, constant_speed)
    angles, forces, gains = inputs
    moved = advance(state, angles, rates, forces, road, model, 0.006, 0.002, constant_speed, gains)
    assert moved == pytest.approx(state_vector(after), rel=1e-12, abs=1e-12)


@needs_numba
def test_whatever_the_kind_of_a_number_it_counts_the_same():
    for vehicle in VEHICLES:
        model, found = constants(vehicle), []
        for number in (1, 1.0, np.float32(1.0), np.int64(1)):
            state, four = np.asarray(initial_state(1.0), dtype=type(number)), (number,) * 4
            state.setflags(write=False)
            seen = evaluate(state, Inputs(four), Environment(bank=number), model, np.bool_(True))
            rate = derivative(state, Inputs(four), Environment(bank=number), model, np.bool_(True))
            end = advance(state, four, four, four, Environment(), model, number, number, True)
            found.append([*flat(seen), *rate.tolist(), *end.tolist()])
        assert found[0] == found[1] == found[2] == found[3]


def test_a_plain_process_finds_the_same_as_a_compiled_one():
    plain, fast = start(DRIVE, NUMBA_DISABLE_JIT='1'), start(DRIVE)
    # A None in sys.modules makes an import fail as if there were no such package.
    without = start("import sys; sys.modules['numba'] = None\n" + DRIVE)
    plain, fast, without = result(plain), result(fast), result(without)
    assert plain['found'] == without['found']
    assert fast['found'] == pytest.approx(plain['found'], rel=1e-12, abs=1e-8)


def test_who_does_not_integrate_does_not_wait_for_numba():
    modules = ('cli', 'scenarios', 'control.commands', 'control.motion', 'control.speed', 'model.constants',
               'model.kinematics', 'control.traction', 'model.tyres.region', 'components.wheel_module')  # fmt: skip
    code = f"""
import importlib, json, sys
for name in {modules}:
    importlib.import_module(f'omni_vehicle_ros.{{name}}')
print(json.dumps('numba' in sys.modules))
"""
    assert result(start(code)) is False


@needs_numba
def test_without_any_place_for_the_cache_lanes_run_plain_and_say_so(monkeypatch):
    def njit(**options):
        def refuse(function):
            raise RuntimeError('cannot cache function: no locator available')

        return refuse

    monkeypatch.setattr('numba.njit', njit)
    with pytest.warns(RuntimeWarning, match='cannot cache function.*set NUMBA_CACHE_DIR'):
        assert batch_compiled.compile_batch()[0] == 1


def test_the_cache_of_lanes_knows_of_every_change_of_the_physics():
    one, other = (batch_compiled.kernels(text)[0].__closure__[0].cell_contents for text in ('a', 'b'))
    assert one != other
