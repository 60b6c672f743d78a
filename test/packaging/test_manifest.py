"""package.xml, setup.py, the lock and the imports of the code must tell the same story."""

import ast
import importlib
import re
import sys

import pytest

from omni_vehicle_ros import interface

# What a package of PyPI is called by rosdep and in an import, where that is not its own name.
ROSDEP_KEYS = {
    'pyyaml': 'python3-yaml', 'rosbags': 'python3-rosbags-pip', 'isal': None, 'llvmlite': None, 'lz4': None,
    'pyarrow': None, 'zstandard': None,
}
IMPORT_NAMES = {'commonroad-vehicle-models': 'vehiclemodels', 'mcap-ros2-support': 'mcap_ros2', 'pyyaml': 'yaml'}
# What is no node of a run.
OTHER_EXECUTABLES = ('analyse', 'odom_transform', 'omni_vehicle', 'replay', 'vehicle')
# Parts of ROS 2 that have no wheel: their users have a ROS installation.
ONLY_WITH_ROS = {'launch', 'launch_ros', 'robot_state_publisher', 'rviz2', 'tf2_msgs'}


@pytest.fixture(scope='module')
def manifest(root):
    package = pytest.importorskip('catkin_pkg.package')
    return package.parse_package(str(root / 'package.xml'))


@pytest.fixture(scope='module')
def locked(root):
    """Return the text of each requirement in the lock, by its name."""
    lines = (root / 'requirements.lock').read_text(encoding='utf-8')
    entries = re.split(r'\n(?=[a-z0-9])', re.sub(r'^\s*#.*\n', '', lines, flags=re.MULTILINE))
    return {(name := entry.split('==')[0]) + entry.split('\n')[0][len(name):]: entry for entry in entries}


def names(locked):
    return {entry.split('==')[0] for entry in locked}


def run_time(setup_arguments):
    return set(setup_arguments['install_requires']) - {'setuptools'}


def imports(root):
    """Return the top-level names that the package and its launch files import."""
    found = set()
    for folder in ('omni_vehicle_ros', 'launch'):
        for path in (root / folder).rglob('*.py'):
            for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
                if isinstance(node, ast.Import):
                    found |= {alias.name.split('.')[0] for alias in node.names}
                elif isinstance(node, ast.ImportFrom) and node.module:
                    found.add(node.module.split('.')[0])
    return found - set(sys.stdlib_module_names) - {'omni_vehicle_ros'}


def ros_packages(manifest):
    return {str(depend) for depend in manifest.exec_depends if not str(depend).startswith('python3-')}


def test_manifest_is_a_valid_ament_python_package(manifest):
    manifest.validate()
    assert manifest.package_format == 3
    assert manifest.get_build_type() == 'ament_python'


def test_version_name_and_licence_agree(root, manifest, setup_arguments):
    assert manifest.name == setup_arguments['name']
    assert manifest.version == setup_arguments['version']
    assert manifest.licenses == [setup_arguments['license']]
    assert (root / 'resource' / manifest.name).is_file()


def test_rosdep_keys_are_the_run_time_requirements(manifest, setup_arguments):
    keys = {str(depend) for depend in manifest.exec_depends if str(depend).startswith('python3-')}
    assert keys == {ROSDEP_KEYS.get(name, f'python3-{name}') for name in run_time(setup_arguments)} - {None}
    tests = {str(depend) for depend in manifest.test_depends}
    assert tests == {f'python3-{name}' for name in setup_arguments['extras_require']['test']}


def test_all_that_is_imported_is_declared(root, manifest, setup_arguments):
    extras = setup_arguments['extras_require']
    declared = run_time(setup_arguments) | {*extras['bench'], *extras['cluster'], *extras['peers']}
    python = {IMPORT_NAMES.get(name, name) for name in declared}
    assert imports(root) <= python | ros_packages(manifest)


def test_lock_has_all_that_is_declared(root, locked, manifest, setup_arguments):
    ros = {f'ros-{name.replace("_", "-")}' for name in ros_packages(manifest) - ONLY_WITH_ROS}
    asked = re.findall(r'^([A-Za-z][\w-]*)', (root / 'requirements.in').read_text(encoding='utf-8'), flags=re.MULTILINE)
    asked = {name.lower() for name in asked}
    assert ros | run_time(setup_arguments) | asked <= names(locked)
    assert run_time(setup_arguments) | set(setup_arguments['extras_require']['test']) <= asked


def test_lock_pins_all_by_hash_and_names_no_place(root, locked):
    for name, entry in locked.items():
        assert re.match(r'[a-z0-9-]+==\S+', entry), name
        assert '--hash=sha256:' in entry, name
    assert not re.search(r'://|file:| @ |--(extra-)?index|--find-links|[ =]/', (root / 'requirements.lock').read_text())


def test_every_executable_has_its_module_and_every_node_its_executable(setup_arguments):
    executables = {}
    for line in setup_arguments['entry_points']['console_scripts']:
        name, module, function = re.fullmatch(r'(\w+) = ([\w.]+):(\w+)', line).groups()
        executables[name] = getattr(importlib.import_module(module), function)
    assert all(map(callable, executables.values()))
    assert {role.split('/')[-1] for role in interface.NODES} | {*OTHER_EXECUTABLES} == set(executables)


def test_all_files_for_users_are_installed(root, setup_arguments):
    installed = {path for _, paths in setup_arguments['data_files'] for path in paths}
    present = {
        str(path.relative_to(root))
        for folder in ('config', 'launch', 'rviz', 'urdf')
        for path in (root / folder).rglob('*')
        if path.is_file() and path.suffix != '.pyc'
    }
    assert present < installed
    for target, paths in setup_arguments['data_files']:
        for path in paths:
            if path in present:
                assert target == f'share/omni_vehicle_ros/{path.rpartition("/")[0]}'
