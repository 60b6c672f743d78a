"""Refuses gains whose loop is unstable on the vehicle's own actuators, before the vehicle finds out."""

from collections.abc import Iterator

from omni_vehicle_ros.control.gain_margin import SEARCH, Loop, motion_loop, slip_loop
from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters, WheelModuleParameters
from omni_vehicle_ros.wheels import WHEELS

SPEEDS = (1.0, 3.0, 10.0, 20.0, 30.0)
"""Where the loops of motion are checked [m/s]."""

_MOTION_GAINS = {
    'yaw_moment': ('yaw_gain', 'yaw_integral_gain', 'yaw_derivative_gain'),
    'allocation': ('allocation_gain', 'allocation_integral_gain'),
    'rear_steering': (),
}
_AT_THE_LIMIT = 1.0 + 1e-6  # of the gains
_SLIP_GAINS = ('proportional_gains', 'integral_gains', 'derivative_gains')


def check_gains(
    parameters: SideSlipParameters, vehicle: VehicleParameters, module: WheelModuleParameters, period: float
) -> None:
    """Check that the sampled linear loop of the selected controller settles.

    A loop that no smaller gains would settle either, that of a vehicle beyond its own critical speed, is not
    the gains' fault and is let through.

    Parameters
    ----------
    parameters
        Which controller, and its gains.
    vehicle, module
        What is controlled; its actuators.
    period
        Control period [s].

    Raises
    ------
    ParameterError
        Names the gains, and those of the same proportions where the loop becomes unstable.
    """
    unstable = [
        (loop.margin(), where, gains)
        for where, gains, loop in _loops(parameters, vehicle, module, period)
        if loop.stable(SEARCH[0]) and not loop.stable(_AT_THE_LIMIT)
    ]
    if unstable:
        margin, where, gains = min(unstable, key=lambda entry: entry[0])
        raise ParameterError(_reason(parameters, module, margin, where, gains))


def _reason(
    parameters: SideSlipParameters, module: WheelModuleParameters, margin: float, where: str, gains: dict[str, float]
) -> str:
    if not gains:
        return (
            f'controller: {parameters.controller} oscillates without end {where} with this steering, time constant '
            f'{module.steer_time_constant:g} s and delay {module.steer_delay:g} s; take faster actuators'
        )
    values = ', '.join(f'{value:g}' for value in gains.values())
    limits = ', '.join(f'{margin * value:.3g}' for value in gains.values())
    remedy = 'take faster actuators or a shorter control_period'
    if module.ideal_actuators:
        remedy = 'set ideal_actuators: false'
        if parameters.controller == 'wheel_slip':
            remedy += ', or solve it exactly by --mode offline, without integral and derivative'
    return (
        f'{", ".join(gains)}: {values} is not below {limits}, where the sampled loop {where} oscillates without end '
        f'with these actuators; lower {"it" if len(gains) == 1 else "them"}, or {remedy}'
    )


def _loops(
    parameters: SideSlipParameters, vehicle: VehicleParameters, module: WheelModuleParameters, period: float
) -> Iterator[tuple[str, dict[str, float], Loop]]:
    """Yield what is closed: where, the gains that are not 0 by name, and the loop."""
    p = parameters
    if p.controller == 'wheel_slip':
        for wheel, *gains in zip(WHEELS, p.proportional_gains, p.integral_gains, p.derivative_gains, strict=True):
            named = {name: gain for name, gain in zip(_SLIP_GAINS, gains, strict=True) if gain}
            loop = slip_loop((gains[0], gains[1], gains[2]), p.derivative_time_constant, module, period)
            yield f'of {wheel}', named, loop
        return
    named = {name: value for name in _MOTION_GAINS[p.controller] if (value := getattr(p, name))}
    for speed in SPEEDS:
        yield f'at {speed:g} m/s', named, motion_loop(p, vehicle, module, speed, period)
