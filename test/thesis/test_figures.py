"""The registry of figures, what a figure becomes, and the command that makes it."""

import csv
import math
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

from omni_vehicle_ros.analysis.style import house_style
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.thesis.bounds import Bound
from omni_vehicle_ros.thesis.chart import Chart, Line
from omni_vehicle_ros.thesis.figure import Picture, ThesisFigure
from omni_vehicle_ros.thesis.files import draw, write_table
from omni_vehicle_ros.thesis.manoeuvres import CONTROLLERS, Judgement, Trial
from omni_vehicle_ros.thesis.registry import CHAPTERS, FIGURES, SECTIONS, chosen
from omni_vehicle_ros.thesis.tasks import Results, Run
from omni_vehicle_ros.thesis.trade_off import GAINS, GainCurve
from omni_vehicle_ros.thesis.words import listed, number, percent

NUMBERED = re.compile(r'\d+\.\d+')
DIAGRAMS = ('5.1', '5.2')


def thesis(path: Path, *arguments: str) -> 'subprocess.CompletedProcess[str]':
    command = [sys.executable, '-m', 'omni_vehicle_ros.executables', 'cli', 'thesis', *arguments]
    return subprocess.run(command, cwd=path, capture_output=True, text=True, timeout=300, check=False)


def say_finite_numbers(sentence: str) -> bool:
    return bool(re.search(r'\d', sentence)) and not re.search(r'\b(nan|inf|None)\b', sentence)


def test_every_figure_of_the_thesis_is_there_once() -> None:
    numbers = [figure.number for section in SECTIONS for figure in section.figures]
    expected = [f'4.{i}' for i in range(1, 55)] + [f'5.{i}' for i in range(1, 14)]
    assert [number for number in numbers if NUMBERED.fullmatch(number)] == expected
    assert len(set(numbers)) == len(numbers)


def test_captions_say_what_differs() -> None:
    captions = [figure.caption for figure in FIGURES.values()]
    assert all(captions)
    # The same steer angles are drawn twice for the same turn, as in the thesis.
    assert len(set(captions)) >= len(captions) - 1


def test_every_run_of_a_figure_can_be_loaded() -> None:
    runs = {task for figure in FIGURES.values() for task in figure.needs if isinstance(task, Run)}
    assert len(runs) > 30
    for task in runs:
        assert task.load().duration > 0.0


def test_figures_are_chosen_by_number_or_chapter() -> None:
    assert [figure.number for figure in chosen('4.15')] == ['4.15']
    assert len(chosen()) == len(FIGURES)
    for chapter in CHAPTERS:
        numbers = [figure.number for figure in chosen(chapter=chapter)]
        assert {number.split('.')[0] for number in numbers if NUMBERED.fullmatch(number)} == {chapter}
    with pytest.raises(RunError, match=r'4\.55'):
        chosen('4.55')
    with pytest.raises(RunError, match="'6' is not one of 4, 5"):
        chosen(chapter='6')
    with pytest.raises(RunError, match='one of them'):
        chosen('4.15', '4')


def test_a_picture_and_its_table_show_the_same(tmp_path: Path) -> None:
    x = np.linspace(0.0, 2.0, 5)
    lines = (Line('one', x**2, '#000000'), Line('gap', np.where(x > 1.0, x, np.nan), '#000000'))
    chart = Chart(lines, x, 'side slip [deg]', difference=True)
    shown = draw(ThesisFigure('9.1', 'Test', lambda results: chart.picture('seen')), Results({}), tmp_path)
    assert shown.has_table
    with (tmp_path / '9.1.csv').open(encoding='utf-8') as file:
        header, *rows = csv.reader(file)
    assert header == ['time [s]', 'one: side slip [deg]', 'gap: side slip [deg]']
    assert_allclose([float(row[1]) for row in rows], x**2)
    assert [row[2] for row in rows] == ['', '', '', '1.5', '2']
    root = ElementTree.parse(tmp_path / '9.1.svg').getroot()
    assert root.findtext('{*}title') == 'Fig. 9.1 \u00b7 Test'
    assert 'Fig. 9.1' in [''.join(text.itertext()).strip() for text in root.iter('{http://www.w3.org/2000/svg}text')]


def test_a_figure_that_is_not_in_the_thesis_has_its_caption_for_a_title(tmp_path: Path) -> None:
    x = np.linspace(0.0, 1.0, 3)
    chart = Chart((Line('one', x, '#000000'),), x, 'side slip [deg]')
    draw(ThesisFigure('beyond', 'Seen from afar', lambda results: chart.picture('seen')), Results({}), tmp_path)
    root = ElementTree.parse(tmp_path / 'beyond.svg').getroot()
    assert root.findtext('{*}title') == 'Seen from afar'


def test_a_chart_draws_every_line_and_their_difference() -> None:
    x = np.linspace(0.0, 1.0, 11)
    chart = Chart((Line('a', 3.0 * x, '#000000'), Line('b', x, '#000000')), x, 'side slip [deg]', difference=True)
    upper, lower = chart.draw().axes
    assert [entry.get_label() for entry in upper.lines] == ['a', 'b']
    assert_allclose(lower.lines[0].get_ydata(), 2.0 * x)
    assert lower.get_ylabel() == 'difference [°]'


def test_no_number_of_a_table_is_minus_zero(tmp_path: Path) -> None:
    write_table(Picture(Figure(), 'seen', {'slip [deg]': np.array([-0.0, 0.0, -1e-3, math.nan])}), tmp_path / 'x.csv')
    assert (tmp_path / 'x.csv').read_text(encoding='utf-8').splitlines() == ['slip [deg]', '0', '0', '-0.001', '""']


