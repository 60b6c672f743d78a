"""The benchmark of the kernel: C finds the same, and what is not there is said."""

import pytest

from omni_vehicle_ros.bench import c_step, kernel, peers
from omni_vehicle_ros.bench.frame import Time
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.model.machine_code import can_compile

needs_numba = pytest.mark.skipif(not can_compile(), reason='numba is missing or switched off')
needs_compiler = pytest.mark.skipif(c_step.compiled_step() is None, reason='there is no C compiler')


@pytest.fixture(scope='module')
def result():
    return kernel.bench(rounds=1, vehicles=24)


@needs_numba
@needs_compiler
def test_every_line_has_both_figures(result):
    peers_missing = {f'beside {name}' for name, module in peers.MODULES.items() if not peers.find_spec(module)}
    for line in result.lines:
        assert line.ours > 0.0
        missing = any(line.name.endswith(name) for name in peers_missing)
        assert (line.limit is None) is missing
        assert (line.note == peers.MISSING) is missing


@needs_numba
@needs_compiler
def test_c_that_finds_something_else_does_not_count(monkeypatch):
    real = c_step.CStep.drive
    monkeypatch.setattr(c_step.CStep, 'drive', lambda *arguments: real(*arguments) * (1.0 + 1e-6))
    with pytest.raises(RunError, match='C and the kernel differ by'):
        kernel.bench(rounds=1, vehicles=24)


@needs_numba
def test_without_a_compiler_the_result_says_so(monkeypatch):
    monkeypatch.setattr(c_step.shutil, 'which', lambda name: None)
    monkeypatch.setattr(kernel, 'start_works', dict)
    monkeypatch.setattr(kernel, 'start_lines', lambda times: [])
    found = kernel.bench(rounds=1, vehicles=24)
    assert found.notes == (c_step.NO_COMPILER,)
    assert found.lines[0].ours > 0.0 and found.lines[0].limit is None and found.lines[0].met is None


def test_a_compiler_that_fails_is_one_line(monkeypatch):
    monkeypatch.setattr(c_step, 'OPTIONS', ('--no-such-option',))
    if c_step.shutil.which('cc') is None:
        pytest.skip('there is no C compiler')
    with pytest.raises(RunError, match=r'fails on step\.c: .*no-such-option'):
        c_step.compiled_step()


@pytest.mark.parametrize(('both', 'judged'), [(2.1, True), (4.0, False)])
def test_two_threads_are_judged_where_two_cores_are_free_only(both, judged):
    times = {kernel.BATCH: Time(1.0, 1.0), kernel.BATCH_THREADS: Time(0.55, 1.1), kernel.SORT_THREADS: Time(both, both)}
    line = kernel.thread_line({**times, kernel.CALIBRATION: Time(2.0, 2.0)}, 10)
    assert line.ratio == pytest.approx(1 / 0.55)
    assert line.met is (True if judged else None)
