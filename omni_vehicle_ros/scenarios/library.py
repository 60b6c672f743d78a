"""Where scenarios are: those of the package by name, others by path."""

import contextlib
import sys
from pathlib import Path

from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.parameters import did_you_mean

PACKAGE = 'omni_vehicle_ros'
_SUFFIXES = ('.yaml', '.yml')


def _candidates() -> list[Path]:
    shares = [Path(__file__).resolve().parents[2]]
    with contextlib.suppress(ImportError, LookupError, OSError):
        from ament_index_python.packages import get_package_share_directory

        shares.append(Path(get_package_share_directory(PACKAGE)))
    shares.append(Path(sys.prefix) / 'share' / PACKAGE)
    return [share / 'config' / 'scenarios' for share in shares]


def scenario_directory() -> Path:
    """Return the folder of the scenarios that belong to the package.

    It is ``config/scenarios`` beside the package in a source tree, else in the package's share folder as
    ament knows it, else below ``sys.prefix``.

    Raises
    ------
    ScenarioError
        None of them exists.
    """
    candidates = _candidates()
    for folder in candidates:
        if folder.is_dir():
            return folder
    raise ScenarioError(f'no folder of scenarios; looked for {", ".join(map(str, candidates))}')


def scenario_names() -> tuple[str, ...]:
    """Return the names of the scenarios that belong to the package, sorted."""
    return tuple(sorted(path.stem for path in scenario_directory().iterdir() if path.suffix in _SUFFIXES))


def find_scenario(name_or_path: str) -> Path:
    """Return the file of a scenario.

    Parameters
    ----------
    name_or_path
        A name from `scenario_names`, or the path of a YAML file: with a folder or one of the suffixes
        .yaml and .yml.

    Raises
    ------
    ScenarioError
        There is no such scenario or file.
    """
    path = Path(name_or_path)
    if path.suffix in _SUFFIXES or len(path.parts) > 1:
        if not path.is_file():
            raise ScenarioError(f'{name_or_path}: no such file')
        return path
    files = {file.stem: file for file in scenario_directory().iterdir() if file.suffix in _SUFFIXES}
    if name_or_path not in files:
        allowed = did_you_mean(name_or_path, sorted(files))
        raise ScenarioError(f'unknown scenario {name_or_path!r}{allowed}; or give the path of a YAML file')
    return files[name_or_path]
