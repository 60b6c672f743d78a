"""Where the files are that come with the package."""

import contextlib
import sys
from pathlib import Path

from omni_vehicle_ros.errors import RunError

PACKAGE = 'omni_vehicle_ros'


def config_directory() -> Path:
    """Return the folder ``config`` of the package.

    It is beside the package in a source tree, else in the package's share folder as ament knows it, else in that
    below ``sys.prefix``.

    Raises
    ------
    RunError
        None of them exists.
    """
    candidates = [share / 'config' for share in _shares()]
    for folder in candidates:
        if folder.is_dir():
            return folder
    raise RunError(f'{PACKAGE} is installed without its folder config; looked for {", ".join(map(str, candidates))}')


def _shares() -> list[Path]:
    shares = [Path(__file__).resolve().parents[1]]
    with contextlib.suppress(ImportError, LookupError, OSError):
        from ament_index_python.packages import get_package_share_directory

        shares.append(Path(get_package_share_directory(PACKAGE)))
    return [*shares, Path(sys.prefix) / 'share' / PACKAGE]
