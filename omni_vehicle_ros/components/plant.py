"""The simulated vehicle: takes the actuators of the four modules, moves, and says what its sensors see."""

import math
from typing import NamedTuple

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.component import ERROR, OK, WARN, Output, Reporter
from omni_vehicle_ros.components.joints import ZEROS, VehicleJoints
from omni_vehicle_ros.messages import Clock, Forces, Imu, Joints, Odometry, Step, Value, Vector
from omni_vehicle_ros.model import body
from omni_vehicle_ros.model import plant as model
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.state import initial_state, state_view
from omni_vehicle_ros.parameters import PlantParameters, VehicleParameters
from omni_vehicle_ros.wheels import WHEELS, per_wheel

START_UP = 2_000_000_000
"""Simulated time until every module must have answered once [ns]."""

ACTUATOR_LIMITS = (6.3, 1000.0, 1e6)
"""No steer angle [rad], rate [rad/s] or torque [N m] of a sane module is beyond these."""


class _Actuators(NamedTuple):
    """What one module said that it does: steer angle [rad], rate [rad/s], drive torque [N m]."""

    angle: float = 0.0
    rate: float = 0.0
    torque: float = 0.0


class Plant:
    """The vehicle on its road.

    Parameters
    ----------
    vehicle, plant
        What it is, and what it does at first.
    name
        Full name of the node, for diagnostics.
    publish_clock
        Whether this plant owns /clock.
    """

    beat = ''
    sources = tuple(f'{wheel}/state' for wheel in WHEELS)

    def __init__(
        self, vehicle: VehicleParameters, plant: PlantParameters, *, name: str = '/plant', publish_clock: bool = True
    ) -> None:
        self.name = name
        self.period = round(plant.control_period * 1e9)
        self.end: int | None = None
        self._vehicle, self._plant = vehicle, plant
        self._publish_clock = publish_clock
        self._constants = constants(vehicle)
        self._state = initial_state(plant.initial_speed)
        self._environment = body.Environment(plant.bank, plant.wind, plant.friction)
        self._actuators = [_Actuators() for _ in WHEELS]
        self._passive: tuple[str, ...] = ()
        self._heard: set[str] = set()
        self._rotation = ZEROS
        self._wheel_speed = ZEROS
        self._force = ZEROS
        self._rejected = ''
        self._reporter = Reporter(name)

    def receive(self, topic: str, value: Value, now: int) -> None:
        """Take a state of a module, an environment, or the end of the scenario."""
        if isinstance(value, Step):
            self.end = value.end if topic == 'driver/step' else self.end
        elif topic in self.sources and isinstance(value, Joints):
            self._take_actuators(self.sources.index(topic), value)
        elif topic.startswith('environment/') and isinstance(value, Joints | Vector):
            self._take_environment(topic, value)

    def _take_actuators(self, wheel: int, value: Joints) -> None:
        if len(value.position) != 2 or len(value.velocity) != 2 or len(value.effort) != 2:
            self._rejected = (
                f'{WHEELS[wheel]}/state has no angle, rate and torque of steer and drive; the last one is kept'
            )
            return
        actuators = _Actuators(value.position[0], value.velocity[0], value.effort[1])
        if not all(map(math.isfinite, actuators)):
            self._rejected = f'{WHEELS[wheel]}/state is not finite: {tuple(actuators)}; the last one is kept'
            return
        for name, number, limit in zip(_Actuators._fields, actuators, ACTUATOR_LIMITS, strict=True):
            if abs(number) > limit:
                self._rejected = f'{WHEELS[wheel]}/state: {name} {number:g} is beyond {limit:g}; the last one is kept'
                return
        self._actuators[wheel] = actuators
        self._heard.add(self.sources[wheel])

    def _take_environment(self, topic: str, value: Joints | Vector) -> None:
        try:
            if value.frame not in ('', interface.BASE_FRAME) and isinstance(value, Vector):
                raise ValueError(f'frame {value.frame!r} is not {interface.BASE_FRAME}')
            self._environment = changed_environment(self._environment, topic, value)
        except ValueError as error:
            self._rejected = f'{topic}: {error}; the last one is kept'

    def begin(self) -> list[Output]:
        """Return what the sensors see at time 0."""
        return self._sense(0)

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        """Move from ``stamp`` [ns] to the next cycle and return what the sensors see there.

        A wheel whose module is ``missing`` goes passive: no torque, angle held.
        """
        if self.end is not None and stamp >= self.end:
            return []
        self._passive = missing
        for wheel, topic in enumerate(self.sources):
            if topic in missing:
                held = self._actuators[wheel]
                self._actuators[wheel] = _Actuators(held.angle)
        period = self._plant.control_period
        actuators, radius = self._actuators, self._vehicle.wheel_radius
        angle = per_wheel(lambda i: actuators[i].angle)
        rate = per_wheel(lambda i: actuators[i].rate)
        self._force = per_wheel(lambda i: actuators[i].torque / radius)
        self._state = model.advance(
            self._state,
            angle,
            rate,
            self._force,
            self._environment,
            self._constants,
            period,
            self._plant.integration_step,
            self._plant.constant_speed,
        )
        self._actuators = [_Actuators(a.angle + a.rate * period, a.rate, a.torque) for a in actuators]
        before, speed = self._wheel_speed, self._speeds()
        rotation = self._rotation
        self._rotation = per_wheel(lambda i: rotation[i] + 0.5 * (before[i] + speed[i]) * period)
        self._wheel_speed = speed
        return self._sense(stamp + self.period)

    def _speeds(self) -> tuple[float, float, float, float]:
        state = state_view(self._state)
        x, y, radius = self._vehicle.wheel_x, self._vehicle.wheel_y, self._vehicle.wheel_radius
        angles = [a.angle for a in self._actuators]
        return per_wheel(
            lambda i: (
                (math.cos(angles[i]) * (state.vx - y[i] * state.r) + math.sin(angles[i]) * (state.vy + x[i] * state.r))
                / radius
            )
        )

    def _sense(self, stamp: int) -> list[Output]:
        if stamp == 0:
            self._wheel_speed = self._speeds()
        actuators, speed = self._actuators, self._wheel_speed
        state = state_view(self._state)
        angles = per_wheel(lambda i: actuators[i].angle)
        now = body.evaluate(
            self._state,
            body.Inputs(angles, self._force),
            self._environment,
            self._constants,
            self._plant.constant_speed,
        )
        joints = VehicleJoints(
            angles,
            per_wheel(lambda i: actuators[i].rate),
            self._rotation,
            speed,
            per_wheel(lambda i: actuators[i].torque),
        )
        radius = self._vehicle.wheel_radius
        forces = tuple(zip(now.longitudinal_force, now.lateral_force, now.vertical_load, strict=True))
        outputs = [
            Output('odom', Odometry(stamp, state.x, state.y, state.psi, state.vx, state.vy, state.r)),
            Output('imu', Imu(stamp, now.roll_angle, state.psi, state.r, now.ax, now.ay, self._vehicle.gravity)),
            Output('tyres/force', Forces(stamp, WHEELS, forces)),
            Output(
                'tyres/side_slip',
                Joints(stamp, WHEELS, now.side_slip, per_wheel(lambda i: speed[i] * radius), now.friction_use),
            ),
        ]
        if self._publish_clock:
            outputs.append(Output('/clock', Clock(stamp)))
        outputs += self._reporter.report(stamp, *self._health(stamp, now))
        outputs.append(Output('joint_states', joints.message(stamp, interface.BASE_FRAME)))
        return outputs

    def _health(self, stamp: int, now: body.Evaluation) -> tuple[int, str]:
        if self._passive and stamp < START_UP and not self._heard.issuperset(self._passive):
            return OK, 'waiting for the first answer of the wheel modules'
        if self._passive:
            silent = ', '.join(topic.removesuffix('/state') + '/wheel_module' for topic in self._passive)
            return ERROR, f'no answer from {silent}: no torque, steer angle held'
        if self._rejected:
            message, self._rejected = self._rejected, ''
            return ERROR, message
        lifted = [wheel for wheel, up in zip(WHEELS, now.lifted, strict=True) if up]
        if lifted:
            return WARN, f'rollover warning: no load on {", ".join(lifted)}'
        return OK, 'driving'


