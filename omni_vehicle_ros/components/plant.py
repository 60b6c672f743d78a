"""The simulated vehicle: takes the actuators of the four modules, moves, and says what its sensors see."""

import math
from typing import NamedTuple

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.component import ERROR, WARN, Output, Reporter
from omni_vehicle_ros.components.joints import ZEROS, VehicleJoints
from omni_vehicle_ros.components.sensor_faults import SensorFaults
from omni_vehicle_ros.control.health import Health, health
from omni_vehicle_ros.faults import CLOCK, OK, SENSORS, Fault
from omni_vehicle_ros.messages import Clock, Forces, Imu, Joints, Odometry, Step, Value, Vector
from omni_vehicle_ros.model.body_model import body_model
from omni_vehicle_ros.model.castor import castored
from omni_vehicle_ros.model.dynamics import Environment, Evaluation, Inputs
from omni_vehicle_ros.parameters import PlantParameters, VehicleParameters, WheelModuleParameters
from omni_vehicle_ros.wheels import WHEELS, PerWheel, as_four, per_wheel, scaled

START_UP = 2_000_000_000
"""Simulated time until every module must have answered once [ns]."""

SAME_ANGLE = 1e-9
"""Differences of a steer angle that come from rounding [rad]."""


class _Actuators(NamedTuple):
    """What one module said that it does: steer angle [rad], rate [rad/s], drive torque [N m]."""

    angle: float
    rate: float
    torque: float


ACTUATOR_LIMITS = _Actuators(6.3, 1000.0, 1e6)
"""No sane module is beyond these."""


