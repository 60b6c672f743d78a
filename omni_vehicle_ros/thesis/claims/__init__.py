"""The claims of the thesis, each judged by code from figures that it prints."""

from omni_vehicle_ros.thesis.claims import disturbances, roll_and_drive, side_slip_control, traction, turning, vehicle

CLAIMS = (
    *vehicle.CLAIMS,
    *turning.CLAIMS,
    *traction.CLAIMS,
    *disturbances.CLAIMS,
    *roll_and_drive.CLAIMS,
    *side_slip_control.CLAIMS,
)
"""In the order of their numbers."""
