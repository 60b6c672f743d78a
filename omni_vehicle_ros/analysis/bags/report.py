"""What is written about analysed bags: ``metrics.json`` and the page ``report.html``."""

import json
from pathlib import Path
from typing import Any

import jinja2

from omni_vehicle_ros import __version__
from omni_vehicle_ros.analysis.bags.analysis import Analysis, vehicle_of
from omni_vehicle_ros.analysis.bags.marks import BAG_COLOURS, EVENT_COLOURS
from omni_vehicle_ros.analysis.bags.plots import draw_surveys
from omni_vehicle_ros.analysis.stream.summary import compared
from omni_vehicle_ros.analysis.style import WHEEL_COLOURS, house_style, to_svg
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.wheels import WHEELS

LISTED = 60
_NONE, _MINUS = '\u2013', '\u2212'


def write_analysis(found: Analysis, directory: Path) -> None:
    """Write ``metrics.json`` and ``report.html``.

    Raises
    ------
    RunError
        A file can't be written; then neither is left.
    """
    files = {
        directory / 'metrics.json': json.dumps(found.metrics, indent=2, allow_nan=False) + '\n',
        directory / 'report.html': render_bags(found),
    }
    try:
        for path, text in files.items():
            path.write_text(text, encoding='utf-8')
    except BaseException as error:
        for path in files:
            path.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise RunError(f'{error.filename or directory}: {error.strerror}') from None
        raise


def render_bags(found: Analysis) -> str:
    """Return the HTML page of one bag, or of several side by side."""
    names = unique_names([subject.name for subject in found.subjects])
    bags = found.metrics['bags']
    with house_style():
        drawn = draw_surveys(found.surveys, names, [vehicle_of(subject) for subject in found.subjects])
        plots = [
            {'name': plot.name, 'title': plot.title, 'text': plot.text, 'svg': to_svg(plot.figure, plot.name)}
            for plot in drawn
        ]
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader('omni_vehicle_ros.analysis'),
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined,
    )
    environment.filters['number'] = number
    environment.filters['milli'] = lambda value: number(None if value is None else 1e3 * value)
    return environment.get_template('bags.html.j2').render(
        names=names, bags=bags, facts=[_fact(name, bag) for name, bag in zip(names, bags, strict=True)],
        hints=_hints(found, names), figures=_figures(bags[0]) if len(bags) == 1 else [], legend=_legend(names, bags),
        plots=plots, wide=('path-0',) if len(bags) == 1 else ('paths',), rows=compared(bags), listed=LISTED,
        event_colours=EVENT_COLOURS, version=__version__,
    )


def unique_names(names: list[str]) -> list[str]:
    """Return names of which no two are the same: a number follows those that occur again."""
    return [f'{name} ({names[:i].count(name) + 1})' if name in names[:i] else name for i, name in enumerate(names)]


def number(value: float | None) -> str:
    """Return a number with five digits; a dash for none, and 0 for what is next to nothing."""
    if value is None:
        return _NONE
    return f'{value if abs(value) >= 1e-12 else 0.0:.5g}'.replace('-', _MINUS)


def _fact(name: str, bag: dict[str, Any]) -> str:
    messages = sum(topic['messages'] for topic in bag['topics'].values())
    topics = f'{len(bag["topics"])} topic{"s" if len(bag["topics"]) > 1 else ""}'
    return f'{name}: {bag["duration"]:.1f} s, {messages} messages on {topics}'


def _hints(found: Analysis, names: list[str]) -> list[str]:
    hints = []
    for subject, name, bag in zip(found.subjects, names, found.metrics['bags'], strict=True):
        words = [f'{damage}.' for damage in bag['damage']]
        if bag['missing']:
            lacks = '; '.join(f'no {topic}: without {text}' for topic, text in bag['missing'].items())
            words.append(f'What is missing, and what is left out for that: {lacks}.')
        words += _backward(bag)
        words += [subject.hint] if subject.hint else []
        if words:
            hints.append(f'{name}: {" ".join(words)}')
    return hints


def _backward(bag: dict[str, Any]) -> list[str]:
    back = {topic: timing['backward'] for topic, timing in bag['timing'].items() if timing['backward']}
    if not back:
        return []
    places = ', '.join(f'{topic} ({count} times)' for topic, count in list(back.items())[:5])
    return [f'Stamps go back on {places}: what was at one time twice lies over itself.']


def _figures(bag: dict[str, Any]) -> list[tuple[str, str, str]]:
    """Return the main numbers: name, value, unit."""
    speed = bag['signals'].get('speed', {}).get('vx', {})
    load = [bag['signals']['load'][wheel]['minimum'] for wheel in WHEELS] if 'load' in bag['signals'] else []
    uses = [use for place, use in bag['grip'].items() if place != 'body']
    missed = sum(timing['missed_cycles'] or 0 for timing in bag['timing'].values())
    late = max((timing['latency']['longest'] for timing in bag['timing'].values() if timing['latency']), default=None)
    least = min((value for value in load if value is not None), default=None)
    found = [
        ('Duration', bag['duration'], 's'),
        ('Path length', bag['path']['length'] if bag['path'] else None, 'm'),
        ('Highest speed ahead', speed.get('maximum'), 'm/s'),
        ('Largest friction use', max(uses, default=None), ''),
        ('Smallest load', None if least is None else least * 1e-3, 'kN'),
        ('Missed cycles', missed, ''),
        ('Longest latency', None if late is None else late * 1e3, 'ms'),
        ('Events', sum(bag['events']['counts'].values()), ''),
    ]
    return [(name, number(value), unit) for name, value, unit in found]


def _legend(names: list[str], bags: list[dict[str, Any]]) -> list[tuple[str, str]]:
    if len(names) > 1:
        events = ' (at the foot: its events)' if any(bag['events']['list'] for bag in bags) else ''
        return [(colour, name + events) for colour, name in zip(BAG_COLOURS, names, strict=False)]
    kinds = bags[0]['events']['counts']
    wheels = [(colour, wheel.replace('_', ' ')) for colour, wheel in zip(WHEEL_COLOURS, WHEELS, strict=True)]
    wheels = wheels if 'steer_angle' in bags[0]['signals'] or 'side_slip' in bags[0]['signals'] else []
    return wheels + [(colour, f'at the foot: {kind}') for kind, colour in EVENT_COLOURS.items() if kind in kinds]
