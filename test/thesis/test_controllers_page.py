"""The page that compares the controllers is what the code computes, and holds what it promises of allocation."""

from pathlib import Path

import pytest

from omni_vehicle_ros.thesis.bounds import SlipBound
from omni_vehicle_ros.thesis.controllers_page import TASKS, write_controllers_page
from omni_vehicle_ros.thesis.manoeuvres import CONTROLLERS, MANOEUVRES, Judgement, Trial
from omni_vehicle_ros.thesis.tasks import Results, work_on
from omni_vehicle_ros.thesis.trade_off import RADIUS, SPEED
from omni_vehicle_ros.workers import Workers

PAGE = Path(__file__).resolve().parents[2] / 'docs' / 'controllers.md'
pytestmark = pytest.mark.slow


@pytest.fixture(scope='module')
def results() -> Results:
    with Workers() as workers:
        return work_on(workers, TASKS)


def judgements(results: Results, manoeuvre: int) -> dict[str, Judgement]:
    return {controller.name: results[Trial(MANOEUVRES[manoeuvre], controller)] for controller in CONTROLLERS}


def test_the_page_is_what_the_code_computes(results: Results, tmp_path: Path) -> None:
    write_controllers_page(results, tmp_path)
    found = (tmp_path / 'controllers.md').read_text(encoding='utf-8')
    assert PAGE.read_text(encoding='utf-8') == found, 'run: python scripts/make_thesis_docs.py'


def test_allocation_reaches_both_bounds_on_the_path(results: Results) -> None:
    """Worst slip within 5 % of the least one, radius within 2 % of the commanded one."""
    turn = judgements(results, 0)
    for name, traction in (('allocation, steering', 'alike'), ('allocation, all', 'left and right')):
        assert turn[name].worst_slip < 1.05 * results[SlipBound(RADIUS, SPEED, traction)].worst
        assert turn[name].radius == pytest.approx(RADIUS, rel=0.02)


def test_what_the_page_says_in_words(results: Results) -> None:
    """Allocation stays nearest to the path, and pays for it in slip where grip is short and steps are sharp."""
    for manoeuvre in (0, 1, 2):
        found = judgements(results, manoeuvre)
        nearest = min(found, key=lambda name: found[name].path_error)
        assert nearest.startswith('allocation')
    gust = judgements(results, 3)
    assert gust['allocation, all'].worst_slip == pytest.approx(gust['allocation, steering'].worst_slip, rel=1e-3)
    assert gust['wheel slip (5,5,0,0)'].worst_slip > gust['none'].worst_slip < gust['wheel slip (5,1,0,0)'].worst_slip
    assert gust['yaw moment'].worst_slip < gust['allocation, steering'].worst_slip
    for manoeuvre in (1, 2):
        found = judgements(results, manoeuvre)
        assert max(found, key=lambda name: found[name].worst_slip).startswith('allocation')
