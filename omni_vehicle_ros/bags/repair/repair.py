"""Repair of bags that were cut off or damaged: all that makes sense goes into a new one."""

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

from omni_vehicle_ros.bags.bag_contents import BagContents, FoundMetadata, read_metadata
from omni_vehicle_ros.bags.mcap.stream import bag_files
from omni_vehicle_ros.bags.metadata import write_metadata
from omni_vehicle_ros.bags.repair.rebuilt_file import RebuiltFile
from omni_vehicle_ros.bags.repair.salvage import Salvage, Saved
from omni_vehicle_ros.errors import BagError

Progress = Callable[[float], None]

_STRIDE = 2**20
"""Bytes from one call of the progress to the next, about."""


class FileRepair(NamedTuple):
    """What became of one file."""

    name: str
    size: int
    """Of the damaged file [byte]."""
    saved: int
    """Messages."""
    unchecked: int
    """Those of them whose bytes no checksum covers."""
    private: int
    """Records of kinds that MCAP leaves to applications; they are not saved."""
    lost: int | None
    """Messages; None if the file doesn't tell."""
    all_known: bool
    """Whether ``lost`` is all of them, and not the least."""
    lost_bytes: int
    damages: tuple[str, ...]
    """The first few."""
    damage_count: int

    @property
    def lines(self) -> list[str]:
        """What there is to say about the file."""
        lost = 'an unknown number of' if self.lost is None else f'{"" if self.all_known else "at least "}{self.lost}'
        more = self.damage_count - len(self.damages)
        lines = [f'{self.name}: {self.saved} messages saved, {lost} lost; {self.lost_bytes} of {self.size} bytes lost']
        if not self.damage_count:
            return [f'{self.name}: {self.saved} messages saved; the file is whole']
        lines += [f'  {damage}' for damage in self.damages]
        if more:
            lines.append(f'  ... and {more} more')
        if self.unchecked:
            lines.append(f'  {self.unchecked} of the saved messages have no checksum: they may be damaged inside')
        if self.private:
            lines.append(f'  {self.private} private records (of kinds from 0x80 on) are not saved')
        return lines


class Repair(NamedTuple):
    """What became of a bag."""

    directory: Path | None
    """Of the new bag; None if nothing was to be repaired."""
    files: tuple[FileRepair, ...]
    metadata_damage: str
    """Why ``metadata.yaml`` was made anew, empty if that is not why."""

    @property
    def saved(self) -> int:
        """All messages."""
        return sum(file.saved for file in self.files)

    @property
    def lines(self) -> list[str]:
        """What there is to say about the bag."""
        if self.directory is None:
            unchecked = sum(file.unchecked for file in self.files)
            words = f'; {unchecked} of them have no checksum: they may be damaged inside' if unchecked else ''
            return [f'the bag is whole: {self.saved} messages in {len(self.files)} file(s){words}; nothing was written']
        metadata = [self.metadata_damage] if self.metadata_damage else []
        return [*(line for file in self.files for line in file.lines), *metadata, f'bag     {self.directory}']


def repair(path: Path | str, directory: Path | str, progress: Progress = lambda done: None) -> Repair:
    """Put all that makes sense in a bag into a new one; do nothing if the bag is whole.

    The bag itself is only read. Of each file of it one with the same name is made. Memory is bounded by the largest
    message, and the schemas and channels.

    Parameters
    ----------
    path
        A bag directory or one MCAP file.
    directory
        Of the new bag; must not exist, nor lie in the bag.
    progress
        Gets how far it is, from 0 to 1.

    Raises
    ------
    BagError
        There is no such bag, nothing in it can be saved, or the system refuses to read or to write. Then nothing is
        left of the new bag.
    """
    path, directory = Path(path), Path(directory)
    files = bag_files(path)
    _check_places(path, directory, files)
    try:
        metadata = read_metadata(path)
        work = _Work(2 * sum(file.stat().st_size for file in files), progress)
        contents = BagContents()
        checked = tuple(_check(file, contents, work) for file in files)
        whole = not any(file.damage_count for file in checked)
        damage = '' if path.is_file() else contents.compare(metadata, counts=whole)
        if whole and not damage:
            progress(1.0)
            return Repair(None, checked, '')
        with _new_directory(directory):
            return _rebuild(files, directory, metadata, work)._replace(metadata_damage=damage)
    except OSError as error:
        raise BagError(f'{error.filename or path}: {error.strerror or error}; no repaired bag is left') from error


