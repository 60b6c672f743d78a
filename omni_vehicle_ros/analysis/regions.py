"""The region that each tyre works in over time: linear, nonlinear or sliding."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.topics import friction, truth
from omni_vehicle_ros.bags import Bag
from omni_vehicle_ros.model.constants import Constants, constants
from omni_vehicle_ros.model.contact import WALKING_PACE
from omni_vehicle_ros.model.tyres.friction_circle import lateral_capacity
from omni_vehicle_ros.model.tyres.region import Region, combined_region, region
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import WHEELS

UNKNOWN = -1


class Regions(NamedTuple):
    """Times ``stamp`` [s], shape (n,), and the `Region` of each tyre then, shape (n, 4); `UNKNOWN` without a slip."""

    stamp: Array
    place: npt.NDArray[np.int64]


def regions(bag: Bag, vehicle: VehicleParameters) -> Regions:
    """Return where on its curve each tyre works, with the load, the friction and the traction that it has.

    Traction counts by the friction circle, if the vehicle has that; of ``eight_dof`` it is the slip of the spinning
    wheel that counts, but below walking pace, where slips mean little, the circle does.

    Parameters
    ----------
    bag
        A bag with odom, tyres/side_slip and tyres/force.
    vehicle
        The vehicle of the run.
    """
    slip, force, model = truth(bag, 'tyres/side_slip'), bag['tyres/force'], constants(vehicle)
    grips = friction(bag)
    rows, grip_rows = (_last_row(stamp, slip.stamp) for stamp in (force.stamp, grips[0]))
    demands = np.array(force.forces)[rows]
    capacity = grips[1][grip_rows] * demands[:, :, 2]

    spins = vehicle.body_model == 'eight_dof'
    paces = _paces(bag, slip.stamp, model) if spins else np.zeros(capacity.shape)

    def place(row: int, wheel: int) -> int:
        angle, rim_speed = float(slip.position[row, wheel]), float(slip.velocity[row, wheel])
        grip, pace = float(capacity[row, wheel]), float(paces[row, wheel])
        if not math.isfinite(angle):
            return UNKNOWN
        if abs(pace) >= WALKING_PACE:
            return combined_region(angle, rim_speed, pace * math.cos(angle), grip, model)
        left = lateral_capacity(grip, float(demands[row, wheel, 0])) if spins or model.friction_circle else grip
        return region(angle, rim_speed, left, model)

    return Regions(slip.stamp, np.array([[place(row, i) for i in range(4)] for row in range(len(slip))]))


def _paces(bag: Bag, times: Array, model: Constants) -> Array:
    """Return the speed over ground of each wheel, negative backward [m/s], shape (n, 4)."""
    odom = truth(bag, 'odom')
    rows = _last_row(odom.stamp, times)
    vx, vy, r = (signal[rows, np.newaxis] for signal in (odom.vx, odom.vy, odom.yaw_rate))
    along = vx - r * np.array(model.wheel_y)
    paces: Array = np.copysign(np.hypot(along, vy + r * np.array(model.wheel_x)), along)
    return paces


def _last_row(known: Array, times: Array) -> npt.NDArray[np.int64]:
    return np.clip(np.searchsorted(known, times + 1e-9, side='right') - 1, 0, len(known) - 1)


def spans(found: Regions, wheel: int, place: Region) -> list[tuple[float, float]]:
    """Return from when to when a tyre works in a region, in the order of time [s].

    Parameters
    ----------
    found
        What `regions` found; a sample counts up to the next one.
    wheel
        Number of the wheel: fl, fr, rl, rr.
    place
        The region.
    """
    edges = np.flatnonzero(np.diff(found.place[:, wheel] == place, prepend=False, append=False))
    times = np.append(found.stamp, found.stamp[-1])[edges]
    return [(float(begin), float(end)) for begin, end in times.reshape(-1, 2)]


def region_metrics(found: Regions) -> dict[str, dict[str, float | None]]:
    """Return for each wheel the share of the time in each region, and when it was first past the linear one.

    Returns
    -------
    dict
        By wheel: ``linear``, ``nonlinear`` and ``sliding``, which sum to 1, and the times ``left_linear`` and ``slid``
        [s] at which the tyre was first past its linear region, and first slid; None if it never did.
    """
    return {wheel: _wheel_metrics(found.stamp, found.place[:, i]) for i, wheel in enumerate(WHEELS)}


def _wheel_metrics(stamp: Array, place: npt.NDArray[np.int64]) -> dict[str, float | None]:
    known = place[place != UNKNOWN]
    shares = {entry.name.lower(): float(np.mean(known == entry)) if len(known) else None for entry in Region}
    return {
        **shares,
        'left_linear': _first(stamp, place >= Region.NONLINEAR),
        'slid': _first(stamp, place == Region.SLIDING),
    }


def _first(stamp: Array, there: npt.NDArray[np.bool_]) -> float | None:
    return float(stamp[np.argmax(there)]) if np.any(there) else None
