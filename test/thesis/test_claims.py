"""How claims are judged, and that the page in docs/ is what the code computes."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from omni_vehicle_ros.thesis.claims import CLAIMS
from omni_vehicle_ros.thesis.claims.claim import DEPENDS, NOT_REPRODUCED, REPRODUCED, Fact, Part, Verdict, fact
from omni_vehicle_ros.thesis.files import draw
from omni_vehicle_ros.thesis.pages import Judged, claims_page, judge
from omni_vehicle_ros.thesis.registry import FIGURES
from omni_vehicle_ros.thesis.reproduce import claim_tasks
from omni_vehicle_ros.thesis.slip_maps import turnover
from omni_vehicle_ros.thesis.steady import SlipMap
from omni_vehicle_ros.thesis.tasks import Results, work_on
from omni_vehicle_ros.workers import Workers

DOCS = Path(__file__).parents[2] / 'docs' / 'thesis_claims.md'
PARTS = st.lists(st.tuples(st.booleans(), st.booleans()), min_size=1, max_size=5)


@given(PARTS)
def test_a_verdict_follows_from_the_parts(parts: list[tuple[bool, bool]]) -> None:
    verdict = Verdict(tuple(Part(f'part {i}', holds, '', reading) for i, (holds, reading) in enumerate(parts)), ())
    if all(holds for holds, _ in parts):
        assert verdict.word == str(verdict) == REPRODUCED
        return
    failing = [reading for holds, reading in parts if not holds]
    if all(failing) and any(holds for holds, _ in parts):
        assert verdict.word == DEPENDS
    else:
        assert verdict.word == NOT_REPRODUCED
    assert f'no for part {[holds for holds, _ in parts].index(False)}' in str(verdict)
    assert ('yes for' in str(verdict)) is any(holds for holds, _ in parts)


def test_facts_in_words() -> None:
    assert str(fact('slip', -1.2345, '°')) == 'slip: \u22121.23°'
    assert str(fact('speed', 0.0, 'm/s')) == 'speed: 0\u00a0m/s'
    assert str(fact('limit', None, 'km/h', 'at 2 m')) == 'limit \u2013\u00a0km/h'


def test_facts_of_a_group_share_a_line() -> None:
    facts = (
        fact('turns', 3.0),
        Fact('slip', (1.0, 2.0), '°', 'front left'),
        fact('share', 5.0, '%', 'front left'),
        fact('slip', 4.0, '°', 'rear left'),
        fact('centre', 0.7, 'm'),
        fact('limit', 6.0, 'm/s'),
    )
    assert Verdict((), facts).figures == [
        'turns: 3', 'front left: slip 1 → 2°, share 5\u00a0%', 'rear left: slip 4°', 'centre: 0.7\u00a0m',
        'limit: 6\u00a0m/s',
    ]  # fmt: skip


def test_all_seventeen_claims_are_there() -> None:
    assert [claim.number for claim in CLAIMS] == list(range(1, 18))
    assert all(claim.needs for claim in CLAIMS)


def test_where_slips_begin_to_fall_with_the_speed() -> None:
    """Slips v^2 / R, but those of the rear left tyre fall from 0.5 R on, and one turn ends before."""
    radius, speed = np.array([4.0, 6.0, 8.0]), np.arange(0.5, 4.0, 0.25)
    slip = np.repeat(speed**2 / radius[:, np.newaxis], 4, axis=1).reshape(3, -1, 4)
    slip[:, :, 2] = 1.0 - np.abs(speed - 0.5 * radius[:, np.newaxis]) / radius[:, np.newaxis]
    slip[0, speed > 1.5] = np.nan
    found = SlipMap(radius, speed, slip, np.full(3, 4.0), np.empty((3, 0)), np.empty((3, 0, 4)))
    assert turnover(found) == (6.0, 3.0, 2)
    assert turnover(found._replace(side_slip=slip[:1])) is None


@pytest.fixture(scope='module')
def results() -> Results:
    """Return what the claims need: half a minute on two cores."""
    with Workers() as workers:
        return work_on(workers, claim_tasks())


@pytest.fixture(scope='module')
def judged(results: Results) -> Judged:
    return judge(results)


@pytest.mark.slow
def test_the_page_is_what_the_code_computes(judged: Judged) -> None:
    assert DOCS.read_text(encoding='utf-8') == claims_page(judged), 'run: python scripts/make_thesis_docs.py'


@pytest.mark.slow
def test_every_verdict_has_figures_and_says_why(judged: Judged) -> None:
    assert sum(judged.counts.values()) == 17
    for claim, verdict in judged.claims:
        assert verdict.facts, claim.number
        assert all(value is not None and abs(value) < 1e6 for entry in verdict.facts for value in entry.values)
        assert all(part.why for part in verdict.parts), claim.number
        assert len(set(verdict.figures)) == len(verdict.figures), claim.number
        assert max(map(len, verdict.figures)) < 160, claim.number


@pytest.mark.slow
def test_figures_that_need_no_more_can_be_drawn(results: Results, tmp_path: Path) -> None:
    """Two thirds of all figures, with a sentence of finite numbers each."""
    known = set(claim_tasks())
    figures = [figure for figure in FIGURES.values() if figure.needs and known.issuperset(figure.needs)]
    assert len(figures) > 40
    for figure in figures[::4]:
        shown = draw(figure, results, tmp_path)
        assert any(character.isdigit() for character in shown.sentence), figure.number
        assert 'nan' not in shown.sentence, figure.number
