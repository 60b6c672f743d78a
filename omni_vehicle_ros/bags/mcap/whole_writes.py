"""Writing without a buffer in this process."""

from typing import IO


def write_whole(file: IO[bytes], data: bytes | bytearray) -> None:
    """Write all of some bytes to a file without a buffer.

    A buffer would hide an error of the system until later, and be lost when the process is killed.

    Raises
    ------
    OSError
        The system refuses, maybe after a part.
    """
    with memoryview(data) as rest:
        written = 0
        while written < len(rest):
            written += file.write(rest[written:])
