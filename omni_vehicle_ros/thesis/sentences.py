"""What is seen in a run, in words that several figures share."""

import numpy as np

from omni_vehicle_ros.analysis.signals import StepMetrics
from omni_vehicle_ros.model.kinematics import Icr, road_steer_angles
from omni_vehicle_ros.thesis.tasks import Recording
from omni_vehicle_ros.thesis.words import degrees, listed, number, percent, sentence, wheel_words
from omni_vehicle_ros.wheels import WHEELS

EXACT = 1e-9  # rad


def each_wheel(angles: list[float | None]) -> str:
    """Return an angle of every wheel [rad] as ``front left 1.2°, front right ...``."""
    return listed([f'{wheel_words(wheel)} {degrees(angle)}' for wheel, angle in zip(WHEELS, angles, strict=True)])


def steering(recording: Recording, radius: float) -> str:
    """Return the steer angles at the end of a turn, and how near they are to the closed form (eq. 2.4)."""
    angles = recording.steer_angle[-1].tolist()
    exact = road_steer_angles(Icr(0.0, radius), recording.scenario.vehicle)
    error = float(np.max(np.abs(np.subtract(angles, exact))))
    same = 'as eq. 2.4 says' if error < EXACT else f'{degrees(error)} from what eq. 2.4 says'
    return f'{each_wheel(angles)}, {same} for a turn centre at (0, {number(radius)}) m.'


def steady_turn(recording: Recording) -> str:
    """Return the steady slips of a turn, its largest overshoot and longest settling time, or why there are none."""
    steady = recording.metrics['steady']
    if not steady['reached']:
        return f'No steady state: {steady["reason"]}.'
    steps = [recording.step(wheel) for wheel in range(4)]
    return f'Steady slips: {each_wheel([step.steady_state for step in steps])}. {response(steps)}'


def response(steps: list[StepMetrics]) -> str:
    """Return the largest overshoot and the longest settling time of the four wheels, where there are any."""
    words = []
    overshoots = [
        (step.overshoot, wheel) for step, wheel in zip(steps, WHEELS, strict=True) if step.overshoot is not None
    ]
    settling = [(step.settling_time, wheel) for step, wheel in zip(steps, WHEELS, strict=True) if step.settling_time]
    if overshoots:
        share, wheel = max(overshoots)
        words.append(f'the largest overshoot is {percent(share)} ({wheel_words(wheel)})')
    if settling:
        time, wheel = max(settling)
        words.append(f'the longest settling time {number(time)} s ({wheel_words(wheel)})')
    return sentence(f'{listed(words)}.') if words else ''