def changed_environment(environment: body.Environment, topic: str, value: Value) -> body.Environment:
    """Return the environment after a message.

    Raises
    ------
    ValueError
        Says which number is outside of what.
    """
    if topic == 'environment/bank' and isinstance(value, Vector):
        return environment._replace(bank=_within(value.x, -0.7, 0.7, 'rad'))
    if topic == 'environment/wind' and isinstance(value, Vector):
        return environment._replace(wind=_within(value.y, -60.0, 60.0, 'm/s'))
    if not isinstance(value, Joints) or len(value.effort) != len(value.names):
        raise ValueError('needs one effort (the friction coefficient) a name (the wheel)')
    unknown = [name for name in value.names if name not in WHEELS]
    if unknown:
        raise ValueError(f'unknown wheel {unknown[0]!r}; allowed: {", ".join(WHEELS)}')
    given = {name: _within(mu, 0.01, 2.0, '') for name, mu in zip(value.names, value.effort, strict=True)}
    friction = per_wheel(lambda i: given.get(WHEELS[i], environment.friction[i]))
    return environment._replace(friction=friction)


def _within(value: float, low: float, high: float, unit: str) -> float:
    if not low <= value <= high:
        raise ValueError(f'{value:g} is outside {low:g} .. {high:g} {unit}'.rstrip())
    return value
