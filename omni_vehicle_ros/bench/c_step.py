"""The step in C, compiled by the system's compiler where there is one."""

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.model.packing import STATE
from omni_vehicle_ros.model.state import Vector

COMPILERS = ('cc', 'gcc', 'clang')
NO_COMPILER = f'no C compiler: none of {", ".join(COMPILERS)} is in PATH'
OPTIONS = ('-O2', '-shared', '-fPIC')


class CStep(NamedTuple):
    """``advance`` of step.c: pointers to request and constants, steps, size, constant speed."""

    advance: Callable[[int, int, int, float, bool], None]

    def drive(self, request: Vector, constants: Vector, steps: int, size: float) -> Vector:
        """Return the state after some steps, shape (10,)."""
        there = request.copy()
        self.advance(there.ctypes.data, constants.ctypes.data, steps, size, False)
        return there[:STATE]


def compiled_step() -> CStep | None:
    """Return the step, or None where there is no compiler.

    Raises
    ------
    RunError
        The compiler fails.
    """
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        source, library = Path(folder) / 'step.c', Path(folder) / 'step.so'
        source.write_bytes(files('omni_vehicle_ros.bench').joinpath('step.c').read_bytes())
        command = [compiler, *OPTIONS, '-o', str(library), str(source), '-lm']
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RunError(f'{compiler} fails on step.c: {(done.stderr.strip() or "no reason given").splitlines()[0]}')
        function = ctypes.CDLL(str(library)).advance
    pointer = ctypes.c_void_p
    function.argtypes = (pointer, pointer, ctypes.c_long, ctypes.c_double, ctypes.c_int)
    function.restype = None
    return CStep(function)
