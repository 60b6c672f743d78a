"""Build of the ament_python package ``omni_vehicle_ros`` (colcon and pip both read this file)."""

from pathlib import Path

from setuptools import find_packages, setup

PACKAGE = 'omni_vehicle_ros'
ROOT = Path(__file__).resolve().parent
RUN_TIME = [
    'isal', 'jinja2', 'llvmlite', 'lz4', 'matplotlib', 'numba', 'numpy', 'pyarrow', 'pyyaml', 'rich', 'rosbags',
    'scipy', 'setuptools', 'typer', 'zstandard',
]
EXECUTABLES = (
    'omni_vehicle', 'analyse', 'driver', 'icr_steering', 'odom_transform', 'plant', 'recorder', 'replay',
    'side_slip_controller', 'vehicle', 'wheel_module',
)
SHARED = ('.json', '.py', '.rviz', '.urdf', '.xml', '.yaml')


def share_files(folder: str) -> list[tuple[str, list[str]]]:
    """Return `folder` and its sub-folders as data files below ``share/omni_vehicle_ros``."""
    found = [path for path in (ROOT / folder).rglob('*') if path.suffix in SHARED]
    files = sorted(path.relative_to(ROOT) for path in found)
    parents = sorted({path.parent for path in files})
    return [(f'share/{PACKAGE}/{parent}', [str(path) for path in files if path.parent == parent]) for parent in parents]


setup(
    name=PACKAGE,
    version='0.1.0',
    description='Steer-by-wire suite for a road vehicle with four-wheel independent steering',
    license='Apache-2.0',
    author='The omni_vehicle_ros authors',
    maintainer='The omni_vehicle_ros authors',
    maintainer_email='maintainers@omni-vehicle-ros.invalid',
    python_requires='>=3.10',
    packages=find_packages(include=[PACKAGE, f'{PACKAGE}.*']),
    package_data={
        f'{PACKAGE}.bench': ['step.c'],
        **{f'{PACKAGE}.{page}': ['templates/*.j2'] for page in ('analysis', 'sweep', 'thesis')},
    },
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{PACKAGE}']),
        (f'share/{PACKAGE}', ['package.xml']),
        *share_files('config'),
        *share_files('launch'),
        *share_files('rviz'),
        *share_files('urdf'),
    ],
    install_requires=RUN_TIME,
    extras_require={
        'bench': ['mcap', 'mcap-ros2-support'],
        'cluster': ['distributed'],
        'peers': ['commonroad-vehicle-models', 'slipx'],
        'test': ['hypothesis', 'pytest'],
    },
    zip_safe=True,
    entry_points={
        'console_scripts': [
            *(f'{name} = {PACKAGE}.executables:{name}' for name in EXECUTABLES),
        ],
    },
)