def _insanity(actuators: _Actuators) -> str:
    """Say what no sane module does."""
    if not all(map(math.isfinite, actuators)):
        return f' is not finite: {tuple(actuators)}'
    compared = zip(_Actuators._fields, actuators, ACTUATOR_LIMITS, strict=True)
    return next(f': {name} {number:g} is beyond {most:g}' for name, number, most in compared if abs(number) > most)


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
    slip_gain
        Proportional gains by which the wheels steer to zero side slip without any lag, in the exact algebraic
        form; the angles of the modules are their set-points then.
    steering
        Gives range and fastest turn of a wheel whose motor is off, or that is not where its module has it.

    Attributes
    ----------
    values
        Names and values that its diagnostics show beside how it does.
    """

    beat = ''
    sources = tuple(f'{wheel}/state' for wheel in WHEELS)

    def __init__(
        self,
        vehicle: VehicleParameters,
        plant: PlantParameters,
        *,
        name: str = '/plant',
        publish_clock: bool = True,
        slip_gain: PerWheel = ZEROS,
        steering: WheelModuleParameters | None = None,
    ) -> None:
        self.name = name
        self.period = round(plant.control_period * 1e9)
        self.end: int | None = None
        self.values: tuple[tuple[str, str], ...] = ()
        self._vehicle, self._plant = vehicle, plant
        self._publish_clock = publish_clock
        self._slip_gain = slip_gain
        self._body = body_model(vehicle)
        self._state = self._body.initial_state(plant.initial_speed)
        self._environment = Environment(plant.bank, plant.wind, plant.friction)
        # What the modules said that they do.
        self._steer_angle, self._steer_rate, self._torque = [0.0] * 4, [0.0] * 4, [0.0] * 4
        self._passive: tuple[str, ...] = ()
        self._heard: set[str] = set()
        self._rotation = self._rate = ZEROS
        self._force = ZEROS
        self._steering = steering or WheelModuleParameters()
        self._trails: dict[int, float] = {}
        self._locked: set[int] = set()
        self._sensors = SensorFaults()
        self._jump = 0
        self._now = self._evaluate()
        self._wheel_speed = self._speeds()
        self._rejected = ''
        self._reporter = Reporter(name)

    def fail(self, fault: Fault, now: int) -> None:
        """Let a sensor, the clock, a brake or the motor of a steering fail, or be ok again."""
        wheel, _, part = fault.component.rpartition('/')
        if fault.component in SENSORS:
            self._sensors.fail(fault, now)
        elif fault.component == CLOCK:
            self._jump = round(fault.value * 1e9 / self.period) * self.period
        elif part == 'brake':
            (self._locked.discard if fault.failure == OK else self._locked.add)(WHEELS.index(wheel))
        elif part == 'steering':
            self._trails.pop(WHEELS.index(wheel), None)
            if fault.failure == 'off':
                self._trails[WHEELS.index(wheel)] = fault.value

    def receive(self, topic: str, value: Value, now: int) -> None:
        """Take a state of a module, an environment, or the end of the scenario."""
        if isinstance(value, Step):
            self.end = value.end if topic == 'driver/step' else self.end
        elif topic in _WHEEL_OF and isinstance(value, Joints):
            self._take_actuators(_WHEEL_OF[topic], value)
        elif topic.startswith('environment/') and isinstance(value, Joints | Vector):
            self._take_environment(topic, value)

    def _take_actuators(self, wheel: int, value: Joints) -> None:
        if len(value.position) != 2 or len(value.velocity) != 2 or len(value.effort) != 2:
            self._rejected = (
                f'{WHEELS[wheel]}/state has no angle, rate and torque of steer and drive; the last one is kept'
            )
            return
        angle, rate, torque = value.position[0], value.velocity[0], value.effort[1]
        most = ACTUATOR_LIMITS
        if abs(angle) <= most.angle and abs(rate) <= most.rate and abs(torque) <= most.torque:
            if wheel not in self._trails:
                self._steer_angle[wheel], self._steer_rate[wheel] = angle, rate
            self._torque[wheel] = torque
            self._heard.add(self.sources[wheel])
        else:
            insanity = _insanity(_Actuators(angle, rate, torque))
            self._rejected = f'{WHEELS[wheel]}/state{insanity}; the last one is kept'

    def _take_environment(self, topic: str, value: Joints | Vector) -> None:
        try:
            if value.frame not in ('', interface.BASE_FRAME) and isinstance(value, Vector):
                raise ValueError(f'frame {value.frame!r} is not {interface.BASE_FRAME}')
            self._environment = changed_environment(self._environment, topic, value)
        except ValueError as error:
            self._rejected = f'{topic}: {error}; the last one is kept'

    @property
    def trims(self) -> PerWheel:
        """How far the wheels are steered beyond the angles of the modules [rad]; 0 without slip gains."""
        angle, told = self._now.steer_angle, self._steer_angle
        return per_wheel(lambda i: angle[i] - told[i])

    def begin(self, stamp: int = 0) -> list[Output]:
        """Return what the sensors see before time goes on from ``stamp`` [ns]."""
        self._now = self._evaluate()
        self._wheel_speed = self._speeds()
        return self._sense(stamp)

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        """Move from ``stamp`` [ns] to the next cycle and return what the sensors see there.

        A wheel whose module is ``missing`` goes passive: no torque, angle held.
        """
        if self.end is not None and stamp >= self.end:
            return []
        self._passive = missing
        for wheel, topic in enumerate(self.sources):
            if topic in missing:
                self._steer_rate[wheel] = self._torque[wheel] = 0.0
            else:
                self._catch_up(wheel)
        self._move()
        jump, self._jump = max(self._jump, -stamp), 0
        return self._sense(stamp + self.period + jump)

    def _catch_up(self, wheel: int) -> None:
        """Turn a wheel that is not where its module has it no faster than it can.

        It is so after lost messages or a jump of the clock. Ideal actuators are at once where they are told to be.
        """
        angle, here = self._steer_angle[wheel], self._now.steer_angle[wheel]
        if abs(angle - here) <= SAME_ANGLE or self._steering.ideal_actuators or self._slip_gain[wheel] > 0.0:
            return
        period, most = self._plant.control_period, self._steering.steer_rate_limit
        rate = (angle + self._steer_rate[wheel] * period - here) / period
        self._steer_angle[wheel], self._steer_rate[wheel] = here, min(max(rate, -most), most)

    def _move(self) -> None:
        """Let one control cycle pass."""
        period, radius = self._plant.control_period, self._vehicle.wheel_radius
        for wheel, trail in self._trails.items():
            self._swing(wheel, trail)
        gain, rate = self._slip_gain, as_four(self._steer_rate)
        self._force = as_four([torque / radius for torque in self._torque])
        if self._locked:
            self._lock()
        self._state = self._body.advance(
            self._state,
            self._inputs(),
            rate,
            self._environment,
            period,
            self._plant.integration_step,
            self._plant.constant_speed,
        )
        moving = zip(self._steer_angle, self._steer_rate, strict=True)
        self._steer_angle = [angle + rate * period for angle, rate in moving]
        if self._locked:
            self._state = self._body.locked(self._state, self._locked)
        angle, before = self._now.steer_angle, self._wheel_speed
        now = self._now = self._evaluate()
        speed = self._wheel_speed = self._speeds()
        self._rate = rate if gain == ZEROS else per_wheel(
            lambda i: (now.steer_angle[i] - angle[i]) / period if gain[i] > 0.0 else rate[i]
        )
        turning = zip(self._rotation, before, speed, strict=True)
        self._rotation = as_four([rotation + 0.5 * (first + last) * period for rotation, first, last in turning])

    def _swing(self, wheel: int, trail: float) -> None:
        """Turn a wheel whose motor is off towards its own motion, no faster and no farther than the others turn."""
        angle = self._steer_angle[wheel]
        vx, vy, r = self._state[:3].tolist()
        velocity = vx - self._vehicle.wheel_y[wheel] * r, vy + self._vehicle.wheel_x[wheel] * r
        period, most, limit = self._plant.control_period, self._steering.steer_rate_limit, self._steering.steer_limit
        aim = min(max(castored(angle, velocity, trail, period), -limit), limit)
        self._steer_rate[wheel] = min(max((aim - angle) / period, -most), most)

    def _lock(self) -> None:
        """Brake locked wheels so that they do not turn."""
        self._state = self._body.locked(self._state, self._locked)
        now, friction, force = self._evaluate(), self._environment.friction, self._force
        self._force = per_wheel(
            lambda i: self._body.locking_force(i, self._state, now, friction[i]) if i in self._locked else force[i]
        )

    def _inputs(self) -> Inputs:
        return Inputs(as_four(self._steer_angle), self._force, self._slip_gain)

    def _evaluate(self) -> Evaluation:
        return self._body.evaluate(self._state, self._inputs(), self._environment, self._plant.constant_speed)

    def _speeds(self) -> PerWheel:
        speed = self._body.wheel_speeds(self._state, self._now.steer_angle)
        return per_wheel(lambda i: 0.0 if i in self._locked else speed[i]) if self._locked else speed

    def _sense(self, stamp: int) -> list[Output]:
        speed, now = self._wheel_speed, self._now
        vx, vy, r, x, y, psi = self._state[:6].tolist()
        joints = VehicleJoints(now.steer_angle, self._rate, self._rotation, speed, as_four(self._torque))
        rolling = scaled(self._vehicle.wheel_radius, speed)
        forces = tuple(zip(now.longitudinal_force, now.lateral_force, now.vertical_load, strict=True))
        outputs = [
            Output('joint_states', joints.message(stamp, interface.BASE_FRAME)),  # what the others wait for
            Output('odom', Odometry(stamp, x, y, psi, vx, vy, r)),
            Output('imu', Imu(stamp, now.roll_angle, psi, r, now.ax, now.ay, self._vehicle.gravity)),
            Output('tyres/force', Forces(stamp, WHEELS, forces)),
            Output('tyres/side_slip', Joints(stamp, WHEELS, now.side_slip, rolling, now.friction_use)),
        ]
        if self._publish_clock:
            outputs.append(Output('/clock', Clock(stamp)))
        return self._reporter.report(stamp, self._health(stamp, now)) + self._sensors.apply(stamp, outputs)

    def _health(self, stamp: int, now: Evaluation) -> Health:
        if self._passive and stamp < START_UP and not self._heard.issuperset(self._passive):
            return health([], 'waiting for the first answer of the wheel modules')
        notes = []
        if self._passive:
            silent = ', '.join(topic.removesuffix('/state') + '/wheel_module' for topic in self._passive)
            notes.append((ERROR, f'no answer from {silent}: no torque, steer angle held'))
        if self._rejected:
            notes.append((ERROR, self._rejected))
            self._rejected = ''
        if any(now.lifted):
            lifted = ', '.join(wheel for wheel, up in zip(WHEELS, now.lifted, strict=True) if up)
            notes.append((WARN, f'rollover warning: no load on {lifted}'))
        return health(notes, 'driving', self.values)


_WHEEL_OF = {topic: wheel for wheel, topic in enumerate(Plant.sources)}


def changed_environment(environment: Environment, topic: str, value: Value) -> Environment:
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