def test_the_caption_of_the_controllers_stands_alone(tmp_path: Path) -> None:
    """It is below everything else in the saved picture, the legend with its two rows included."""
    figure = FIGURES['controllers']
    draw(figure, Results(dict.fromkeys(figure.needs, Judgement(0.05, 0.04, 1.0, 5.5, 0.1, 0.6))), tmp_path)
    root = ElementTree.parse(tmp_path / 'controllers.svg').getroot()
    heights = {}
    for text in root.iter('{http://www.w3.org/2000/svg}text'):
        place = text.get('y') or re.findall(r'[-\d.]+', text.get('transform') or '')[1]
        heights[''.join(text.itertext()).strip()] = float(place)
    below = heights.pop(figure.caption) - max(heights.values())
    assert CONTROLLERS[1].name in heights
    assert below > 9.0  # points: more than a line of its type


def test_a_slip_that_has_not_settled_is_said_to_change() -> None:
    """At 80 km/h the rear tyres still change by a little more than 2 % before the bank ends, the front ones don't."""
    figure = FIGURES['4.21']
    (task,) = figure.needs
    with house_style():
        words = figure.draw(Results({task: task.work()})).sentence
    _, changing = words.split('still changes at ')
    shares = dict(re.findall(r'(\w+ \w+) by ([\d.]+)', changing.replace('and ', '')))
    assert sorted(shares) == ['rear left', 'rear right']
    assert all(2.0 < float(share) < 2.1 for share in shares.values())


def test_the_data_of_the_trade_off_hold_all_that_is_drawn() -> None:
    judgement = Judgement(0.05, 0.04, 1.0, 5.5, 0.1, 0.6)
    curve = np.column_stack((GAINS, np.linspace(0.0, 0.5, len(GAINS)), np.linspace(0.06, 0.03, len(GAINS))))
    found = {
        task: judgement if isinstance(task, Trial)
        else curve if isinstance(task, GainCurve)
        else Bound(0.04, (0.04,) * 4, (0.0,) * 4, 0.5)
        for task in FIGURES['trade_off'].needs
    }
    with house_style():
        picture = FIGURES['trade_off'].draw(Results(found))
    _, _, error, slip = picture.table.values()
    (axes,) = picture.figure.axes
    rows = set(zip(error.tolist(), slip.tolist(), strict=True))
    upright, level = axes.get_xaxis_transform(), axes.get_yaxis_transform()
    for drawn in axes.lines:
        x, y = drawn.get_data()
        if drawn.get_transform() == level:
            assert (0.0, y[0]) in rows
        elif drawn.get_transform() != upright:
            assert set(zip(x, y, strict=True)) <= rows
    assert len(axes.lines) == 2 * 2 + 2 + len(CONTROLLERS) + 1


@pytest.mark.parametrize('name', DIAGRAMS)
def test_diagrams_have_no_data(name: str, tmp_path: Path) -> None:
    shown = draw(FIGURES[name], Results({}), tmp_path)
    assert say_finite_numbers(shown.sentence)
    assert not shown.has_table
    assert [path.name for path in tmp_path.iterdir()] == [f'{name}.svg']


def test_the_force_coefficient_is_that_of_the_vehicle(tmp_path: Path) -> None:
    with house_style():
        picture: Picture = FIGURES['4.25'].draw(Results({}))
    angle, value = picture.table['airflow angle [deg]'], picture.table['Cy [1]']
    assert np.interp(math.degrees(0.3455), angle, value) == pytest.approx(0.58, rel=1e-2)
    assert say_finite_numbers(picture.sentence)


def test_numbers_are_said_with_few_digits() -> None:
    assert [number(value) for value in (0.0, 1e-9, 3.14159, -0.0012345, 1234.5, None, math.nan)] == [
        '0', '0', '3.14', '\u22120.00123', '1230', '\u2013', '\u2013',
    ]  # fmt: skip
    assert [percent(share) for share in (0.1234, 1e-4)] == ['12\u00a0%', '0\u00a0%']
    assert listed(['a']) == 'a'
    assert listed(['a', 'b', 'c']) == 'a, b and c'


def test_the_command_draws_one_figure(tmp_path: Path) -> None:
    done = thesis(tmp_path, '--figure', '4.33', '--out', 'out')
    assert done.returncode == 0, done.stderr
    assert 'out/index.html' in done.stdout
    assert sorted(path.relative_to(tmp_path / 'out').as_posix() for path in (tmp_path / 'out').rglob('*.*')) == [
        'figures/4.33.csv', 'figures/4.33.svg', 'index.html',
    ]  # fmt: skip
    with (tmp_path / 'out' / 'figures' / '4.33.csv').open(encoding='utf-8') as file:
        header, *rows = csv.reader(file)
    assert header[0] == 'time [s]'
    assert len(rows) > 1000
    assert float(rows[-1][1]) == pytest.approx(math.degrees(math.atan2(1.0, 10.0 - 0.718)), rel=1e-5)
    page = (tmp_path / 'out' / 'index.html').read_text(encoding='utf-8')
    assert page.count('<figure ') == 1
    assert 'figures/4.33.svg' in page
    assert 'Claims' not in page


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        (('--figure', '4.55'), '4.55'),
        (('--figure', '4.25', '--out', 'there'), 'there: exists already'),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    (tmp_path / 'there').mkdir()
    done = thesis(tmp_path, *arguments)
    assert done.returncode == 2
    assert words in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert [path.name for path in tmp_path.iterdir()] == ['there']
