"""The loop over the messages of a piece of an MCAP file, compiled by numba: no object is made for a message."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

Walk = Callable[..., int]

CHANNELS = 2**16
LEAST = 31
"""Bytes of a message record before its content."""

LENGTH, CONSTANTS, NUMBERS, LAST, NEXT, STORE, WIDTH, COUNT = range(8)
"""What is known of a lane, the messages of one topic and one layout: their length; where in the lists of words its
constants begin, its numbers begin, and these end; the next lane of the topic or -1; where in the store its rows begin,
how long one is, and how many there are."""


@cache
def compiled_walk() -> Walk | None:
    """Return `walk` compiled; None where there is no way to do so. The first call compiles it or loads it from disk."""
    try:
        from numba import config, njit

        return None if config.DISABLE_JIT else njit(cache=True)(walk)
    except (ImportError, RuntimeError):  # RuntimeError: no place for the cache
        return None


def words_of(piece: bytes) -> Any:
    """Return the word of 8 bytes that begins at each byte of at least 8, shape (len(piece) - 7,)."""
    return np.ndarray((len(piece) - 7,), '<u8', piece, strides=(1,))


def walk(
    words: Any, position: int, end: int, topic_of: Any, topics: Any, lanes: Any, places: Any, masks: Any,
    constants: Any, store: Any, capacity: int,
) -> int:
    """Go from message to message and store their numbers, up to a record that needs a closer look.

    Parameters
    ----------
    words
        Of the piece.
    position, end
        Where a record begins, and the last one ends.
    topic_of
        The topic of each channel (int32), shape (65536,): -1 for those that are unknown.
    topics
        For each topic its messages so far, those that are stored, and its first lane: -1 if it has none, -2 if it is
        to be counted only; shape (topics, 3).
    lanes
        Shape (lanes, 8).
    places
        Where in a message the words of lanes are, shape (words,).
    masks, constants
        Which bits of the words must be as they are in which constant, shape (words,).
    store
        Rows of lanes: log time [ns], number of the message among those of its topic, numbers. Shape (any,).
    capacity
        Messages of a topic, and rows of a lane.

    Returns
    -------
    int
        Where the record begins that needs a closer look, or the end.
    """
    while position + 31 <= end:
        length, log_time = np.int64(words[position + 1]), np.int64(words[position + 15])  # below 0 from 2^63 on
        topic = topic_of[words[position + 9] & np.uint64(0xFFFF)]
        is_message = words[position] & np.uint64(0xFF) == np.uint64(5)
        if not is_message or length < 22 or length > end - position - 9 or topic < 0 or log_time < 0:
            break
        lane = topics[topic, 2]
        if lane != -2:
            begin = position + 31
            number = 0
            while lane >= 0:
                number = lanes[lane, NUMBERS]
                fits = lanes[lane, LENGTH] == length - 22
                if fits:
                    for word in range(lanes[lane, CONSTANTS], number):
                        if (words[begin + places[word]] ^ constants[word]) & masks[word]:
                            fits = False
                            break
                if fits:
                    break
                lane = lanes[lane, NEXT]
            if lane < 0 or topics[topic, 1] >= capacity:
                break
            # Taken out of the arrays before those are written to, so that the loop need not look again every time.
            cell = lanes[lane, STORE] + lanes[lane, COUNT] * lanes[lane, WIDTH]
            last = lanes[lane, LAST]
            lanes[lane, COUNT] += 1
            store[cell], store[cell + 1] = log_time, topics[topic, 1]
            for word in range(number, last):
                store[cell + 2 + word - number] = words[begin + places[word]]
            topics[topic, 1] += 1
        topics[topic, 0] += 1
        position += 9 + int(length)
    return position
