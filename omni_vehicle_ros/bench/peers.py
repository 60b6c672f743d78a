"""Other vehicle models in Python, driven by the integrator that their own documentation shows."""

from collections.abc import Callable, Mapping
from importlib.util import find_spec

import numpy as np

from omni_vehicle_ros.bench.frame import Line, Time, at_least

SPEED, STEER = 15.0, 0.03
"""Of the full-size vehicles [m/s, rad]; the small one of slipx takes those of its documentation."""
SIMULATED = {'commonroad std': 0.5, 'commonroad mb': 0.1, 'slipx L2': 5.0}
"""How long each drives in a round [s]."""
MODULES = {'commonroad std': 'vehiclemodels', 'commonroad mb': 'vehiclemodels', 'slipx L2': 'slipx'}
MISSING = 'not installed: pip install omni_vehicle_ros[peers]'


def peer_works() -> dict[str, Callable[[], object]]:
    """Return what to time, of those that are installed."""
    works = {'commonroad std': commonroad_std, 'commonroad mb': commonroad_mb, 'slipx L2': slipx_double_track}
    return {name: work for name, work in works.items() if find_spec(MODULES[name])}


def peer_lines(times: Mapping[str, Time], ours: float) -> list[Line]:
    """Return a line for each peer.

    Parameters
    ----------
    times
        Of what `peer_works` has named.
    ours
        CPU time of our vehicle per simulated second [s].
    """
    return [
        Line(
            f'one vehicle from Python, beside {name}', 's simulated per s of CPU', 1.0 / ours,
            SIMULATED[name] / times[name].cpu if name in times else None, name, at_least(1.0),
            '' if name in times else MISSING,
        )
        for name in SIMULATED
    ]  # fmt: skip


def commonroad_std() -> None:
    """Drive the single-track drift model by odeint."""
    from vehiclemodels.init_std import init_std
    from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
    from vehiclemodels.vehicle_dynamics_std import vehicle_dynamics_std

    vehicle = parameters_vehicle2()
    _odeint(vehicle_dynamics_std, init_std([0.0, 0.0, STEER, SPEED, 0.0, 0.0, 0.0], vehicle), vehicle, 'commonroad std')


def commonroad_mb() -> None:
    """Drive the multi-body model by odeint."""
    from vehiclemodels.init_mb import init_mb
    from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
    from vehiclemodels.vehicle_dynamics_mb import vehicle_dynamics_mb

    vehicle = parameters_vehicle2()
    _odeint(vehicle_dynamics_mb, init_mb([0.0, 0.0, STEER, SPEED, 0.0, 0.0, 0.0], vehicle), vehicle, 'commonroad mb')


def _odeint(dynamics: Callable[..., list[float]], start: list[float], vehicle: object, name: str) -> None:
    from scipy.integrate import odeint

    odeint(lambda x, t: dynamics(x, [0.0, 0.0], vehicle), start, np.arange(0.0, SIMULATED[name], 0.01))


def slipx_double_track() -> None:
    """Drive the double-track model by its own step of 1 ms."""
    import slipx

    model = slipx.VehicleModel.create(slipx.Tier.L2_DoubleTrack, slipx.load_reference_car().params)
    state, steer = slipx.VehicleState(), slipx.DriveInput(steer_cmd=0.1)
    state.vel_body.x = 5.0
    for _ in range(round(SIMULATED['slipx L2'] / 1e-3)):
        model.step(state, steer, 1e-3)
