"""The directory of a sweep: what is asked for, and a part of the table for each chunk that is done.

A part is written under another name and then renamed, so that it is there whole or not at all. What a sweep has left
to do follows from the parts that are there: one that was killed goes on with the same command.
"""

import json
import os
from pathlib import Path
from typing import Any

from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.sweep.study import Study

REQUEST = 'sweep.json'
TABLE = 'turns'
_PART = 'part-{:06d}.parquet'
_UNFINISHED = '.part'


class Parts:
    """The parts of a study's table.

    Parameters
    ----------
    directory
        Of the sweep; made if it isn't there.
    study
        What is asked for.

    Raises
    ------
    RunError
        The directory holds something else, or the results of another sweep.
    """

    def __init__(self, directory: Path, study: Study) -> None:
        self.table = directory / TABLE
        self._chunks = study.chunks
        try:
            _claim(directory, study)
            self.table.mkdir(exist_ok=True)
            for path in self.table.glob(f'{_UNFINISHED}*'):
                path.unlink()
        except OSError as error:
            raise RunError(f'{error.filename}: {error.strerror}') from None

    @property
    def missing(self) -> tuple[int, ...]:
        """Numbers of the chunks that are not there yet."""
        there = set(os.listdir(self.table))
        return tuple(number for number in range(self._chunks) if _PART.format(number) not in there)

    def write(self, number: int, data: bytes) -> None:
        """Put the part of a chunk into the table.

        Raises
        ------
        RunError
            The system refuses.
        """
        unfinished = self.table / f'{_UNFINISHED}-{number}'
        try:
            with unfinished.open('wb') as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            unfinished.replace(self.table / _PART.format(number))
        except OSError as error:
            raise RunError(f'{self.table}: {error.strerror}; make room, then run the same command again') from None


def _claim(directory: Path, study: Study) -> None:
    """Write what is asked for into a new directory, or compare it with what was asked for before."""
    request = directory / REQUEST
    wanted = json.loads(json.dumps(study.as_json()))
    if request.exists():
        _compare(directory, json.loads(request.read_text(encoding='utf-8')), wanted)
        return
    directory.mkdir(parents=True, exist_ok=True)
    if any(directory.iterdir()):
        raise RunError(f'{directory}: holds something, but no sweep; name a directory that is new or empty')
    unfinished = directory / f'{_UNFINISHED}-{REQUEST}'
    unfinished.write_text(json.dumps(wanted, indent=2) + '\n', encoding='utf-8')
    unfinished.replace(request)


def _compare(directory: Path, before: dict[str, Any], wanted: dict[str, Any]) -> None:
    for key, value in wanted.items():
        if before.get(key) != value:
            said = 'another file' if key == 'tree' else f'{before.get(key)!r}, not {value!r}'
            raise RunError(
                f'{directory}: holds another sweep: its {_WORDS.get(key, key)} is {said}; repeat its command to go '
                'on with it, or name another directory'
            )


_WORDS = {'tree': 'scenario', 'axes': '--vary', 'settings': '--set', 'version': 'version of omni_vehicle_ros'}
