"""docs/safety.md says what the vehicle does today."""

from pathlib import Path

from omni_vehicle_ros.scenarios import scenario_names

from .test_msg_docs import script

PAGE = Path(__file__).resolve().parents[2] / 'docs' / 'safety.md'


def test_the_figures_are_those_of_today() -> None:
    """One row, driven anew; and there is one for each scenario of faults."""
    names = [name.partition('/')[2] for name in scenario_names() if name.startswith('faults/')]
    text = PAGE.read_text(encoding='utf-8')
    rows = text.partition('<!-- figures: begin -->')[2].partition('<!-- figures: end -->')[0].strip().splitlines()[2:]
    assert [row.split(' | ')[0].removeprefix('| ') for row in rows] == names
    again = script('make_safety_docs').row('faults/module_killed')
    assert again in rows, 'run: python scripts/make_safety_docs.py'
