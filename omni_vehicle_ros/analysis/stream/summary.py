"""What a survey found, as numbers and words."""

import math
from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

from omni_vehicle_ros.analysis.stream.events import KINDS, Event
from omni_vehicle_ros.analysis.stream.survey import Survey
from omni_vehicle_ros.analysis.stream.traces import NEEDED_FOR
from omni_vehicle_ros.wheels import WHEELS

EVENTS_LISTED = 1000
RESPONSES = {'steer_angle': (WHEELS, 'rad'), 'twist': (('vx', 'vy', 'yaw_rate'), 'm/s, rad/s')}
_COUNTERPART = {'steer_angle': 'joint_states', 'twist': 'odom'}


class Figure(NamedTuple):
    """One number of a bag, to be compared; None where there is none."""

    name: str
    unit: str
    value: float | None


def missing(survey: Survey) -> dict[str, str]:
    """Return the topics that a bag lacks, and what is left out of its report for that."""
    there = {role for role, topic in survey.roles.topics.items() if topic in survey.timing}
    there |= {'<wheel>/command'} if f'{WHEELS[0]}/command' in there else set()
    return {topic: text for topic, text in NEEDED_FOR.items() if topic not in there}


def all_events(survey: Survey) -> tuple[list[Event], Counter[str]]:
    """Return the events in the order of time, and how many there were of each kind, those not kept included."""
    found = list(survey.complaints.events)
    counts = Counter(survey.complaints.counts)
    for spans in survey.spans.found.values():
        found += spans.events
        counts[spans.kind] += spans.count
    silent = survey.heartbeat.events(survey.span[1])
    counts['time-out'] += len(silent)
    for topic, timing in survey.timing.items():
        for gap in timing.gaps:
            text = f'{gap.cycles} cycle{"s" if gap.cycles > 1 else ""} missed'
            found.append(Event(gap.begin, gap.end, 'missed cycles', topic, text))
        counts['missed cycles'] += timing.pauses
    return sorted([*found, *silent]), Counter({kind: counts[kind] for kind in KINDS if counts[kind]})


def metrics_of(survey: Survey) -> dict[str, Any]:
    """Return what ``metrics.json`` says about one bag; None where there is nothing to say, never NaN.

    Returns
    -------
    dict
        ``bag``, ``complete`` and ``damage``; ``begin``: the stamp [s] that all other times count from; ``duration``
        [s]; ``topics``: type and messages; ``unreadable``: why topics are left out; ``missing``: topics that are not
        there, and what is left out for that; ``signals.<trace>.<label>``: statistics, see `RunningStatistics`, in the
        ``unit`` of the trace; ``timing.<topic>``: see `TopicTiming.figures`; ``response``: see `Response.figures`;
        ``grip``: the largest force in the road plane over friction times load, by wheel, and of the body in g;
        ``path``: ``length`` and ``final`` pose; ``events``: ``counts`` by kind, and a ``list``.
    """
    begin, end = survey.span
    events, counts = all_events(survey)
    return {
        'bag': str(survey.bag),
        'complete': not survey.damage,
        'damage': list(survey.damage),
        'begin': begin * 1e-9,
        'duration': (end - begin) * 1e-9,
        'topics': {
            topic: {'type': type_name, 'messages': survey.counts.get(topic, 0)}
            for topic, type_name in sorted(survey.types.items())
        },
        'unreadable': survey.unreadable,
        'missing': missing(survey),
        'signals': _signals(survey, begin),
        'timing': {topic: timing.figures() for topic, timing in sorted(survey.timing.items())},
        'response': _responses(survey),
        'grip': {
            **{wheel: grip.largest for wheel, grip in zip(WHEELS, survey.tyre_grip, strict=True) if grip.counts.any()},
            **({'body': survey.body_grip.largest} if survey.body_grip.counts.any() else {}),
        },
        'path': _path(survey),
        'events': {
            'counts': dict(counts),
            'list': [
                {**event._asdict(), 'begin': (event.begin - begin) * 1e-9, 'end': (event.end - begin) * 1e-9}
                for event in events[:EVENTS_LISTED]
            ],
        },
    }


def _path(survey: Survey) -> dict[str, Any] | None:
    if survey.path.final is None:
        return None
    final = [value if math.isfinite(value) else None for value in survey.path.final]
    return {'length': survey.path.length, 'final': final}


def _signals(survey: Survey, begin: int) -> dict[str, Any]:
    return {
        name: {
            'unit': found.trace.unit,
            **{label: found.statistics.figures(i, begin) for i, label in enumerate(found.trace.labels)},
        }
        for name, found in survey.signals.items()
    }


def _responses(survey: Survey) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, response in survey.responses.items():
        if not response.error.count.any():
            continue
        timing = survey.timing[survey.roles.topics[_COUNTERPART[name]]]
        period = timing.nominal * 1e-9 if timing.cyclic and timing.nominal else None
        labels, unit = RESPONSES[name]
        found[name] = {'unit': unit, **{label: response.figures(i, period) for i, label in enumerate(labels)}}
    return found


def figures_of(metrics: dict[str, Any]) -> list[Figure]:
    """Return the numbers of a bag that a comparison sets side by side."""
    return list(_figures(metrics))


def _figures(metrics: dict[str, Any]) -> Iterator[Figure]:
    yield Figure('duration', 's', metrics['duration'])
    yield Figure('messages', '', sum(topic['messages'] for topic in metrics['topics'].values()))
    if metrics['path']:
        yield Figure('path length', 'm', metrics['path']['length'])
        for name, unit, value in zip(('x', 'y', 'heading'), ('m', 'm', 'rad'), metrics['path']['final'], strict=True):
            yield Figure(f'final {name}', unit, value)
    for name, signals in metrics['signals'].items():
        unit = signals['unit']
        for label, found in signals.items():
            if label != 'unit':
                full = name if label in name else f'{name} {label}'
                for what in ('mean', 'minimum', 'maximum'):
                    yield Figure(f'{full} {what}', unit, found[what])
    for name, signals in metrics['response'].items():
        for label, found in signals.items():
            if label != 'unit':
                for what in ('rms', 'peak', 'lag'):
                    yield Figure(f'{name} {label} error {what}'.replace('error lag', 'lag'), '', found[what])
    for wheel, use in metrics['grip'].items():
        yield Figure(f'largest grip use {wheel}', 'g' if wheel == 'body' else '', use)
    missed = sum(timing['missed_cycles'] or 0 for timing in metrics['timing'].values())
    yield Figure('missed cycles', '', missed)
    late = [timing['latency']['longest'] for timing in metrics['timing'].values() if timing['latency']]
    yield Figure('longest latency', 's', max(late, default=None))
    for kind in KINDS:
        yield Figure(f'events: {kind}', '', metrics['events']['counts'].get(kind, 0))


def compared(bags: list[dict[str, Any]]) -> list[tuple[str, str, list[float | None], list[float | None]]]:
    """Return for each number its name, its unit, its value in each bag, and of all but the first what it is more."""
    tables = [{figure.name: figure for figure in figures_of(metrics)} for metrics in bags]
    names = {name: figure.unit for table in tables for name, figure in table.items()}
    rows = []
    for name, unit in names.items():
        values = [table[name].value if name in table else None for table in tables]
        first = values[0]
        more = [None if value is None or first is None else value - first for value in values[1:]]
        rows.append((name, unit, values, more))
    return rows
