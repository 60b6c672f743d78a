"""Metrics, plots and the report of a run, made from its bag; no ROS."""

from omni_vehicle_ros.analysis.metrics import compute_metrics
from omni_vehicle_ros.analysis.report import write_report

__all__ = ['compute_metrics', 'write_report']
