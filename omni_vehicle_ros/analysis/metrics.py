"""The figures of a run, from its bag: what ``metrics.json`` holds.

A vehicle is in a steady state at the end if its yaw rate and its lateral speed have settled (see
`omni_vehicle_ros.analysis.signals.steady_state`) and no axle slides (both its tyres do, where more slip gives no more
force; see `omni_vehicle_ros.model.tyres.region`). With a forced forward speed a vehicle past its grip limit spins, and
its signals may settle all the same: such values are not reported as steady. A vehicle at rest is in no steady turn.

The limit speed of a turn (see `omni_vehicle_ros.analysis.turn_limit`) explains why there is no steady state. It does
not decide: a vehicle that comes from a wider turn may be steady at a higher speed. But just past a fold it creeps so
slowly past where the turn was that its signals look settled. So, past its limit, a vehicle whose motion is not that of
a stable steady turn is not steady.
"""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from omni_vehicle_ros.analysis.regions import Regions, region_metrics, regions
from omni_vehicle_ros.analysis.signals import Array, last_window, peak, steady_state, step_metrics
from omni_vehicle_ros.analysis.sound import check_sound
from omni_vehicle_ros.analysis.topics import columns, truth
from omni_vehicle_ros.analysis.turn_limit import ends_in_a_turn, turn_limit
from omni_vehicle_ros.bags import Bag, Columns
from omni_vehicle_ros.model.tyres.region import Region
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import WHEELS

if TYPE_CHECKING:
    from omni_vehicle_ros.model.steady_turn import Limit

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
        ``region.<wheel>``: see `region_metrics`;
        ``steady``: whether there is a steady state, ``reason``, why not, and of a turn at a held speed about an ICR
        that stands still ``limit_speed`` [m/s], up to which slow driving leads to stable steady turns, and
        ``limit_cause``, what comes then (see `omni_vehicle_ros.model.steady_turn.Limit`).

    Raises
    ------
    BagError
        A topic is missing, has no messages, or some that a plant can't have said.
    """
    check_sound(bag)
    odom, slip, force = columns(bag, 'odom'), columns(bag, 'tyres/side_slip'), columns(bag, 'tyres/force')
    vehicle = vehicle or VehicleParameters()
    places, limit = regions(bag, vehicle), turn_limit(bag, vehicle)
    reason = unsteady_reason(bag, vehicle, places, limit)
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
        'region': region_metrics(places),
        'steady': {
            'reached': steady,
            'reason': reason,
            'limit_speed': limit.speed if limit else None,
            'limit_cause': limit.cause if limit else None,
        },
    }


def unsteady_reason(bag: Bag, vehicle: VehicleParameters, places: Regions, limit: 'Limit | None') -> str | None:
    """Return why a run does not end in a steady state, in words, or None if it does.

    Parameters
    ----------
    bag, vehicle
        The run and its vehicle.
    places
        Where its tyres work.
    limit
        Of its turn, if it is known.
    """
    odom = truth(bag, 'odom')
    window = last_window(odom.stamp)
    if window is None:
        return 'shorter than a second'
    if max(float(np.max(np.abs(signal[window]))) for signal in (odom.vx, odom.vy, odom.yaw_rate)) < REST:
        return 'at rest'
    reason = _unsettled(odom, places)
    lost = limit is not None and limit.speed is not None and odom.vx[-1] > limit.speed
    if lost and reason is None and not ends_in_a_turn(bag, vehicle):
        reason = 'creeping past where a steady turn was'
    return f'{reason}, above the limit speed' if reason and lost else reason


def _unsettled(odom: Columns, places: Regions) -> str | None:
    sliding = [axle for axle, wheels in _AXLES if all(places.place[-1, i] == Region.SLIDING for i in wheels)]
    if sliding:
        return f'{" and ".join(sliding)} tyres sliding, past the grip limit'
    signals = (('yaw rate', odom.yaw_rate, YAW_RATE_FLOOR), ('lateral speed', odom.vy, SPEED_FLOOR))
    changing = [name for name, signal, floor in signals if steady_state(odom.stamp, signal, floor) is None]
    return f'{" and ".join(changing)} still changing' if changing else None


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
