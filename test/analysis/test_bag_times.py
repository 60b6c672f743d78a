"""Bags whose stamps are missing or go back, events of several bags, and a report that does not fit on the disk."""

import resource
from pathlib import Path

import pytest

from omni_vehicle_ros import messages
from omni_vehicle_ros.analysis.bags.analysis import analyse, read_subjects
from omni_vehicle_ros.analysis.bags.marks import BAG_COLOURS, mark_events
from omni_vehicle_ros.analysis.bags.report import write_analysis
from omni_vehicle_ros.analysis.plots import stacked_axes
from omni_vehicle_ros.bags import BagWriter
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.interface import topic
from omni_vehicle_ros.messages import Odometry

MS = 1_000_000
EPOCH = 1_700_000_000_000 * MS


def write(directory: Path, times: list[tuple[int, int]]) -> Path:
    """Write odom with these stamps and log times [ns]."""
    row = topic('odom')
    with BagWriter(directory) as writer:
        writer.add_topic('/odom', row.type, row.qos)
        for number, (stamp, log_time) in enumerate(times):
            value = Odometry(stamp, 0.01 * number, 0.0, 0.0, 1.0, 0.0, 0.0)
            writer.write('/odom', messages.encode(row.type, value), log_time)
    return directory


def test_without_stamps_the_log_times_count(tmp_path: Path) -> None:
    path = write(tmp_path / 'bag', [(0, EPOCH + k * 10 * MS) for k in range(101)])
    (bag,) = analyse(read_subjects([path])).metrics['bags']
    assert (bag['begin'], bag['duration']) == (pytest.approx(EPOCH * 1e-9), pytest.approx(1.0))
    assert bag['timing']['/odom']['period'] == pytest.approx(0.01)
    assert bag['timing']['/odom']['latency'] is None


def test_stamps_that_go_back_are_said(tmp_path: Path) -> None:
    times = [((k if k < 50 else k - 70) * 10 * MS + EPOCH, k * 10 * MS + EPOCH) for k in range(100)]
    found = analyse(read_subjects([write(tmp_path / 'bag', times)]))
    (bag,) = found.metrics['bags']
    assert (bag['begin'], bag['duration']) == (pytest.approx(EPOCH * 1e-9 - 0.2), pytest.approx(0.69))
    write_analysis(found, tmp_path)
    assert 'Stamps go back on /odom (1 times)' in (tmp_path / 'report.html').read_text(encoding='utf-8')


def test_a_full_disk_leaves_no_half_of_a_report(tmp_path: Path) -> None:
    found = analyse(read_subjects([write(tmp_path / 'bag', [(k * 10 * MS, k * 10 * MS) for k in range(20)])]))
    (tmp_path / 'out').mkdir()
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (8_000, limit[1]))
    try:
        with pytest.raises(RunError, match=r'/out: File too large$'):
            write_analysis(found, tmp_path / 'out')
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert not list((tmp_path / 'out').iterdir())


def test_of_several_bags_each_has_its_events_in_its_colour(tmp_path: Path) -> None:
    every = [(k * 10 * MS, k * 10 * MS) for k in range(600)]
    paths = [write(tmp_path / 'one', every[:100] + every[103:]), write(tmp_path / 'two', every[:400] + every[405:])]
    found = analyse(read_subjects(paths))
    figure, (axes,) = stacked_axes('x')
    mark_events(figure, found.surveys)
    marks = {patch.get_facecolor(): patch.get_bbox().extents[[0, 2]].tolist() for patch in axes.patches}
    assert list(marks.values()) == [pytest.approx([0.99, 1.03]), pytest.approx([3.99, 4.05])]
    assert len({patch.get_bbox().y0 for patch in axes.patches}) == 2
    write_analysis(found, tmp_path)
    page = (tmp_path / 'report.html').read_text(encoding='utf-8')
    assert f'background: {BAG_COLOURS[1]}"></span>two (at the foot: its events)' in page
