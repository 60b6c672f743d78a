"""Write msg_docs/ from the wiring table, omni_vehicle_ros/interface.py."""

import sys
from pathlib import Path

from omni_vehicle_ros.interface import RECORDER, TOPICS, Topic
from omni_vehicle_ros.wheels import WHEELS

INTRODUCTION = """# Topics

One page a topic, made by `scripts/make_msg_docs.py` from the wiring table `omni_vehicle_ros/interface.py`.
Names are relative to the namespace of the vehicle, except those that begin with `/`. Values are SI and rad,
frames as in REP-103, wheels in the order front left, front right, rear left, rear right.

| topic | type | what it says |
| --- | --- | --- |
"""


def pages() -> dict[str, str]:
    """Return the text of every file in msg_docs, by name; the four wheels share one page."""
    rows = [row for row in TOPICS if not row.name.startswith(tuple(WHEELS[1:]))]
    found = {page_name(row): page(row) for row in rows}
    lines = [f'| [{_shown(row)}]({page_name(row)}) | `{row.type}` | {_general(row.text)} |' for row in rows]
    found['README.md'] = INTRODUCTION + '\n'.join(lines) + '\n'
    return found


def page_name(row: Topic) -> str:
    """Return the file name of a topic's page."""
    return _general(row.name.strip('/')).replace('<', '').replace('>', '').replace('/', '_') + '.md'


def page(row: Topic) -> str:
    """Return the page of a topic."""
    readers = [*row.subscribers, *([RECORDER] if row.recorded and RECORDER not in row.subscribers else [])]
    qos = f'reliable, {"transient local" if row.qos.latched else "volatile"}, keep last {row.qos.depth}'
    facts = [
        ('type', f'`{row.type}`'),
        ('frame', f'`{row.frame}`' if row.frame else 'none'),
        ('quality of service', qos),
        ('published by', _names(row.publishers)),
        ('read by', _names(readers) or 'whoever wants to know'),
        ('how often', 'once in every control cycle (5 ms)' if row.cyclic else 'when there is something to say'),
        ('in the bag', 'yes' if row.recorded else 'no'),
    ]
    fields = '\n'.join(f'| `{_general(name)}` | {_general(text)} |' for name, text in row.fields)
    table = '\n'.join(f'| {name} | {value} |' for name, value in facts)
    return (
        f'# {_shown(row)}\n\n{_general(row.text)}\n\n| | |\n| --- | --- |\n{table}\n\n'
        f'| field | meaning |\n| --- | --- |\n{fields}\n\n```sh\n{_command(row)}\n```\n'
    )


def _command(row: Topic) -> str:
    if row.example:
        rate = '--once' if row.qos.latched else '--rate 10'
        return f'ros2 topic pub {rate} {row.name} {row.type} "{row.example}"'
    return f'ros2 topic echo {row.name}'


def _shown(row: Topic) -> str:
    return _general(row.name).replace('<', '\\<').replace('>', '\\>')


def _general(text: str) -> str:
    """Say ``<wheel>`` for the front left wheel."""
    return (
        text.replace('front_left_', '<wheel>_')
        .replace('front_left/', '<wheel>/')
        .replace('the front left wheel', 'the wheel')
    )


def _names(nodes: tuple[str, ...] | list[str]) -> str:
    general = dict.fromkeys(_general(node) if node.startswith('front_left/') else node for node in nodes)
    shown = [node for node in general if not node.startswith(tuple(WHEELS))]
    return ', '.join(f'`{node}`' for node in shown)


def main() -> None:
    """Write the pages into a directory, msg_docs by default."""
    directory = Path(sys.argv[1] if len(sys.argv) > 1 else 'msg_docs')
    directory.mkdir(exist_ok=True)
    for name, text in pages().items():
        (directory / name).write_text(text, encoding='utf-8')


if __name__ == '__main__':
    main()
