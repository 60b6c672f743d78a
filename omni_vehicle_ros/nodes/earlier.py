"""What was said on a latched topic before a node was there, beside what is said now by latched and volatile publishers.

A transient local subscription hears nothing of volatile publishers, and a volatile one nothing of the past.
"""

from collections.abc import Callable


class Earlier:
    """Takes from two subscriptions what is said now, and the last word until then, which counts while nothing is.

    Parameters
    ----------
    take, take_earlier
        Called with the bytes of a message that is said now, and of one that was said before.
    """

    def __init__(self, take: Callable[[bytes], None], take_earlier: Callable[[bytes], None]) -> None:
        self._take, self._take_earlier = take, take_earlier
        self._heard = False

    def hear(self, data: bytes) -> None:
        """Take what the volatile subscription brings."""
        self._heard = True
        self._take(data)

    def hear_earlier(self, data: bytes) -> None:
        """Take what the latched one brings."""
        if not self._heard:
            self._take_earlier(data)
