"""Machine code on disk: the bits of numba, without numba; whatever is wrong with a file, it is made anew."""

import ctypes
import json
import math
import os
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

import omni_vehicle_ros
from omni_vehicle_ros.model import compiled, machine_code
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.dynamics import Environment, Inputs
from omni_vehicle_ros.model.machine_code import can_compile, load_kernel
from omni_vehicle_ros.model.packing import packed_constants, packed_request
from omni_vehicle_ros.model.state import initial_state
from omni_vehicle_ros.parameters import VehicleParameters

PACKAGE_ROOT = Path(omni_vehicle_ros.__file__).resolve().parents[1]
pytestmark = pytest.mark.skipif(not can_compile(), reason='numba is missing or switched off')

STEP = """
import json
import sys
from omni_vehicle_ros.model.body_model import body_model
from omni_vehicle_ros.model.dynamics import Environment, Inputs
from omni_vehicle_ros.parameters import VehicleParameters

body, still = body_model(VehicleParameters(body_model=sys.argv[1])), (0.0,) * 4
state, inputs = body.initial_state(12.0), Inputs((0.1, 0.1, -0.05, -0.05), (300.0,) * 4)
for _ in range(20):
    state = body.advance(state, inputs, still, Environment(0.02, 6.0), 0.005, 0.005)
seen = body.evaluate(state, inputs, Environment(0.02, 6.0))
print(json.dumps([state.tolist(), seen, 'numba' in sys.modules]))
"""
TINY = """
import ctypes
import json
import math
import sys
from omni_vehicle_ros.model.machine_code import load_kernel


def turned(numbers, constants):
    numbers[0] = math.cos(numbers[0]) * constants[0]


kernel, numbers = load_kernel('tiny', 'text', lambda: turned), (ctypes.c_double * 1)(2.0)
kernel(numbers, (ctypes.c_double * 1)(3.0))
print(json.dumps([numbers[0], 'numba' in sys.modules]))
"""


