"""Compiled and plain physics with 8 degrees of freedom are one, and cost nothing to who drives in the plane."""

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
from omni_vehicle_ros.model.dynamics import Environment, Inputs
from omni_vehicle_ros.model.eight_dof.constants import eight_dof_constants
from omni_vehicle_ros.model.eight_dof.dynamics import evaluation
from omni_vehicle_ros.model.eight_dof.integrate import integrate
from omni_vehicle_ros.model.eight_dof.state import EightDofState, initial_state, state_vector, state_view
from omni_vehicle_ros.model.eight_dof.vehicle import advance, evaluate
from omni_vehicle_ros.model.machine_code import can_compile
from omni_vehicle_ros.parameters import TYRE_MODELS, VehicleParameters

PACKAGE_ROOT = Path(omni_vehicle_ros.__file__).resolve().parents[1]
VEHICLES = (
    *(VehicleParameters(tyre_model=name) for name in TYRE_MODELS),
    VehicleParameters(
        airflow_angles=(0.2, 0.6, 1.2),
        side_force_coefficients=(0.3, 0.8, 0.7),
        front_roll_steer=0.1,
        roll_yaw_inertia=60.0,
        load_transfer=False,
    ),
)
needs_numba = pytest.mark.skipif(not can_compile(), reason='numba is missing or switched off')

IN_THE_PLANE = """
import json
from omni_vehicle_ros.model.body_model import body_model
from omni_vehicle_ros.model.dynamics import Environment, Inputs
from omni_vehicle_ros.model.eight_dof import compiled
from omni_vehicle_ros.parameters import VehicleParameters

body, still = body_model(VehicleParameters()), (0.0,) * 4
state = body.advance(body.initial_state(5.0), Inputs(still), still, Environment(), 0.005, 0.001)
body.evaluate(state, Inputs(still), Environment())
print(json.dumps(compiled.kernel.cache_info().currsize))
"""


def flat(found):
    return [float(number) for field in found for number in np.atleast_1d(field)]


def four(low, high):
    entries = st.floats(low, high)
    return st.tuples(entries, entries, entries, entries)


# Standstill, walking pace and driving, in proportion.
twists = st.floats(0.0, 1.0).flatmap(
    lambda scale: st.tuples(*(st.floats(-limit, limit).map(lambda v: v * scale**3) for limit in (30.0, 6.0, 2.0)))
)
states = st.builds(
    lambda twist, roll, rate, slip, along, across: state_vector(
        EightDofState(
            *twist, 3.0, -4.0, 5.0, roll, rate, tuple(twist[0] / 0.35 + 10.0 * s * abs(s) for s in slip), along, across
        )
    ),
    twists, st.floats(-0.2, 0.2), st.floats(-1.0, 1.0), four(-2.0, 2.0), four(-0.05, 0.05), four(-0.05, 0.05),
)  # fmt: skip
inputs = st.builds(Inputs, four(-1.5, 1.5), four(-3000.0, 3000.0), four(0.0, 6.0))
roads = st.builds(Environment, st.floats(-0.5, 0.5), st.floats(-30.0, 30.0), four(0.0, 1.2))


@needs_numba
@settings(deadline=None, max_examples=150, derandomize=True)
@given(states, inputs, four(-8.0, 8.0), roads, st.sampled_from(VEHICLES), st.booleans())
def test_compiled_and_plain_give_the_same_numbers(state, inputs, rates, road, vehicle, constant_speed):
    model = eight_dof_constants(vehicle)
    plain = evaluation(state_view(state), inputs, road, model, constant_speed)
    fast = evaluate(state, inputs, road, model, constant_speed)
    assert type(fast) is type(plain)
    assert fast.lifted == plain.lifted
    assert flat(fast) == pytest.approx(flat(plain), rel=1e-12, abs=1e-12 * vehicle.mass * vehicle.gravity)
    after = integrate(state_view(state), inputs, rates, road, model, 3, 0.0005, constant_speed)
    moved = advance(state, inputs, rates, road, model, 0.0015, 0.0005, constant_speed)
    assert moved == pytest.approx(state_vector(after), rel=1e-12, abs=1e-12)


@needs_numba
def test_whatever_the_kind_of_a_number_it_counts_the_same():
    for vehicle in VEHICLES:
        model, found = eight_dof_constants(vehicle), []
        for number in (1, 1.0, np.float32(1.0), np.int64(1)):
            state, four = np.asarray(initial_state(0.0, 0.35), dtype=type(number)), (number,) * 4
            state.setflags(write=False)
            seen = evaluate(state, Inputs(four), Environment(bank=number), model, np.bool_(True))
            end = advance(state, Inputs(four), four, Environment(), model, 0.01, 0.01, True)
            found.append([*flat(seen), *end.tolist()])
        assert found[0] == found[1] == found[2] == found[3]


@needs_numba
def test_who_drives_in_the_plane_compiles_nothing_of_it():
    environment = {**os.environ, 'PYTHONPATH': str(PACKAGE_ROOT)}
    command = [sys.executable, '-W', 'error', '-c', IN_THE_PLANE]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == 0
