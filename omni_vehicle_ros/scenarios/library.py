"""Where scenarios are: those of the package by name, others by path."""

from collections.abc import Collection
from difflib import get_close_matches
from pathlib import Path

from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.share import config_directory

_SUFFIXES = ('.yaml', '.yml')


def scenario_directory() -> Path:
    """Return the folder of the scenarios that belong to the package.

    Raises
    ------
    RunError
        There is none.
    """
    return config_directory() / 'scenarios'


def scenario_names() -> tuple[str, ...]:
    """Return the names of the scenarios that belong to the package, folder by folder.

    A scenario in a sub-folder has the folder in its name, such as ``thesis/bank``.
    """
    return tuple(_files())


def _files() -> dict[str, Path]:
    """Return the files of the package's scenarios by name, those outside of any sub-folder first."""
    root = scenario_directory()
    found = {path.relative_to(root).with_suffix(''): path for path in root.rglob('*') if path.suffix in _SUFFIXES}
    ordered = sorted(found, key=lambda name: (name.parent.parts, name.name))
    return {name.as_posix(): found[name] for name in ordered}


def find_scenario(name_or_path: str) -> tuple[str, Path]:
    """Return the name and the file of a scenario.

    Parameters
    ----------
    name_or_path
        A name from `scenario_names`, or else the path of a YAML file; the name is then that of the file.

    Raises
    ------
    ScenarioError
        There is no such scenario or file.
    """
    files, path = _files(), Path(name_or_path)
    if name_or_path in files:
        return name_or_path, files[name_or_path]
    if path.is_file():
        return path.stem, path
    if path.suffix in _SUFFIXES or path.exists():
        raise ScenarioError(f'{name_or_path}: no such file')
    near = _nearest(name_or_path, files)
    allowed = f'did you mean {near!r}? Or' if near else f'allowed: {", ".join(files)}; or'
    raise ScenarioError(f'unknown scenario {name_or_path!r}; {allowed} give the path of a YAML file')


def _nearest(asked: str, names: Collection[str]) -> str | None:
    """Return the name that is most like what was asked for: with its folder, or if none is, without."""
    last = asked.rpartition('/')[2]
    without = {name.rpartition('/')[2]: name for name in names}
    if last in without:
        return without[last]
    close = get_close_matches(asked, names, n=1) or [without[word] for word in get_close_matches(last, without, n=1)]
    return close[0] if close else None