def start(code, *arguments, **environment):
    environment = {**os.environ, 'PYTHONPATH': str(PACKAGE_ROOT), **environment}
    command = [sys.executable, '-W', 'error', '-c', code, *arguments]
    return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def result(process):
    out, err = process.communicate(timeout=600)
    assert process.returncode == 0, err
    return json.loads(out)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return where machine code goes."""
    monkeypatch.setenv('NUMBA_CACHE_DIR', str(tmp_path))
    return tmp_path


def source(factor, asked):
    """Return what makes a kernel of one line, and notes that it was asked to."""

    def make():
        def turned(numbers, constants):
            numbers[0] = factor * math.cos(numbers[0]) * constants[0]

        asked.append(factor)
        return turned

    return make


def found(kernel):
    numbers = (ctypes.c_double * 1)(2.0)
    kernel(numbers, (ctypes.c_double * 1)(3.0))
    return numbers[0]


def files(folder):
    return [path for path in folder.rglob('*') if path.is_file()]


@pytest.mark.parametrize('body', ['yaw_plane', 'eight_dof'])
def test_who_finds_machine_code_drives_without_numba(body):
    first, later, plain = (
        result(start(STEP, body, **environment)) for environment in ({}, {}, {'NUMBA_DISABLE_JIT': '1'})
    )
    assert later[2] is False
    assert later[:2] == first[:2]
    assert later[0] == pytest.approx(plain[0], rel=1e-12, abs=1e-12)


@pytest.mark.slow
def test_machine_code_finds_the_bits_of_numba():
    numba = pytest.importorskip('numba')
    pointer = numba.types.CPointer(numba.float64)
    fresh = numba.cfunc(numba.void(pointer, pointer), error_model='numpy')(compiled.sources()['advance']).ctypes
    for vehicle in (VehicleParameters(), VehicleParameters(tyre_model='lugre', cornering_stiffness=9e3)):
        model = packed_constants(constants(vehicle))
        for speed in (0.0, 0.3, 4.0, 30.0):
            requests = [
                packed_request(
                    initial_state(speed), Inputs((0.3, 0.2, -0.1, 0.0), (900.0,) * 4), Environment(0.1, 9.0), False,
                    (0.5, 0.4, -0.2, 0.1), 100, 0.005,
                )
                for _ in range(2)
            ]  # fmt: skip
            kept, made = requests
            compiled.kernel('advance')(kept, model)
            fresh(ctypes.cast(made, fresh.argtypes[0]), ctypes.cast(model, fresh.argtypes[1]))
            assert kept[:] == made[:]


def test_a_file_is_made_once_and_again_when_the_text_changes(folder):
    asked = []
    wanted = 3.0 * math.cos(2.0)
    assert found(load_kernel('tiny', 'text', source(1.0, asked))) == wanted
    assert found(load_kernel('tiny', 'text', source(7.0, asked))) == wanted  # that of the file
    assert found(load_kernel('tiny', 'another text', source(2.0, asked))) == 2.0 * wanted
    assert asked == [1.0, 2.0]
    assert len(files(folder)) == 1


@pytest.mark.parametrize('harm', ['one bit', 'cut short', 'empty', 'of another machine'])
def test_a_file_that_came_to_harm_is_made_anew(folder, monkeypatch, harm):
    asked = []
    load_kernel('tiny', 'text', source(1.0, asked))
    (file,) = files(folder)
    good = file.read_bytes()
    bad = {
        'one bit': good[:-40] + bytes([good[-40] ^ 1]) + good[-39:],
        'cut short': good[:-1],
        'empty': b'',
        'of another machine': good,
    }[harm]
    file.write_bytes(bad)
    if harm == 'of another machine':
        monkeypatch.setattr(machine_code, '_machine_text', lambda: b'another machine')
    assert found(load_kernel('tiny', 'text', source(2.0, asked))) == 2.0 * 3.0 * math.cos(2.0)
    assert asked == [1.0, 2.0]


def test_processes_that_compile_at_once_find_the_same_and_leave_one_file(tmp_path):
    (tmp_path / 'tiny.py').write_text(TINY)
    code = f'exec(compile(open({str(tmp_path / "tiny.py")!r}).read(), {str(tmp_path / "tiny.py")!r}, "exec"))'
    cache = tmp_path / 'cache'
    both = [result(process) for process in [start(code, NUMBA_CACHE_DIR=str(cache)) for _ in range(2)]]
    (file,) = files(cache)
    written = file.stat().st_mtime_ns
    later = result(start(code, NUMBA_CACHE_DIR=str(cache)))
    assert [*both, later] == [[3.0 * math.cos(2.0), True], [3.0 * math.cos(2.0), True], [3.0 * math.cos(2.0), False]]
    assert file.stat().st_mtime_ns == written


def test_where_no_file_can_be_written_the_plain_physics_say_so(tmp_path, monkeypatch):
    (tmp_path / 'file').write_bytes(b'')
    monkeypatch.setattr(machine_code, '_folders', lambda: [tmp_path / 'file' / 'folder'])
    with pytest.warns(RuntimeWarning, match=r'physics run uncompiled.*set NUMBA_CACHE_DIR'):
        assert load_kernel('tiny', 'text', source(1.0, [])) is None


def test_what_calls_python_is_not_kept(folder):
    def make():
        def raises(numbers, constants):
            if numbers[0] > 1.0:
                print(numbers[0])

        return raises

    with pytest.warns(RuntimeWarning, match='their machine code calls .*Py'):
        assert load_kernel('tiny', 'text', make) is None
    assert files(folder) == []


@pytest.mark.parametrize('name', ['numba', 'llvmlite'])
def test_without_numba_or_its_llvm_there_are_no_kernels_and_no_warning(monkeypatch, name):
    monkeypatch.setitem(sys.modules, name, None)
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        assert load_kernel('tiny', 'text', source(1.0, [])) is None
