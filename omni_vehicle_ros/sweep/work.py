"""Who does the chunks of a study: the cores of this machine, or the workers of a Dask cluster."""

import logging
from collections.abc import Generator, Sequence
from itertools import islice
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from omni_vehicle_ros.errors import OmniVehicleError, RunError
from omni_vehicle_ros.sweep.study import Study
from omni_vehicle_ros.sweep.turns import chunk_table
from omni_vehicle_ros.workers import Workers

if TYPE_CHECKING:
    from distributed import Client

AHEAD = 2
"""Chunks under way for each thread of a cluster: one that is driven, one that waits."""
RETRIES = 10
"""How often a chunk is begun anew whose worker was lost."""

PATIENCE = 10.0
"""How long a scheduler may take to answer, and its first worker to come [s]."""

Part = tuple[int, bytes]


def on_this_machine(study: Study, chunks: Sequence[int]) -> Generator[Part, None, None]:
    """Yield number and table of each chunk as it is done, by a process for each core.

    Raises
    ------
    OmniVehicleError
        A turn can't be; or, as a `RunError`, a worker ended before its time.
    """
    with Workers(prepare=compile_all) as workers:
        yield from workers.as_done(((number, (study, number)) for number in chunks), chunk_table)


def compile_all() -> None:
    """Compile what drives turns, where nobody has done it yet."""
    from omni_vehicle_ros.scenarios import load_scenario
    from omni_vehicle_ros.sweep.drive import drive
    from omni_vehicle_ros.sweep.open_loop import open_loop

    drive([open_loop(load_scenario('simple_turning', ['duration=0.01']))])


def on_cluster(study: Study, chunks: Sequence[int], address: str) -> Generator[Part, None, None]:
    """Do as `on_this_machine` by the workers of a Dask cluster; a chunk whose worker is lost goes to another one.

    Parameters
    ----------
    study, chunks
        What is to be done.
    address
        Of the scheduler, such as ``tcp://10.0.0.1:8786``.

    Raises
    ------
    OmniVehicleError
        As there; or there is no such cluster.
    """
    from distributed import as_completed

    with _client(address) as client:
        run, waiting = uuid4().hex, iter(chunks)

        def submit(count: int) -> list[Any]:
            return [
                client.submit(_part, study, number, key=f'sweep-{run}-{number}', retries=RETRIES)
                for number in islice(waiting, count)
            ]

        threads = sum(client.nthreads().values())
        under_way = as_completed(submit(AHEAD * max(1, threads)), loop=client.loop)
        for future in under_way:
            yield _result(future)
            for following in submit(1):
                under_way.add(following)


def _client(address: str) -> 'Client':
    try:
        from distributed import Client
        from distributed import TimeoutError as Late
    except ImportError:
        raise RunError('--scheduler: distributed is not installed: pip install distributed') from None
    logging.getLogger('distributed').setLevel(logging.CRITICAL)  # what matters of a lost worker is said here
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise RunError(f'--scheduler {address}: no Dask scheduler answers there: {error}') from None
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except Late:
        client.close()
        raise RunError(f'--scheduler {address}: it has no workers; start some: dask worker {address}') from None
    return client


def _result(future: Any) -> Part:
    """Return a part; whatever else a cluster does ends in one line."""
    try:
        found = future.result()
    except Exception as error:
        raise RunError(f'the cluster lost a chunk: {str(error).splitlines()[0]}; run the same command again') from None
    if isinstance(found, OmniVehicleError):
        raise found
    return found  # type: ignore[no-any-return]


def _part(study: Study, number: int) -> Part | OmniVehicleError:
    """Do a chunk; an error of the user's doing is an answer, which no retry would change."""
    try:
        return number, chunk_table(study, number)
    except OmniVehicleError as error:
        return error
