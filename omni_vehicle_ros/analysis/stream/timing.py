"""When the messages of a topic came: period, jitter, latency and missed cycles."""

from typing import Any, NamedTuple

import numpy as np

from omni_vehicle_ros.analysis.stream.envelope import Envelope, Times
from omni_vehicle_ros.analysis.stream.statistics import Quantiles, RunningStatistics

LEARNED = 256
"""Periods from which the nominal one is learned: their median."""
REGULAR = 0.2
"""A topic is cyclic if most of these periods are as close to the nominal one as this share of it."""
OTHER_CLOCK = 3_600_000_000_000
"""Stamps this far from the log times are of another clock [ns]."""
GAPS_KEPT = 200
BUCKETS = 512
"""Intervals of the course of latency and period."""

_SECOND = 1e9


class Gap(NamedTuple):
    """A pause of a cyclic topic: the stamps before and after it [ns], and the cycles that were missed."""

    begin: int
    end: int
    cycles: int


class TopicTiming:
    """The timing of one topic, from its stamps and its log times.

    Attributes
    ----------
    count
        Messages so far.
    missed
        Cycles without a message, by the stamps.
    pauses, gaps
        Number of the pauses that make them up, and the first of these.
    backward
        Messages with a stamp before that of the one before them.
    latency, periods
        Log time less stamp, and from one stamp to the next [s], over time.
    """

    def __init__(self) -> None:
        self.count = self.missed = self.pauses = self.repeated = self.backward = 0
        self.gaps: list[Gap] = []
        self.nominal: int | None = None
        self.cyclic = False
        self.first = self.last = 0
        self.latency, self.periods = Envelope(1, BUCKETS), Envelope(1, BUCKETS)
        self._stamps, self._logs = _Periods(), _Periods()
        self._waiting: list[Times] = []
        self._latency, self._quantiles, self._other_clock = RunningStatistics(1), Quantiles(), 0

    def add(self, stamps: Times, logs: Times) -> None:
        """Take the next messages: stamps and log times [ns], shape (n,); the latter count if no stamp was set."""
        self._add_latency(stamps, logs)
        stamps = stamps if stamps.any() else logs
        before = self._stamps.last
        self._stamps.add(stamps)
        self._logs.add(logs)
        self.first = min(self.first, int(stamps.min())) if self.count else int(stamps.min())
        self.count += len(stamps)
        self.last = max(self.last, int(stamps.max()))
        all_stamps = stamps if before is None else np.concatenate([[before], stamps])
        if len(all_stamps) > 1:
            self.periods.add(all_stamps[1:], np.diff(all_stamps)[:, np.newaxis] / _SECOND)
        self.backward += int(np.count_nonzero(np.diff(all_stamps) < 0))
        self.repeated += int(np.count_nonzero(np.diff(all_stamps) == 0))
        if self.nominal is not None:
            self._find_gaps(all_stamps)
            return
        self._waiting.append(stamps)
        if self.count > LEARNED:
            self._learn()

    def finish(self) -> None:
        """Say that all messages have come."""
        if self.nominal is None and self.count > 2:
            self._learn()

    def _learn(self) -> None:
        stamps = np.concatenate(self._waiting)
        periods = np.diff(stamps[: LEARNED + 1])
        rising = periods[periods > 0]
        self._waiting.clear()
        self.nominal = int(np.median(rising)) if len(rising) else 0
        close = np.abs(rising - self.nominal) <= REGULAR * self.nominal
        self.cyclic = bool(self.nominal) and float(np.count_nonzero(close)) >= 0.5 * len(periods)
        self._find_gaps(stamps)

    def _find_gaps(self, stamps: Times) -> None:
        if not self.cyclic or not self.nominal:
            return
        cycles = np.rint(np.diff(stamps) / self.nominal).astype(np.int64) - 1
        places = np.flatnonzero(cycles > 0)
        self.missed += int(np.sum(cycles[places]))
        self.pauses += len(places)
        for place in places[: max(0, GAPS_KEPT - len(self.gaps))].tolist():
            self.gaps.append(Gap(int(stamps[place]), int(stamps[place + 1]), int(cycles[place])))

    def _add_latency(self, stamps: Times, logs: Times) -> None:
        late = logs - stamps
        same = (np.abs(late) < OTHER_CLOCK) & (stamps != 0)
        self._other_clock += int(np.count_nonzero(~same & (stamps != 0)))
        seconds = late[same] / _SECOND
        if len(seconds):
            self._latency.add(logs[same], seconds[:, np.newaxis])
            self._quantiles.add(np.maximum(seconds, 0.0))
            self.latency.add(logs[same], seconds[:, np.newaxis])

    @property
    def longest_latency(self) -> float:
        """The longest latency [s]; 0 if it is not known."""
        return float(self._latency.figures(0)['maximum'] or 0.0)

    def figures(self) -> dict[str, Any]:
        """Return what ``metrics.json`` says about the timing of a topic; None where there is nothing to say.

        Returns
        -------
        dict
            ``cyclic``, ``period`` (the nominal one), ``rate`` [1/s]; ``jitter`` (of the stamps) and ``log_jitter``,
            each with ``deviation`` (standard), ``p99`` (99 % of the periods do not exceed it), ``shortest`` and
            ``longest`` period; ``latency``: log time less stamp, ``mean``, ``p99``, ``shortest``, ``longest`` [s];
            ``missed_cycles``, ``longest_gap`` [s], ``repeated`` and ``backward`` stamps.
        """
        span = (self.last - self.first) / _SECOND
        return {
            'cyclic': self.cyclic,
            'period': self.nominal / _SECOND if self.cyclic and self.nominal else None,
            'rate': (self.count - 1) / span if span > 0.0 and self.count > 1 else None,
            'jitter': self._stamps.figures() if self.cyclic else None,
            'log_jitter': self._logs.figures() if self.cyclic else None,
            'latency': self._latency_figures(),
            'other_clock': self._other_clock,
            'missed_cycles': self.missed if self.cyclic else None,
            'repeated': self.repeated,
            'backward': self.backward,
        }

    def _latency_figures(self) -> dict[str, float | None] | None:
        found = self._latency.figures(0)
        if not found['count']:
            return None
        longest = found['maximum'] or 0.0
        p99 = min(self._quantiles.quantile(0.99), max(longest, 0.0))
        return {'mean': found['mean'], 'p99': p99, 'shortest': found['minimum'], 'longest': longest}


class _Periods:
    """The times from one message to the next."""

    def __init__(self) -> None:
        self.last: int | None = None
        self._statistics, self._quantiles = RunningStatistics(1), Quantiles()

    def add(self, times: Times) -> None:
        joined = times if self.last is None else np.concatenate([[self.last], times])
        self.last = int(times[-1])
        periods = np.diff(joined) / _SECOND
        if len(periods):
            self._statistics.add(joined[1:], periods[:, np.newaxis])
            self._quantiles.add(np.maximum(periods, 0.0))

    def figures(self) -> dict[str, float | None] | None:
        found = self._statistics.figures(0)
        if not found['count']:
            return None
        p99 = min(self._quantiles.quantile(0.99), found['maximum'] or 0.0)
        return {
            'deviation': found['deviation'], 'p99': p99, 'shortest': found['minimum'], 'longest': found['maximum'],
        }
