import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.fixture
def check_python(root, monkeypatch):
    def check(version):
        monkeypatch.setattr(sys, 'version_info', version)
        runpy.run_path(str(root / 'scripts' / 'check_python.py'))

    return check


@pytest.mark.parametrize('version', [(3, 10, 0), (3, 11, 7), (3, 12, 1), (3, 13, 9)])
def test_supported_pythons_pass(check_python, version):
    check_python(version)


@pytest.mark.parametrize(('version', 'said'), [((3, 9, 18), '3.9'), ((3, 14, 0), '3.14'), ((2, 7, 18), '2.7')])
def test_other_pythons_are_refused_in_one_line_with_the_remedy(check_python, version, said):
    with pytest.raises(SystemExit, match=rf'is Python {said}, but 3\.10 to 3\.13 is needed: .*PYTHON=') as refused:
        check_python(version)
    assert '\n' not in str(refused.value)


def test_python_without_venv_is_refused_with_the_remedy(check_python, monkeypatch):
    monkeypatch.setattr('importlib.util.find_spec', lambda name: None)
    with pytest.raises(SystemExit, match='without venv: `apt install python3-venv`'):
        check_python((3, 12, 1))


@pytest.mark.skipif(shutil.which('make') is None, reason='needs make')
def test_make_says_when_there_is_no_python(root, tmp_path):
    venv = tmp_path / 'venv'
    command = ['make', '--no-print-directory', 'setup', f'VENV={venv}', 'PYTHON=no-such-python']
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=60)
    assert done.returncode != 0
    assert 'No no-such-python here: install Python 3.10 to 3.13' in done.stderr
    assert not venv.exists()


def test_virtual_environment_is_an_ament_prefix(root, setup_arguments, monkeypatch):
    index = pytest.importorskip('ament_index_python.packages')
    prefix = Path(sys.prefix)
    if not (prefix / 'setup.stamp').exists():
        pytest.skip('this Python is not that of `make setup`')
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(prefix))
    share = Path(index.get_package_share_directory('omni_vehicle_ros'))
    assert share == prefix / 'share' / 'omni_vehicle_ros'
    for folder, paths in setup_arguments['data_files']:
        if folder.startswith('share/omni_vehicle_ros'):
            for path in paths:
                assert (prefix / folder / Path(path).name).resolve() == root / path
    for executable in (prefix / 'lib' / 'omni_vehicle_ros').iterdir():
        assert executable.resolve() == prefix / 'bin' / executable.name
