"""Bags into which others than the vehicle have said anything: an error of one line, or figures and plots, all finite."""

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.analysis import compute_metrics
from omni_vehicle_ros.analysis.report import render_report
from omni_vehicle_ros.analysis.plots import draw_plots
from omni_vehicle_ros.analysis.style import house_style, to_svg
from omni_vehicle_ros.analysis.troubles import troubles
from omni_vehicle_ros.bags.memory import MemoryWriter
from omni_vehicle_ros.errors import BagError, MessageError
from omni_vehicle_ros.interface import TOPICS, topic
from omni_vehicle_ros.messages import encode
from omni_vehicle_ros.scenarios import load_scenario

from ..garbage import values

SCENARIO = load_scenario('demo')
RECORDED = [row for row in TOPICS if row.recorded]
strange = st.sampled_from(RECORDED).flatmap(
    lambda row: st.tuples(st.just(row.name), values(row.type), st.integers(0, 150))
)


@pytest.fixture(scope='module')
def said(request) -> list[tuple[str, int, bytes]]:
    from .conftest import Motion
    motion = Motion(1.5)
    return [(name, value.stamp, encode(topic(name).type, value)) for name, value in motion._messages()]


@settings(deadline=None, max_examples=10, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(strange, min_size=1, max_size=4))
def test_strange(said, others):
    writer = MemoryWriter()
    for row in RECORDED:
        writer.add_topic(f'/{row.name}'.replace('//', '/'), row.type, row.qos)
    every = list(said)
    for name, value, at in others:
        try:
            every.append((name, at * 10_000_000, encode(topic(name).type, value)))
        except MessageError:
            pass
    for name, stamp, data in sorted(every, key=lambda one: one[1]):
        writer.write(f'/{name}'.replace('//', '/'), data, stamp)
    bag = writer.bag('strange')
    try:
        metrics = compute_metrics(bag)
        with house_style():
            plots = [{'name': p.name, 'title': p.title, 'text': p.text, 'svg': to_svg(p.figure, p.name)} for p in draw_plots(bag, SCENARIO)]
        render_report(SCENARIO, metrics, plots, troubles(bag))
    except BagError as error:
        assert '\n' not in str(error)
    else:
        json.dumps(metrics, allow_nan=False)