class _Work:
    """Turns positions in files into progress."""

    def __init__(self, total: int, progress: Progress) -> None:
        self._total = total or 1
        self._progress = progress
        self._before = 0

    def watch(self, salvage: Salvage) -> Iterator[Saved]:
        """Give what is saved of a file, and tell how far it is."""
        told = 0
        for item in salvage:
            if salvage.source.position >= told:
                self._progress((self._before + salvage.source.position) / self._total)
                told = salvage.source.position + _STRIDE
            yield item

    def end(self, size: int) -> None:
        """Note that a file is done."""
        self._before += size
        self._progress(self._before / self._total)


def _check_places(path: Path, directory: Path, files: tuple[Path, ...]) -> None:
    for file in files:
        if not file.is_file():
            raise BagError(f'{file} is not a regular file, so it can not be repaired')
    inside = path if path.is_dir() else path.parent
    if inside.resolve() in directory.resolve().parents and (path.is_dir() or (inside / 'metadata.yaml').exists()):
        raise BagError(f'{directory} lies in the bag {inside}, which is not to be touched; name another with --out')
    if os.path.lexists(directory):
        raise BagError(f'{directory} exists; name a directory that does not')


def _check(path: Path, contents: BagContents, work: _Work) -> FileRepair:
    """Read a file up to its first damage."""
    with path.open('rb') as file:
        salvage = Salvage(file)
        for _ in work.watch(salvage):
            if not salvage.whole:
                break
    contents.add(path.name, salvage)
    work.end(salvage.source.size)
    return _file_repair(path.name, salvage)


def _rebuild(files: tuple[Path, ...], directory: Path, metadata: FoundMetadata, work: _Work) -> Repair:
    contents, results = BagContents(), []
    for path in files:
        with path.open('rb') as file:
            salvage = Salvage(file)
            _save(salvage, directory / path.name, work)
        if salvage.messages:
            contents.add(path.name, salvage)
        work.end(salvage.source.size)
        results.append(_file_repair(path.name, salvage))
    result = Repair(directory, tuple(results), '')
    if not result.saved:
        raise BagError(f'nothing can be saved of {", ".join(map(str, files))}: {_first_damage(result)}')
    write_metadata(directory, contents.information(metadata))
    return result


def _save(salvage: Salvage, target: Path, work: _Work) -> None:
    rebuilt = RebuiltFile(target, salvage)
    try:
        for item in work.watch(salvage):
            rebuilt.write(item)
        if salvage.messages:
            contents = BagContents()
            contents.add(target.name, salvage)
            rebuilt.finish(contents.information(FoundMetadata()))
    finally:
        rebuilt.abandon()
    if not salvage.messages:
        target.unlink(missing_ok=True)


def _file_repair(name: str, salvage: Salvage) -> FileRepair:
    source = salvage.source
    lost, all_known = salvage.lost_messages
    return FileRepair(
        name, source.size, salvage.messages, salvage.unchecked, salvage.private, lost, all_known, source.lost_bytes,
        tuple(source.damages), source.damage_count,
    )


def _first_damage(result: Repair) -> str:
    return next((damage for file in result.files for damage in file.damages), 'there are no messages in it')


@contextmanager
def _new_directory(directory: Path) -> Iterator[None]:
    """Make a directory for a ``with`` block; after an error take it away, with those above it that were made."""
    made = [each for each in (directory, *directory.parents) if not each.exists()]
    directory.mkdir(parents=True)
    try:
        yield
    except BaseException:
        shutil.rmtree(directory, ignore_errors=True)
        with suppress(OSError):
            for each in made[1:]:
                each.rmdir()
        raise
