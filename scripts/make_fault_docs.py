"""Write the tables of docs/faults.md from the vocabulary, omni_vehicle_ros/faults.py."""

from pathlib import Path

from omni_vehicle_ros.faults import CARRIERS, KINDS, PROCESSES, Failure, kind_of
from omni_vehicle_ros.wheels import WHEELS

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'faults.md'
BEGIN, END = '<!-- vocabulary: begin -->', '<!-- vocabulary: end -->'
HEAD = '| failure | value | default | what happens |\n| --- | --- | --- | --- |'


def tables() -> str:
    """Return a heading and a table for each kind of component."""
    return '\n\n'.join(f'### {_names(kind)}\n\n{_parameters(kind)}\n\n{_table(known)}' for kind, known in KINDS.items())


def _names(kind: str) -> str:
    components = [component for component in CARRIERS if kind_of(component) == kind]
    general = dict.fromkeys(_general(component) for component in components)
    return '`messages/<topic>`' if kind == 'messages' else ', '.join(f'`{name}`' for name in general)


def _parameters(kind: str) -> str:
    """Say which nodes have the parameters."""
    if kind == 'messages':
        topics = dict.fromkeys(_general(name.partition('/')[2]) for name in CARRIERS if kind_of(name) == kind)
        names = ', '.join(f'`{name}`' for name in topics)
        return f'At those who act on them; each has the parameter. Topics: {names}.'
    if kind == 'process':
        nodes = dict.fromkeys(f'`{_general(node)}`' for node in PROCESSES.values())
        return f'Parameter of the node itself: {", ".join(nodes)}.'
    (node,) = {_general(node) for name, nodes in CARRIERS.items() if kind_of(name) == kind for node in nodes}
    return f'Parameter of `{node}`.'


def _general(name: str) -> str:
    for wheel in WHEELS:
        name = name.replace(f'{wheel}/', '<wheel>/')
    return name


def _table(known: dict[str, Failure]) -> str:
    rows = [f'| `{name}` | {_value(entry)} | {_default(entry)} | {entry.text} |' for name, entry in known.items()]
    return '\n'.join([HEAD, *rows])


def _value(failure: Failure) -> str:
    if failure.default is None:
        return ''
    return f'{failure.low:g} .. {failure.high:g} {failure.unit}'.rstrip()


def _default(failure: Failure) -> str:
    return '' if failure.default is None else f'{failure.default:g} {failure.unit}'.rstrip()


def page(text: str) -> str:
    """Return the text of the page with the tables of today between its marks."""
    before, _, rest = text.partition(BEGIN)
    return f'{before}{BEGIN}\n{tables()}\n{END}{rest.partition(END)[2]}'


def main() -> None:
    """Put the tables between the marks of the page."""
    PAGE.write_text(page(PAGE.read_text(encoding='utf-8')), encoding='utf-8')


if __name__ == '__main__':
    main()
