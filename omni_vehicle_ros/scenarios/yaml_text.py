"""YAML as people expect it: the core schema of YAML 1.2, no aliases, no repeated keys, errors in one line.

PyYAML follows YAML 1.1, where ``1e5`` is a word, ``on`` is true, ``010`` is 8 and ``1:30`` is 90. Here these
are a number, a word, the number 10 and a word.
"""

import re
from typing import Any

import yaml

from omni_vehicle_ros.errors import ScenarioError

_TAG = 'tag:yaml.org,2002:'
_LONGEST_INTEGER = 18
_RULES = (
    ('bool', r'true|True|TRUE|false|False|FALSE', 'tTfF'),
    ('null', r'~|null|Null|NULL|', ('~', 'n', 'N', '')),
    ('int', rf'[-+]?[0-9]{{1,{_LONGEST_INTEGER}}}', '-+0123456789'),
    (
        'float',
        r'[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)',
        '-+.0123456789',
    ),
)


class _Loader(yaml.SafeLoader):
    """A safe loader for plain trees of mappings, lists and scalars."""

    yaml_implicit_resolvers: dict[str, list[Any]] = {}  # noqa: RUF012 (PyYAML's own, per class)

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.AliasEvent):
            raise _problem('aliases are not allowed', self.peek_event())  # type: ignore[no-untyped-call]
        return super().compose_node(parent, index)

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        seen = set()
        for key, _ in node.value:
            if key.tag != f'{_TAG}str':
                raise _problem('a key must be a word', key)
            if key.value in seen:
                raise _problem(f'{key.value!r} is there twice', key)
            seen.add(key.value)
        mapping: dict[Any, Any] = super().construct_mapping(node, deep)
        return mapping

    def construct_decimal(self, node: Any) -> int:
        return int(node.value)


class _Dumper(yaml.SafeDumper):
    """A safe dumper whose plain scalars the loader reads back as what they were."""

    yaml_implicit_resolvers: dict[str, list[Any]] = {}  # noqa: RUF012 (PyYAML's own, per class)

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _problem(text: str, place: Any) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=text, problem_mark=place.start_mark)


for _kind, _pattern, _first in _RULES:
    for _class in (_Loader, _Dumper):
        _class.add_implicit_resolver(f'{_TAG}{_kind}', re.compile(rf'^(?:{_pattern})$'), list(_first))
_Loader.add_constructor(f'{_TAG}int', _Loader.construct_decimal)


def parse(text: str | bytes) -> Any:
    """Read one YAML document.

    Parameters
    ----------
    text
        The document; bytes are UTF-8 (or UTF-16 with a byte order mark).

    Returns
    -------
    Any
        A tree of dict (keys are str), list, str, bool, int, float and None. A whole number of more than 18
        digits is a float.

    Raises
    ------
    ScenarioError
        The document is malformed: one line with the place and the problem.
    """
    try:
        return yaml.load(text, Loader=_Loader)
    except (yaml.reader.ReaderError, UnicodeDecodeError) as error:
        words = 'is not a text file; YAML is UTF-8' if isinstance(text, bytes) else ' '.join(str(error).split())
        raise ScenarioError(words) from None
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f'line {mark.line + 1}, column {mark.column + 1}: ' if mark else ''
        raise ScenarioError(f'{place}{error.problem or error.context}') from None
    except (yaml.YAMLError, ValueError) as error:
        raise ScenarioError(' '.join(str(error).split())) from None
    except RecursionError:
        raise ScenarioError('nested too deeply') from None


def dump(tree: Any) -> str:
    """Write a tree of dict, list, str, bool, int, float and None as YAML that `parse` reads back equal."""
    text: str = yaml.dump(tree, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=110, default_flow_style=None)
    return text
