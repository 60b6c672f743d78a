"""What acts on the vehicle of a scenario whose commands need no feedback: worked out before it moves.

With ideal actuators and the forward speed held, or traction given, the set-points of ICR steering depend on commands,
geometry and time alone. They come from the same driver script and the same control law as in any run.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

from omni_vehicle_ros.components.plant import changed_environment
from omni_vehicle_ros.control.icr_steering import IcrSteering
from omni_vehicle_ros.model.constants import Constants, constants
from omni_vehicle_ros.model.dynamics import NO_GAIN, Environment
from omni_vehicle_ros.parameters import SteeringParameters
from omni_vehicle_ros.scenarios import Scenario
from omni_vehicle_ros.scenarios.environment import EnvironmentProfile
from omni_vehicle_ros.scenarios.scenario import whole_cycles
from omni_vehicle_ros.scenarios.script import DriverScript
from omni_vehicle_ros.simulation import exact_gains
from omni_vehicle_ros.wheels import PerWheel, per_wheel

_STILL: PerWheel = (0.0, 0.0, 0.0, 0.0)


class Acting(NamedTuple):
    """What acts from a control cycle on: steer angles [rad], drive forces [N] and environment."""

    cycle: int
    steer_angle: PerWheel
    drive_force: PerWheel
    environment: Environment

    @property
    def numbers(self) -> tuple[float, ...]:
        """All but the cycle, in the order of the rows of `model.batch`, the slip gains left out."""
        bank, wind, friction = self.environment
        return *self.steer_angle, *self.drive_force, bank, wind, *friction


class OpenLoop(NamedTuple):
    """A turn that is settled before it begins.

    Attributes
    ----------
    constants
        The vehicle.
    speed
        Forward speed at the start [m/s].
    slip_gain
        Gains of exact side-slip control.
    road
        Environment before the first cycle.
    acting
        What acts, from cycle 0 on, in the order of time.
    cycles, steps, size
        How many control cycles of how many integration steps, of which size [s].
    constant_speed
        Whether the forward speed is held.
    """

    constants: Constants
    speed: float
    slip_gain: PerWheel
    road: Environment
    acting: tuple[Acting, ...]
    cycles: int
    steps: int
    size: float
    constant_speed: bool


def why_closed(scenario: Scenario) -> str | None:
    """Return what in a scenario needs feedback, or other physics than those in the plane, and the remedy; or None.

    Raises
    ------
    ScenarioError
        Side-slip control with ideal actuators has gains without an exact form.
    """
    steering, moving = scenario.steering, not scenario.plant.constant_speed
    if scenario.vehicle.body_model != 'yaw_plane':
        return f'its body is {scenario.vehicle.body_model}; --set vehicle.body_model=yaw_plane'
    if not scenario.wheel_module.ideal_actuators:
        return 'its actuators lag; --set wheel_module.ideal_actuators=true'
    if scenario.side_slip_control and exact_gains(scenario) is None:
        return f'{scenario.side_slip.controller} control has a past; --set side_slip.controller=wheel_slip'
    if steering.motion_rate_limit > 0.0 and steering.alignment_slowdown:
        return 'it waits for its wheels; --set steering.alignment_slowdown=false'
    if 0.0 < steering.command_timeout < scenario.command_period:
        return 'its commands grow stale; --set steering.command_timeout=0'
    if any(command.emergency_stop is not None for command in scenario.commands):
        return 'its emergency stop waits for standstill; leave emergency_stop out'
    if len({command.cmd_vel is None for command in scenario.commands if not command.silent}) > 1:
        return 'autonomy and hand take turns; say teleop in place of cmd_vel'
    if moving and any(command.traction is None or command.traction < 0.0 for command in scenario.commands):
        return 'its speed is controlled, or it brakes; --set plant.constant_speed=true'
    if moving and scenario.side_slip_control and any(command.yaw_moment for command in scenario.commands):
        return 'its yaw moment follows the wheels; --set side_slip_control=false'
    if steering.motion_rate_limit > 0.0 and any(command.silent for command in scenario.commands):
        return 'its driver falls silent on the way; --set steering.motion_rate_limit=0'
    return None


def open_loop(scenario: Scenario) -> OpenLoop:
    """Return what acts on the vehicle of a scenario that `why_closed` has nothing against.

    Raises
    ------
    ScenarioError
        As `why_closed`.
    """
    plant = scenario.plant
    return OpenLoop(
        constants=_constants(scenario.vehicle),
        speed=plant.initial_speed,
        slip_gain=exact_gains(scenario) or NO_GAIN,
        road=Environment(plant.bank, plant.wind, plant.friction),
        acting=tuple(_acting(scenario)),
        cycles=scenario.cycles,
        steps=round(plant.control_period / plant.integration_step),
        size=plant.integration_step,
        constant_speed=plant.constant_speed,
    )


def _acting(scenario: Scenario) -> list[Acting]:
    """Ask driver and control law in each cycle in which something may change."""
    script = DriverScript(scenario)
    law = IcrSteering(scenario.vehicle, _ever_fresh(scenario.steering), scenario.plant.control_period)
    take: dict[str, Callable[[Any, int], None]] = {
        'driver/icr': law.icr, 'driver/speed': law.speed, 'driver/traction': law.traction, 'cmd_vel': law.cmd_vel,
        'teleop/cmd_vel': law.teleop,
    }  # fmt: skip
    period = round(scenario.plant.control_period * 1e9)
    road = Environment(scenario.plant.bank, scenario.plant.wind, scenario.plant.friction)
    angle = force = _STILL
    # What the law asks of the next cycle differs only if it turns slowly, or looks at the angles of this one.
    gradual = scenario.steering.motion_rate_limit > 0.0 or any(command.yaw_moment for command in scenario.commands)
    found: list[Acting] = []
    waiting = _changes(scenario)
    while waiting and (cycle := min(waiting)) < scenario.cycles:
        waiting.remove(cycle)
        for topic, value in script.messages(cycle):
            if topic in take:
                take[topic](value, cycle * period)
            else:
                road = changed_environment(road, topic, value)
        before = angle, force
        angle, force = _followed(law, cycle * period, angle, scenario)
        found.append(Acting(cycle, angle, force, road))
        if gradual and (angle, force) != before:
            waiting.add(cycle + 1)
    return found


_constants = lru_cache(maxsize=8)(constants)


@lru_cache(maxsize=8)
def _ever_fresh(steering: SteeringParameters) -> SteeringParameters:
    """Return what commands do not grow stale with: here the driver says them once."""
    return replace(steering, command_timeout=0.0)


def _followed(law: IcrSteering, now: int, angle: PerWheel, scenario: Scenario) -> tuple[PerWheel, PerWheel]:
    """Return what ideal actuators make of the set-points: angles [rad] and forces [N], within their limits."""
    wanted, radius = law.update(now, angle, _STILL), scenario.vehicle.wheel_radius
    reach, most = scenario.wheel_module.steer_limit, scenario.wheel_module.drive_torque_limit
    angle = per_wheel(lambda i: min(max(wanted.steer_angle[i], -reach), reach))
    if scenario.plant.constant_speed:  # leaves drive forces out
        return angle, _STILL
    return angle, per_wheel(lambda i: min(max(wanted.torque[i], -most), most) / radius)


def _changes(scenario: Scenario) -> set[int]:
    """Return the cycles in which a command begins or the environment changes, and the first one.

    With each that before it: the law turns the motion by the time that has passed since it was asked last.
    """
    period = scenario.plant.control_period
    begins = [whole_cycles(command.at, period) for command in scenario.commands]
    cycles = {0, *begins, *(begin - 1 for begin in begins if begin > 0)}
    for entry in scenario.environment:
        begin, end = whole_cycles(entry.at, period), whole_cycles(entry.end, period)
        cycles.update(range(begin, end + 1) if isinstance(entry, EnvironmentProfile) else (begin,))
    return cycles
