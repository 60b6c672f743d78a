"""The figures of a run, from its bag: what ``metrics.json`` holds.

A vehicle is in a steady state at the end if its yaw rate and its lateral speed have settled (see
`omni_vehicle_ros.analysis.signals.steady_state`) and no axle slides: an axle slides when both its tyres are
past their second critical slip, where more slip gives less force. With a forced forward speed a vehicle past
its grip limit spins, and its signals may settle all the same: such values are not reported as steady. A vehicle
at rest is in no steady turn.
"""

import math
from typing import Any

import numpy as np

from omni_vehicle_ros.analysis.signals import Array, last_window, peak, steady_state, step_metrics
from omni_vehicle_ros.analysis.topics import columns, friction
from omni_vehicle_ros.bags import Bag
from omni_vehicle_ros.model.tyre import Region, lateral_capacity, region
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import WHEELS

SIDE_SLIP_FLOOR = 1e-5
YAW_RATE_FLOOR = 1e-4
SPEED_FLOOR = 1e-3
REST = 1e-2
_AXLES = (('front', (0, 1)), ('rear', (2, 3)))


def compute_metrics(bag: Bag, vehicle: VehicleParameters | None = None) -> dict[str, Any]:
    """Return the figures of a run; None where there is none, and never NaN.

    Parameters
    ----------
    bag
        A bag with odom, tyres/side_slip and tyres/force.
    vehicle
        The vehicle of the run, for the critical slips of its tyres; the thesis's if not given.

    Returns
    -------
    dict
        ``side_slip.<wheel>``: ``steady_state`` and ``peak`` [rad] (the slip farthest from 0, with its sign),
        ``overshoot`` (fraction of the size of the steady state), ``settling_time`` [s];
        ``speed``: forward speed ``initial`` and ``final`` [m/s], and their ``ratio``;
        ``yaw_rate.steady_state`` [rad/s];
        ``path``: ``final`` [x, y, heading] [m, m, rad within +-pi], and ``radius`` of the steady turn [m],
        positive to the left, 0 when it spins in place;
        ``friction_use.<wheel>.peak`` [1]; ``load.<wheel>.minimum`` [N], 0 when the wheel lifted;
        ``steady``: whether there is a steady state, and ``reason``, why not.

    Raises
    ------
    BagError
        A topic is missing or has no messages.
    """
    odom, slip, force = columns(bag, 'odom'), columns(bag, 'tyres/side_slip'), columns(bag, 'tyres/force')
    reason = unsteady_reason(bag, vehicle or VehicleParameters())
    steady = reason is None
    return {
        'side_slip': {
            wheel: step_metrics(slip.stamp, slip.position[:, i], SIDE_SLIP_FLOOR, steady)._asdict()
            for i, wheel in enumerate(WHEELS)
        },
        'speed': _speed(odom.vx),
        'yaw_rate': {'steady_state': steady_state(odom.stamp, odom.yaw_rate, YAW_RATE_FLOOR) if steady else None},
        'path': {
            'final': [_finite(values[-1]) for values in (odom.x, odom.y, odom.heading)],
            'radius': path_radius(odom.stamp, odom.vx, odom.vy, odom.yaw_rate) if steady else None,
        },
        'friction_use': {wheel: {'peak': peak(slip.effort[:, i])} for i, wheel in enumerate(WHEELS)},
        'load': {wheel: {'minimum': _smallest(force.forces[:, i, 2])} for i, wheel in enumerate(WHEELS)},
        'steady': {'reached': steady, 'reason': reason},
    }


def unsteady_reason(bag: Bag, vehicle: VehicleParameters) -> str | None:
    """Return why a run does not end in a steady state, in words, or None if it does."""
    odom = bag['odom']
    window = last_window(odom.stamp)
    if window is None:
        return 'shorter than a second'
    if max(float(np.max(np.abs(signal[window]))) for signal in (odom.vx, odom.vy, odom.yaw_rate)) < REST:
        return 'at rest'
    sliding = [axle for axle, wheels in _AXLES if all(_region(bag, vehicle, i) is Region.SLIDING for i in wheels)]
    if sliding:
        return f'{" and ".join(sliding)} tyres sliding, past the grip limit'
    signals = (('yaw rate', odom.yaw_rate, YAW_RATE_FLOOR), ('lateral speed', odom.vy, SPEED_FLOOR))
    changing = [name for name, signal, floor in signals if steady_state(odom.stamp, signal, floor) is None]
    return f'{" and ".join(changing)} still changing' if changing else None


def _region(bag: Bag, vehicle: VehicleParameters, wheel: int) -> Region:
    """Return where on its curve the tyre of a wheel works at the end."""
    slip, force = bag['tyres/side_slip'], bag['tyres/force']
    long_force, _, load = force.forces[-1, wheel]
    capacity = lateral_capacity(float(friction(bag)[1][-1, wheel] * load), float(long_force))
    angle, speed = float(slip.position[-1, wheel]), float(slip.velocity[-1, wheel])
    return region(angle, speed, capacity, vehicle.cornering_stiffness, vehicle.adhesion_reduction)


def path_radius(time: Array, vx: Array, vy: Array, yaw_rate: Array) -> float | None:
    """Return the radius of the path of the centre of gravity over the last second [m].

    Parameters
    ----------
    time
        Rising [s], shape (n,).
    vx, vy, yaw_rate
        Twist in base_link [m/s, m/s, rad/s], shape (n,).

    Returns
    -------
    float or None
        Mean speed over mean yaw rate; positive if the centre of the turn lies to the left. None if the speed
        or the yaw rate has not settled, or the path is straight.
    """
    window = last_window(time)
    speed = steady_state(time, np.hypot(vx, vy), SPEED_FLOOR)
    rate = steady_state(time, yaw_rate, YAW_RATE_FLOOR)
    if window is None or speed is None or rate is None or abs(rate) <= YAW_RATE_FLOOR:
        return None
    return math.copysign(speed, float(np.mean(vx[window]))) / rate


def _speed(vx: Array) -> dict[str, float | None]:
    initial, final = _finite(vx[0]), _finite(vx[-1])
    ratio = final / initial if final is not None and initial else None
    return {'initial': initial, 'final': final, 'ratio': None if ratio is None else _finite(ratio)}


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _smallest(values: Array) -> float | None:
    known = values[np.isfinite(values)]
    return float(np.min(known)) if len(known) else None
