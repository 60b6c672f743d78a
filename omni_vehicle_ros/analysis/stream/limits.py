"""The limits of a vehicle that events are about."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.parameters import PlantParameters, SideSlipParameters, SteeringParameters, WheelModuleParameters
from omni_vehicle_ros.scenarios import Scenario
from omni_vehicle_ros.wheels import WHEELS

_CLOSE = 1.0 - 1e-6
FULL_USE = 0.999
"""Friction use from which on a tyre has no more to give."""


class Test(NamedTuple):
    """Tells where a signal is at a limit; kind and text are those of the event."""

    kind: str
    text: str
    so: Callable[[Array], npt.NDArray[np.bool_]]


class Limits(NamedTuple):
    """Limits of the actuators, the trims and the commands, and the friction before any is said; inf: none."""

    steer_angle: float
    steer_rate: float
    drive_torque: float
    trim: float
    command_timeout: int
    """[ns]; 0: none."""
    friction: tuple[float, ...]

    def tests(self) -> dict[str, tuple[Test, ...]]:
        """Return what to look for in the traces, by their names."""
        trim = (_at('trim', self.trim, 'rad'),)
        return {
            'steer_angle': (_at('steer angle', self.steer_angle, 'rad'),),
            'steer_rate': (_at('steer rate', self.steer_rate, 'rad/s'),),
            'drive_torque': (_at('drive torque', self.drive_torque, 'N m'),),
            'friction_use': (Test('saturation', 'friction use is 1', lambda values: values >= FULL_USE),),
            'load': (Test('wheel lift', 'no load', lambda values: values <= 0.0),),
            **{f'steer_trim.{wheel}': trim for wheel in WHEELS},
        }


def _at(what: str, limit: float, unit: str) -> Test:
    return Test(
        'saturation', f'{what} is at its limit, {limit:g} {unit}', lambda values: np.abs(values) >= _CLOSE * limit
    )


def limits_of(scenario: Scenario | None) -> Limits:
    """Return the limits of the vehicle of a scenario; the default ones without."""
    module = scenario.wheel_module if scenario else WheelModuleParameters()
    steering = scenario.steering if scenario else SteeringParameters()
    plant = scenario.plant if scenario else PlantParameters()
    trims = scenario.side_slip if scenario else SideSlipParameters()
    rate, torque = module.steer_rate_limit, module.drive_torque_limit
    if module.ideal_actuators:
        rate = torque = math.inf
    timeout = round(steering.command_timeout * 1e9)
    return Limits(module.steer_limit, rate, torque, trims.trim_limit, timeout, tuple(plant.friction))
