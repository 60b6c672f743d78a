import json
import re
import subprocess
import sys
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as numpy_st

from omni_vehicle_ros.analysis import compute_metrics, write_report
from omni_vehicle_ros.analysis.path import plot_path, snapshots
from omni_vehicle_ros.analysis.style import house_style, thinned, to_svg
from omni_vehicle_ros.errors import BagError, RunError
from omni_vehicle_ros.model.kinematics import Icr, road_steer_angles
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.scenarios import load_scenario

VOID = {'meta', 'link', 'br', 'img', 'input', 'hr'}


class Page(HTMLParser):
    """Collects what a page holds, and checks that its tags are closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.ids: list[str] = []
        self.references: list[str] = []
        self.words = ''
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag not in VOID:
            self.open.append(tag)
        for name, value in attributes:
            if name == 'id':
                self.ids.append(value or '')
            if name in ('src', 'href'):
                self.references.append(value or '')
            self.references += re.findall(r'url\(([^)]*)\)', value or '')

    def handle_startendtag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words += data


@pytest.fixture
def run(tmp_path: Path, motion: Callable[..., Any], bag_of: Callable[[Any], Any]) -> Callable[..., Path]:
    """Make the directory of a run; returns it."""

    def make(moved: Any = None, scenario: str = 'simple_turning') -> Path:
        bag = bag_of(moved or motion())
        (tmp_path / 'scenario.yaml').write_text(load_scenario(scenario).as_yaml(), encoding='utf-8')
        (tmp_path / 'metrics.json').write_text(json.dumps(compute_metrics(bag)), encoding='utf-8')
        return tmp_path

    return make


def read(directory: Path) -> str:
    write_report(directory)
    return (directory / 'report.html').read_text(encoding='utf-8')


def test_the_page_is_whole_and_needs_nothing_else(run: Callable[..., Path]) -> None:
    text = read(run())
    page = Page(text)
    assert not page.open
    assert 'http' not in text
    assert page.tags.count('svg') == 10
    assert not {'script', 'link', 'img', 'iframe'} & set(page.tags)
    assert len(page.ids) == len(set(page.ids))
    assert {reference.lstrip('#') for reference in page.references} <= set(page.ids)
    assert len(text) < 1_500_000
    expected = ('simple turning', 'side slip [°]', 'time [s]', 'load [kN]', 'front left', 'x [m]', '10.00', 'nonlinear')
    for words in expected:
        assert words in page.words


def test_the_same_run_gives_the_same_page(run: Callable[..., Path]) -> None:
    directory = run()
    assert read(directory) == read(directory)


@pytest.mark.parametrize('left_out', [
    {'environment/bank', 'environment/wind', 'environment/friction'}, {'driver/speed', 'front_left/command'},
])
def test_a_run_without_a_driver_has_a_report(motion: Any, run: Callable[..., Path], left_out: set[str]) -> None:
    moved = motion()
    moved.topics_left_out = left_out
    assert 'Path from above' in read(run(moved))


def test_a_short_run_at_rest_has_a_report(motion: Any, run: Callable[..., Path]) -> None:
    moved = motion(0.05, 10.0, 0.0)
    text = read(run(moved, 'demo'))
    assert 'No steady state at the end' in text
    assert 'crab 30° to the left' in text
    assert 'nan' not in text.lower().replace('dominant', '')


def test_text_of_a_scenario_is_no_markup(run: Callable[..., Path]) -> None:
    directory = run()
    path = directory / 'scenario.yaml'
    text = path.read_text(encoding='utf-8')
    path.write_text(re.sub(r'name: simple_turning', "name: '<script>alert(1)</script>'", text), encoding='utf-8')
    assert '<script>' not in read(directory)


def test_what_is_missing_is_named(motion: Any, run: Callable[..., Path]) -> None:
    moved = motion()
    moved.topics_left_out = {'imu'}
    directory = run(moved)
    with pytest.raises(BagError, match='imu'):
        write_report(directory)
    (directory / 'metrics.json').unlink()
    with pytest.raises((BagError, RunError)):
        write_report(directory)


def test_loading_the_analysis_does_not_load_matplotlib() -> None:
    code = 'import sys, omni_vehicle_ros.analysis; sys.exit("matplotlib" in sys.modules or "jinja2" in sys.modules)'
    assert subprocess.run([sys.executable, '-c', code], check=False).returncode == 0


def test_drawings_of_the_vehicle_do_not_hide_each_other() -> None:
    angle = np.linspace(0.0, 15.0, 3001)
    x, y = 8.0 * np.sin(angle), 8.0 * (1.0 - np.cos(angle))
    chosen = snapshots(x, y, VehicleParameters())
    assert chosen[-1] == 3000
    assert 4 <= len(chosen) <= 20
    for one in chosen:
        assert all(np.hypot(x[one] - x[other], y[one] - y[other]) > 3.0 for other in chosen if other != one)


def test_the_path_can_be_drawn_alone(motion: Any, bag_of: Callable[[Any], Any]) -> None:
    from matplotlib.figure import Figure

    figure = Figure()
    with house_style():
        plot_path(bag_of(motion()), figure.add_subplot())
        svg = to_svg(figure, 'path')
    assert svg.startswith('<svg')
    assert 'ICR' in svg


@pytest.mark.parametrize('size', [(7.6, 2.4), (7.6, 8.0)])
def test_the_times_beside_a_path_lie_within_its_axes(
    motion: Any, bag_of: Callable[[Any], Any], size: tuple[float, float]
) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=size)
    axes = figure.add_subplot()
    with house_style():
        plot_path(bag_of(motion()), axes)
        figure.draw_without_rendering()
    frame, times = axes.get_window_extent(), [text for text in axes.texts if text.get_text().endswith(' s')]
    assert len(times) > 1
    for text in times:
        box = text.get_window_extent()
        assert frame.contains(box.x0, box.y0)
        assert frame.contains(box.x1, box.y1)
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    assert (right - left) / frame.width == pytest.approx((high - low) / frame.height, rel=1e-9)


@settings(deadline=None, max_examples=50)
@given(numpy_st.arrays(np.float64, st.integers(1, 5000), elements=st.floats(-1e6, 1e6)))
def test_thinning_keeps_the_ends_and_the_extremes(signal: np.ndarray) -> None:
    time = np.arange(len(signal)) * 0.005
    few_time, few = thinned(time, signal)
    assert len(few) <= 1000
    assert (few_time[0], few_time[-1]) == (time[0], time[-1])
    assert (few[0], few[-1]) == (signal[0], signal[-1])
    assert (few.min(), few.max()) == (signal.min(), signal.max())
    assert set(zip(few_time, few, strict=True)) <= set(zip(time, signal, strict=True))


def test_a_turn_past_its_limit_says_up_to_where_it_goes(motion: Any, run: Callable[..., Path]) -> None:
    moved = motion(4.0, 2.0, 4.0)
    moved.icr, moved.steer_angles = (0.0, 2.0), road_steer_angles(Icr(0.0, 2.0), VehicleParameters())
    text = Page(read(run(moved))).words
    assert 'No steady state at the end' in text
    assert 'The limit speed of this turn is 3.254 m/s (fold)' in text
