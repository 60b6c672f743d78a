"""The pages of a reproduction: the index of all figures, and the table of claims."""

import json
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import jinja2

from omni_vehicle_ros import __version__
from omni_vehicle_ros.thesis import limits
from omni_vehicle_ros.thesis.claims import CLAIMS
from omni_vehicle_ros.thesis.claims.claim import WORDS, Claim, Verdict
from omni_vehicle_ros.thesis.figure import Section
from omni_vehicle_ros.thesis.files import Shown
from omni_vehicle_ros.thesis.registry import CHAPTERS, SECTIONS
from omni_vehicle_ros.thesis.tasks import Results


class Judged(NamedTuple):
    """What is said about the claims: each with its verdict, and the limit speeds."""

    claims: Sequence[tuple[Claim, Verdict]]
    limits: Sequence[limits.LimitRow]

    @property
    def counts(self) -> dict[str, int]:
        """How many claims got each of the three words."""
        words = [verdict.word for _, verdict in self.claims]
        return {word: words.count(word) for word in WORDS}


def judge(results: Results) -> Judged:
    """Judge all claims."""
    return Judged([(claim, claim.judge(results)) for claim in CLAIMS], limits.rows(results))


def index_page(shown: Mapping[str, Shown], judged: Judged | None) -> str:
    """Return index.html.

    Parameters
    ----------
    shown
        What was drawn, by number.
    judged
        The claims, if they were judged.
    """
    sections = [(section, _there(section, shown)) for section in SECTIONS]
    there = [pair for pair in sections if pair[1]]
    return render('index.html.j2', sections=there, judged=judged, chapters=CHAPTERS, frictions=limits.FRICTIONS)


def _there(section: Section, shown: Mapping[str, Shown]) -> list[tuple[str, str, Shown]]:
    return [
        (figure.number, figure.caption, shown[figure.number]) for figure in section.figures if figure.number in shown
    ]


def claims_page(judged: Judged) -> str:
    """Return the table of claims as Markdown."""
    return render('claims.md.j2', judged=judged, frictions=limits.FRICTIONS)


def claims_data(judged: Judged) -> str:
    """Return the claims as JSON."""
    tree = [
        {
            'number': claim.number,
            'claim': claim.text,
            'where': claim.where,
            'verdict': verdict.word,
            'parts': [part._asdict() for part in verdict.parts],
            'figures': [fact._asdict() for fact in verdict.facts],
        }
        for claim, verdict in judged.claims
    ]
    return json.dumps(tree, indent=2, ensure_ascii=False, allow_nan=False) + '\n'


def render(template: str, **values: Any) -> str:
    """Return a page made from a template of this package, which also knows the ``version``."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader('omni_vehicle_ros.thesis'),
        autoescape=jinja2.select_autoescape(('html.j2',)),
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
    )
    return environment.get_template(template).render(version=__version__, **values)
