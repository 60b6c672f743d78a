"""Other vehicle models in Python, driven by the integrator that their own documentation shows."""

from collections.abc import Callable, Mapping
from importlib.util import find_spec
from typing import Any

import numpy as np

from omni_vehicle_ros.bench.frame import Line, Time, at_least

SPEED, STEER = 15.0, 0.03
"""Of the full-size vehicles [m/s, rad]; the small one of slipx takes those of its documentation."""
STD, MULTI_BODY, SLIPX = 'commonroad std', 'commonroad mb', 'slipx L2'
SIMULATED = {STD: 2.0, MULTI_BODY: 0.5, SLIPX: 10.0}
"""How long each drives in a round [s]."""
MODULES = {STD: 'vehiclemodels', MULTI_BODY: 'vehiclemodels', SLIPX: 'slipx'}
SAMPLE, SLIPX_STEP = 0.01, 1e-3  # s, as in their documentation
MISSING = 'not installed: pip install omni_vehicle_ros[peers]'


def peer_works() -> dict[str, Callable[[], object]]:
    """Return what to time, of those that are installed; their vehicles are read here, and don't count."""
    makers = {STD: commonroad_std, MULTI_BODY: commonroad_mb, SLIPX: slipx_double_track}
    return {name: make() for name, make in makers.items() if find_spec(MODULES[name])}


def peer_lines(times: Mapping[str, Time], ours: float) -> list[Line]:
    """Return a line for each peer.

    Parameters
    ----------
    times
        Of what `peer_works` has named.
    ours
        CPU time of our vehicle per simulated second [s].
    """
    lines = []
    for name, simulated in SIMULATED.items():
        rate = simulated / times[name].cpu if name in times else None
        note = '' if name in times else MISSING
        what = f'one vehicle from Python, beside {name}'
        lines.append(Line(what, 's simulated per s of CPU', 1.0 / ours, rate, name, at_least(1.0), note))
    return lines


def commonroad_std() -> Callable[[], object]:
    """Return a drive of the single-track drift model."""
    from vehiclemodels.init_std import init_std
    from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
    from vehiclemodels.vehicle_dynamics_std import vehicle_dynamics_std

    return _odeint(vehicle_dynamics_std, init_std, parameters_vehicle2(), SIMULATED[STD])


def commonroad_mb() -> Callable[[], object]:
    """Return a drive of the multi-body model."""
    from vehiclemodels.init_mb import init_mb
    from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
    from vehiclemodels.vehicle_dynamics_mb import vehicle_dynamics_mb

    return _odeint(vehicle_dynamics_mb, init_mb, parameters_vehicle2(), SIMULATED[MULTI_BODY])


def _odeint(
    dynamics: Callable[..., list[float]], make_state: Callable[..., list[float]], vehicle: Any, duration: float
) -> Callable[[], object]:
    from scipy.integrate import odeint

    start, times = make_state([0.0, 0.0, STEER, SPEED, 0.0, 0.0, 0.0], vehicle), np.arange(0.0, duration, SAMPLE)
    return lambda: odeint(lambda x, t: dynamics(x, [0.0, 0.0], vehicle), start, times)


def slipx_double_track() -> Callable[[], object]:
    """Return a drive of the double-track model."""
    import slipx

    model = slipx.VehicleModel.create(slipx.Tier.L2_DoubleTrack, slipx.load_reference_car().params)

    def drive() -> None:
        state, steer = slipx.VehicleState(), slipx.DriveInput(steer_cmd=0.1)
        state.vel_body.x = 5.0
        for _ in range(round(SIMULATED[SLIPX] / SLIPX_STEP)):
            model.step(state, steer, SLIPX_STEP)

    return drive
