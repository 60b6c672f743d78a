"""Work ahead: reading and decompressing in a thread of its own, while what was read is used."""

import threading
from collections.abc import Iterator
from queue import SimpleQueue
from typing import TypeVar

T = TypeVar('T')

MOST = 16
"""Items that wait at most."""


def read_ahead(items: Iterator[T]) -> Iterator[T]:
    """Give the items of an iterator that another thread goes through, and the error that ends it.

    It pays where most of the time is spent outside of Python's lock, as in zstd and zlib. The thread has ended when
    the iterator returned is exhausted or closed.
    """
    waiting: SimpleQueue[tuple[bool, T | BaseException | None]] = SimpleQueue()
    room = threading.Semaphore(MOST)
    stop = threading.Event()

    def work() -> None:
        try:
            for item in items:
                waiting.put((True, item))
                room.acquire()
                if stop.is_set():
                    return
            waiting.put((False, None))
        except BaseException as error:
            waiting.put((False, error))

    thread = threading.Thread(target=work, name='read_ahead', daemon=True)
    thread.start()
    try:
        while True:
            more, item = waiting.get()
            if not more:
                break
            room.release()
            yield item  # type: ignore[misc]
        if item is not None:
            raise item  # type: ignore[misc]
    finally:
        stop.set()
        room.release()
        thread.join()
