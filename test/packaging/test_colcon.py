"""A colcon workspace, built and tested with the real colcon."""

import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

COLCON = shutil.which('colcon') or shutil.which('colcon', path=str(Path(sys.executable).parent))
TESTED = 'test/test_interface.py'

pytestmark = [pytest.mark.slow, pytest.mark.skipif(COLCON is None, reason='needs colcon')]


def run(command, folder, **environment):
    # The bootstrap of the wheels must run anew in the children, which search other paths.
    inherited = {name: value for name, value in os.environ.items() if not name.startswith(('COLCON_', 'PYTEST_'))}
    path = f'{Path(sys.executable).parent}{os.pathsep}{inherited.get("PATH", "")}'
    done = subprocess.run(
        command, cwd=folder, env={**inherited, 'PATH': path, **environment}, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope='module')
def workspace(root, tmp_path_factory):
    """Return a workspace with a copy of the package, built."""
    workspace = tmp_path_factory.mktemp('workspace')
    unwanted = shutil.ignore_patterns('.*', '__pycache__', '*.egg-info', 'build', 'install', 'log', 'runs')
    shutil.copytree(root, workspace / 'src' / 'omni_vehicle_ros', ignore=unwanted)
    run([COLCON, 'build'], workspace)
    return workspace


@pytest.fixture(scope='module')
def prefix(workspace):
    return workspace / 'install' / 'omni_vehicle_ros'


def test_colcon_test_passes(workspace):
    run([COLCON, 'test', '--return-code-on-test-failure', '--pytest-args', TESTED, '-p', 'no:cacheprovider'], workspace)
    results = ElementTree.parse(workspace / 'build' / 'omni_vehicle_ros' / 'pytest.xml').getroot()
    suite = results if results.tag == 'testsuite' else results[0]
    assert int(suite.get('tests')) > 0
    assert suite.get('failures') == suite.get('errors') == '0'


def test_executables_are_where_ros2_run_looks(prefix, setup_arguments):
    declared = {line.split(' = ')[0] for line in setup_arguments['entry_points']['console_scripts']}
    found = {path.name for path in (prefix / 'lib' / 'omni_vehicle_ros').iterdir() if os.access(path, os.X_OK)}
    assert found == declared


def test_a_sourced_workspace_finds_its_own_package_and_share_folder(workspace, prefix):
    pytest.importorskip('ament_index_python')
    program = (
        'from ament_index_python.packages import get_package_share_directory as share;'
        'import omni_vehicle_ros; print(share("omni_vehicle_ros")); print(omni_vehicle_ros.__file__)'
    )
    command = f'. install/setup.sh && cd / && {sys.executable} -c \'{program}\''
    share, module = run(['sh', '-c', command], workspace, AMENT_PREFIX_PATH='').split()
    assert Path(share) == prefix / 'share' / 'omni_vehicle_ros'
    assert prefix in Path(module).parents
    for item in ('package.xml', 'config/vehicle.yaml', 'launch/vehicle.launch.py'):
        assert (Path(share) / item).is_file()


def test_what_the_report_is_made_of_is_installed(root, prefix):
    templates = {path.name for path in (root / 'omni_vehicle_ros').rglob('*.j2')}
    assert templates
    assert templates == {path.name for path in prefix.rglob('*.j2')}
