"""Every parameter once: default, unit, range and meaning.

The ROS parameters of the nodes, the YAML files in ``config/``, the scenario files and the documentation
are all made from these classes. All values are SI, all angles in rad, frames as in REP-103.
Defaults of the vehicle: thesis, Appendix A.
"""

import dataclasses
import difflib
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Any, TypeVar

from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.wheels import PerWheel

P = TypeVar('P', bound='Parameters')

TYRE_MODELS = ('dugoff', 'brush', 'magic_formula', 'lugre')


def parameter(
    default: Any,
    text: str,
    *,
    unit: str = '',
    low: float | None = None,
    high: float | None = None,
    choices: tuple[str, ...] = (),
) -> Any:
    """Declare one field of a parameter class.

    Parameters
    ----------
    default
        A bool, int, float, str, or a tuple of float or str.
    text
        What it is, in one sentence.
    unit
        SI unit, empty for a number without one.
    low, high
        Limits, both allowed values; checked for every entry of a tuple.
    choices
        The allowed words of a str.
    """
    metadata = {'text': text, 'unit': unit, 'low': low, 'high': high, 'choices': choices}
    return field(default=default, metadata=metadata)


class Parameters:
    """Base of the parameter classes: checks every field when an instance is made.

    Raises
    ------
    ParameterError
        Names the parameter, the value and what is allowed.
    """

    def __post_init__(self) -> None:
        """Coerce and check every field."""
        for entry in dataclasses.fields(self):  # type: ignore[arg-type]
            value = check_value(entry, getattr(self, entry.name))
            object.__setattr__(self, entry.name, value)

    @classmethod
    def from_mapping(cls: type[P], values: Mapping[str, Any]) -> P:
        """Make an instance from names and values; what is not named keeps its default."""
        known = [entry.name for entry in dataclasses.fields(cls)]  # type: ignore[arg-type]
        for name in values:
            if name not in known:
                raise ParameterError(f'unknown parameter {name!r}{did_you_mean(name, known)}')
        return cls(**values)

    def as_dict(self) -> dict[str, Any]:
        """Return names and values, in the order of declaration."""
        return {entry.name: getattr(self, entry.name) for entry in dataclasses.fields(self)}  # type: ignore[arg-type]


def did_you_mean(name: str, known: Any) -> str:
    """Return the tail of an error message that says what is allowed instead of ``name``."""
    close = difflib.get_close_matches(str(name), list(known), n=1)
    if close:
        return f'; did you mean {close[0]!r}?'
    return f'; allowed: {", ".join(known)}'


def check_value(entry: 'dataclasses.Field[Any]', value: Any) -> Any:
    """Return ``value`` in the type of the field's default, or raise ParameterError."""
    default = entry.default
    if isinstance(default, tuple):
        if not isinstance(value, (tuple, list)) or (default and len(value) != len(default) and _fixed(entry)):
            size = f' of {len(default)} values' if _fixed(entry) else f', such as [{value}]'
            raise ParameterError(f'{entry.name}: {value!r} must be a list{size}')
        element = default[0] if default else ''
        return tuple(_check_scalar(entry, element, item) for item in value)
    return _check_scalar(entry, default, value)


def _fixed(entry: 'dataclasses.Field[Any]') -> bool:
    return len(entry.default) == 4  # type: ignore[arg-type]


def _check_scalar(entry: 'dataclasses.Field[Any]', default: Any, value: Any) -> Any:
    name, limits = entry.name, entry.metadata
    if isinstance(default, bool):
        if not isinstance(value, bool):
            raise ParameterError(f'{name}: {value!r} must be true or false')
        return value
    if isinstance(default, str):
        if not isinstance(value, str):
            raise ParameterError(f'{name}: {value!r} must be a word')
        if limits['choices'] and value not in limits['choices']:
            raise ParameterError(f'{name}: {value!r} is not one of {", ".join(limits["choices"])}')
        return value
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ParameterError(f'{name}: {value!r} must be a number')
    if isinstance(default, int) and value != int(value):
        raise ParameterError(f'{name}: {value!r} must be a whole number')
    low, high = limits['low'], limits['high']
    if not math.isfinite(value) or (low is not None and value < low) or (high is not None and value > high):
        low_text = '-inf' if low is None else f'{low:g}'
        high_text = 'inf' if high is None else f'{high:g}'
        unit = f' {limits["unit"]}' if limits['unit'] else ''
        raise ParameterError(f'{name}: {value!r} is outside {low_text} .. {high_text}{unit}')
    return int(value) if isinstance(default, int) else float(value)


@dataclass(frozen=True)
class VehicleParameters(Parameters):
    """The vehicle: masses, geometry, suspension, tyres and body (thesis, Appendix A)."""

    body_model: str = parameter(
        'yaw_plane', 'yaw_plane: motion in the plane, roll follows at once; eight_dof: roll and the spin of each wheel have dynamics of their own.',
        choices=('yaw_plane', 'eight_dof'),
    )
    mass: float = parameter(1298.9, 'Total mass.', unit='kg', low=1.0, high=1e5)
    sprung_mass: float = parameter(1167.5, 'Sprung mass.', unit='kg', low=0.0, high=1e5)
    cg_to_front_axle: float = parameter(1.0, 'Distance from the centre of gravity to the front axle.', unit='m', low=0.01, high=20.0)
    cg_to_rear_axle: float = parameter(1.454, 'Distance from the centre of gravity to the rear axle.', unit='m', low=0.01, high=20.0)
    front_track: float = parameter(1.436, 'Distance between the front wheels.', unit='m', low=0.01, high=10.0)
    rear_track: float = parameter(1.436, 'Distance between the rear wheels.', unit='m', low=0.01, high=10.0)
    roll_arm: float = parameter(0.4572, 'Height of the sprung centre of gravity above the roll axis.', unit='m', low=0.0, high=5.0)
    front_roll_centre_height: float = parameter(0.0758, 'Height of the front roll centre; the thesis gives that of the sprung centre of gravity, 0.533 m, which is roll_arm more.', unit='m', low=0.0, high=5.0)
    rear_roll_centre_height: float = parameter(0.0758, 'Height of the rear roll centre.', unit='m', low=0.0, high=5.0)
    yaw_inertia: float = parameter(1627.0, 'Moment of inertia about the vertical axis.', unit='kg m2', low=1.0, high=1e6)
    roll_stiffness: float = parameter(66185.8, 'Roll stiffness of both axles.', unit='N m/rad', low=1.0, high=1e7)
    front_roll_stiffness_share: float = parameter(0.552, "The front axle's share of the roll stiffness.", low=0.0, high=1.0)
    front_roll_steer: float = parameter(-0.2, 'Steer angle of the front wheels per roll angle.', unit='rad/rad', low=-2.0, high=2.0)
    rear_roll_steer: float = parameter(0.2, 'Steer angle of the rear wheels per roll angle.', unit='rad/rad', low=-2.0, high=2.0)
    load_transfer: bool = parameter(True, 'Lateral load transfer acts on the wheel loads.')
    wheel_radius: float = parameter(0.35, 'Rolling radius of a wheel.', unit='m', low=0.01, high=3.0)
    tyre_model: str = parameter('dugoff', 'Law of the tyres; all have the same stiffness and friction.', choices=TYRE_MODELS)
    cornering_stiffness: float = parameter(30000.0, 'Cornering stiffness of one tyre.', unit='N/rad', low=1.0, high=1e7)
    longitudinal_stiffness: float = parameter(50000.0, 'Longitudinal stiffness of one tyre, per unit slip; acts in eight_dof.', unit='N', low=1.0, high=1e7)
    adhesion_reduction: float = parameter(0.015, "Road adhesion reduction factor; of Dugoff's tyre.", unit='s/m', low=0.0, high=1.0)
    magic_shape: float = parameter(1.193, 'Shape factor C of the Magic Formula.', low=1.0, high=2.0)
    magic_curvature: float = parameter(-1.003, 'Curvature factor E of the Magic Formula.', low=-20.0, high=1.0)
    lugre_sliding_share: float = parameter(0.5556, 'Friction of a fast sliding LuGre tyre over that of one that begins to slide.', low=0.01, high=1.0)
    lugre_stribeck_speed: float = parameter(12.5, 'Stribeck speed of the LuGre tyre.', unit='m/s', low=0.01, high=1000.0)
    friction_circle: bool = parameter(True, 'Traction and brake reduce what a tyre can do sideways; in eight_dof they always do.')
    relaxation_length: float = parameter(0.35, 'Relaxation length of a tyre; acts below walking pace only.', unit='m', low=0.05, high=2.0)
    air_density: float = parameter(1.2, 'Density of the air.', unit='kg/m3', low=0.0, high=2.0)
    side_area: float = parameter(1.2, 'Area that the lateral wind acts on.', unit='m2', low=0.0, high=200.0)
    airflow_angles: tuple[float, ...] = parameter((0.3455,), 'Airflow angles of the side force table, rising.', unit='rad', low=0.0, high=1.5708)
    side_force_coefficients: tuple[float, ...] = parameter((0.58,), 'Side force coefficients at airflow_angles.', low=0.0, high=10.0)
    aerodynamic_centre: float = parameter(0.0, 'Distance of the aerodynamic centre ahead of the centre of gravity.', unit='m', low=-10.0, high=10.0)
    roll_inertia: float = parameter(498.9, 'Moment of inertia of the sprung mass about the roll axis; acts in eight_dof.', unit='kg m2', low=0.0, high=1e6)
    roll_yaw_inertia: float = parameter(0.0, 'Product of inertia of roll and yaw, the integral of x z dm; acts in eight_dof.', unit='kg m2', low=-1e6, high=1e6)
    roll_damping: float = parameter(3511.6, 'Roll damping of both axles, shared as the roll stiffness is; acts in eight_dof.', unit='N m s/rad', low=0.0, high=1e7)
    wheel_inertia: float = parameter(2.1, 'Moment of inertia of a wheel about its axle; acts in eight_dof.', unit='kg m2', low=0.0, high=1e4)
    stability_factor: float = parameter(0.005, 'Stability factor A of the yaw rate that yaw_moment aims at: that of the command over 1 + A v^2.', unit='s2/m2', low=0.0, high=1.0)
    gravity: float = parameter(9.81, 'Acceleration of gravity.', unit='m/s2', low=0.1, high=30.0)

    def __post_init__(self) -> None:
        """Check what no single range can."""
        super().__post_init__()
        if self.sprung_mass > self.mass:
            raise ParameterError(f'sprung_mass: {self.sprung_mass:g} kg is more than mass, {self.mass:g} kg')
        if self.sprung_mass * self.gravity * self.roll_arm >= self.roll_stiffness:
            raise ParameterError(
                f'roll_stiffness: {self.roll_stiffness:g} N m/rad must be above sprung_mass * gravity * roll_arm, '
                f'{self.sprung_mass * self.gravity * self.roll_arm:g} N m/rad, or the body falls over'
            )
        if self.body_model == 'eight_dof':
            self._check_eight_dof()
        angles = self.airflow_angles
        if not angles or len(angles) != len(self.side_force_coefficients):
            raise ParameterError('airflow_angles and side_force_coefficients: must have the same length, 1 or more')
        if any(b <= a for a, b in pairwise(angles)):
            raise ParameterError(f'airflow_angles: {list(angles)} must rise')

    def _check_eight_dof(self) -> None:
        least = self.sprung_mass * self.roll_arm**2 + self.roll_yaw_inertia**2 / self.yaw_inertia
        if self.roll_inertia <= least:
            raise ParameterError(
                f'roll_inertia: {self.roll_inertia:g} kg m2 must be above {least:g} kg m2 with body_model eight_dof: '
                'sprung_mass * roll_arm^2 + roll_yaw_inertia^2 / yaw_inertia'
            )
        if self.wheel_inertia <= 0.0:
            raise ParameterError('wheel_inertia: 0.0 kg m2 must be above 0 kg m2 with body_model eight_dof')

    @cached_property
    def wheelbase(self) -> float:
        """Distance between the axles [m]."""
        return self.cg_to_front_axle + self.cg_to_rear_axle

    @cached_property
    def wheel_x(self) -> PerWheel:
        """Positions of the wheels ahead of the centre of gravity [m]."""
        front, rear = self.cg_to_front_axle, -self.cg_to_rear_axle
        return front, front, rear, rear

    @cached_property
    def wheel_y(self) -> PerWheel:
        """Positions of the wheels to the left of the centre of gravity [m]."""
        front, rear = 0.5 * self.front_track, 0.5 * self.rear_track
        return front, -front, rear, -rear


@dataclass(frozen=True)
class SteeringParameters(Parameters):
    """ICR steering: what a driver may ask for and how it is turned into set-points of the wheels."""

    steering_rule: str = parameter(
        'omni', 'road: wheels roll forward within 90 deg; omni: a wheel may also turn by 180 deg less and roll backward.', choices=('road', 'omni')
    )
    steer_limit: float = parameter(1.75, 'Largest steer angle of a wheel, to either side.', unit='rad', low=0.01, high=3.1415)
    straight_radius: float = parameter(1e5, 'An ICR farther away than this means straight on, or crab across its bearing.', unit='m', low=10.0, high=1e9)
    maximum_speed: float = parameter(30.0, 'Largest speed of the centre of gravity.', unit='m/s', low=0.01, high=100.0)
    maximum_wheel_speed: float = parameter(40.0, 'Largest speed of a wheel over ground; all wheels are scaled together.', unit='m/s', low=0.01, high=100.0)
    acceleration_limit: float = parameter(2.0, 'Largest change of the commanded speed; 0: no limit.', unit='m/s2', low=0.0, high=100.0)
    motion_rate_limit: float = parameter(
        0.5, 'Largest change of the direction of the commanded twist (vx, vy, r L), L = half the wheelbase; 0: no limit.', unit='rad/s', low=0.0, high=100.0
    )
    command_timeout: float = parameter(0.5, 'Age at which a driver command is stale: speed ramps to 0, angles hold; 0: never.', unit='s', low=0.0, high=60.0)
    emergency_deceleration: float = parameter(6.0, 'What an emergency stop asks of the tyres, braking and turning together; at most the friction of the road times gravity.', unit='m/s2', low=0.5, high=20.0)
    alignment_slowdown: bool = parameter(True, 'Slow down while the wheels do not yet point where they should.')
    speed_gain: float = parameter(2.0, 'Proportional gain of the speed controller, times the mass.', unit='1/s', low=0.0, high=20.0)
    speed_integral_gain: float = parameter(1.0, 'Integral gain of the speed controller, times the mass.', unit='1/s2', low=0.0, high=20.0)
    drive_shares: PerWheel = parameter((0.25, 0.25, 0.25, 0.25), 'Share of each wheel in traction; they sum to 1.', low=0.0, high=1.0)
    maximum_drive_force: float = parameter(3000.0, 'Largest traction or brake force of one wheel.', unit='N', low=0.0, high=1e5)
    fault_reaction: bool = parameter(False, 'Act on faults of wheel modules that are seen: other ICR, other shares of the drives, less speed, or a stop. Without it they are only said. In real time on a machine that misses most cycles, late nodes are taken for faulty ones.')
    fault_speed: float = parameter(5.0, 'Largest speed of the centre of gravity with a fault, but for a dead drive.', unit='m/s', low=0.01, high=100.0)
    fault_lateral_acceleration: float = parameter(2.0, 'Largest lateral acceleration with such a fault; three tyres have to make it.', unit='m/s2', low=0.01, high=20.0)

    def __post_init__(self) -> None:
        """Check what no single range can."""
        super().__post_init__()
        if abs(sum(self.drive_shares) - 1.0) > 1e-9:
            raise ParameterError(f'drive_shares: {list(self.drive_shares)} must sum to 1')


@dataclass(frozen=True)
class WheelModuleParameters(Parameters):
    """One wheel module: its steering and drive actuators, and when it stops trusting its command."""

    ideal_actuators: bool = parameter(False, 'Steering and drive follow their set-points at once; wheel_slip control is then solved exactly offline, and needs gains below 1 where it is sampled.')
    steer_delay: float = parameter(0.005, 'Time delay of the steering actuator.', unit='s', low=0.0, high=1.0)
    steer_time_constant: float = parameter(0.1, 'Time constant of the steering actuator.', unit='s', low=0.001, high=10.0)
    steer_rate_limit: float = parameter(3.0, 'Largest rate of the steer angle.', unit='rad/s', low=0.001, high=100.0)
    steer_limit: float = parameter(1.75, 'Largest steer angle, to either side.', unit='rad', low=0.01, high=3.1415)
    drive_time_constant: float = parameter(0.05, 'Time constant of the drive torque.', unit='s', low=0.001, high=10.0)
    drive_torque_limit: float = parameter(1050.0, 'Largest drive or brake torque.', unit='N m', low=0.0, high=1e5)
    module_timeout: float = parameter(0.1, 'Age of a set-point at which the module holds its angle and brakes its wheel. In real time also how long it waits for joint_states before it holds its angle without torque. 0: never.', unit='s', low=0.0, high=60.0)
    brake_gain: float = parameter(150.0, 'Brake torque per wheel speed when the set-point is stale.', unit='N m s/rad', low=0.0, high=1e5)
    emergency_torque: float = parameter(100.0, 'Least brake torque of a rolling wheel in an emergency stop, whatever it is commanded.', unit='N m', low=0.0, high=1e5)


@dataclass(frozen=True)
class SideSlipParameters(Parameters):
    """The side-slip controller: which law trims the wheels, its gains and limits."""

    controller: str = parameter(
        'wheel_slip',
        'wheel_slip: a PID for each wheel, target slip 0 (thesis, chapter 5); yaw_moment: more traction on one side than on the other (2.10); '
        'rear_steering: rear angles for zero body slip (2.11); allocation: equal slips on the commanded path. '
        'Where wheel_slip takes the slip from an axle it takes its side force, too: the axle that leads runs wide, but one that trails no longer '
        'holds the tail. So with gains on the front wheels do not turn in reverse: a circle of 5 m becomes one of 3.8 m at 3 m/s, and a spin at 4 m/s.',
        choices=('wheel_slip', 'yaw_moment', 'rear_steering', 'allocation'),
    )
    proportional_gains: PerWheel = parameter((5.0, 5.0, 0.0, 0.0), 'Steer angle per side-slip angle; with the default actuators the loop is stable below 20.5. Gains of an unstable loop are refused, here and below.', unit='rad/rad', low=0.0, high=100.0)
    integral_gains: PerWheel = parameter((0.0, 0.0, 0.0, 0.0), 'Steer rate per side-slip angle.', unit='1/s', low=0.0, high=100.0)
    derivative_gains: PerWheel = parameter((0.0, 0.0, 0.0, 0.0), 'Steer angle per rate of the side-slip angle.', unit='s', low=0.0, high=10.0)
    derivative_time_constant: float = parameter(0.05, 'Filter time constant of the derivative part.', unit='s', low=0.001, high=10.0)
    trim_limit: float = parameter(0.5, 'Largest steering trim, to either side; the wheel modules hold every trim to it, so that it can be lowered live, but not raised above what it was at the start.', unit='rad', low=0.0, high=3.1415)
    minimum_speed: float = parameter(1.0, 'No trim below half of this speed, the whole trim above it.', unit='m/s', low=0.01, high=30.0)
    friction_estimate: float = parameter(0.9, 'Friction coefficient that yaw_moment and allocation reckon with.', low=0.01, high=2.0)
    yaw_gain: float = parameter(20000.0, 'yaw_moment: moment per error of the yaw rate; with the other defaults stable below 780000 N m s/rad.', unit='N m s/rad', low=0.0, high=1e6)
    yaw_integral_gain: float = parameter(100000.0, 'yaw_moment: rate of the moment per error of the yaw rate; with the other defaults stable below 580000 N m/rad.', unit='N m/rad', low=0.0, high=1e7)
    yaw_derivative_gain: float = parameter(0.0, 'yaw_moment: moment per rate of the error of the yaw rate; with the other defaults stable below 71000 N m s2/rad.', unit='N m s2/rad', low=0.0, high=1e5)
    allocation_gain: float = parameter(1.0, 'allocation: steer angle per error of the direction that an axle moves in; with the other defaults stable below 14.', unit='rad/rad', low=0.0, high=20.0)
    allocation_integral_gain: float = parameter(4.0, 'allocation: steer rate per error of the direction that an axle moves in; with the other defaults stable below 13 1/s.', unit='1/s', low=0.0, high=100.0)
    reference_time_constant: float = parameter(0.1, 'yaw_moment and allocation: lag of the motion that the feedback expects, about that of the steering.', unit='s', low=0.001, high=10.0)
    fault_reaction: bool = parameter(False, 'Other sensors stand in for one that can not be believed, and trims go to 0 where none is left. Without it that is only said.')
    allocation_traction: bool = parameter(True, 'allocation: a left/right difference of traction makes the slips of both axles equal, too.')


@dataclass(frozen=True)
class PlantParameters(Parameters):
    """The simulated plant: how it moves at first, what it drives on, and how time passes."""

    control_period: float = parameter(0.005, 'Time between two states, and so between two control actions.', unit='s', low=0.001, high=0.1)
    integration_step: float = parameter(0.001, 'Step of the integration inside a control period.', unit='s', low=1e-5, high=0.01)
    constant_speed: bool = parameter(False, 'Hold the forward speed (2 degrees of freedom) instead of integrating it (3).')
    initial_speed: float = parameter(0.0, 'Forward speed at the start.', unit='m/s', low=-100.0, high=100.0)
    bank: float = parameter(0.0, 'Bank angle of the road until a message says otherwise; positive pushes to the left.', unit='rad', low=-0.7, high=0.7)
    wind: float = parameter(0.0, 'Lateral wind until a message says otherwise; positive blows to the left.', unit='m/s', low=-60.0, high=60.0)
    friction: PerWheel = parameter((0.9, 0.9, 0.9, 0.9), 'Friction coefficient under each wheel until a message says otherwise.', low=0.01, high=2.0)

    state_timeout: float = parameter(0.1, 'Age of a module state at which its wheel goes passive, in real time.', unit='s', low=0.001, high=60.0)

    def __post_init__(self) -> None:
        """Check what no single range can."""
        super().__post_init__()
        steps = self.control_period / self.integration_step
        if abs(steps - round(steps)) > 1e-9 or round(steps) < 1:
            raise ParameterError(
                f'integration_step: {self.integration_step:g} s must divide control_period, {self.control_period:g} s, without rest'
            )


@dataclass(frozen=True)
class PacingParameters(Parameters):
    """How the nodes keep step with each other."""

    autostart: bool = parameter(True, 'Configure and activate the node when it starts; else its lifecycle services do.')
    pacing: str = parameter('realtime', 'lockstep: every node waits for what belongs to the cycle; realtime: the latest is taken.', choices=('lockstep', 'realtime'))
    realtime_factor: float = parameter(1.0, 'Simulated time over wall time, in real time.', low=0.01, high=100.0)
    realtime_priority: int = parameter(0, 'Priority (SCHED_FIFO) of the nodes that drive, in real time; driver and recorder have one less. For machines with cores to spare: what waits for such a node may wait for ever. 0: leave it to the system.', low=0, high=98)
    wait_limit: float = parameter(4.0, 'Wall time that a node waits for an input in lock step before it goes on without; those whose answers others wait for, a little less.', unit='s', low=0.01, high=600.0)
    publish_clock: bool = parameter(True, 'The plant of this vehicle owns /clock; of several vehicles, one does.')
    fault_injection: bool = parameter(False, 'Faults may be injected, on the topic faults and by the parameters fault.*; a run of a scenario with faults sets it.')
    start_limit: float = parameter(30.0, 'Wall time that the plant waits for the participants in lock step.', unit='s', low=0.1, high=600.0)
    participants: tuple[str, ...] = parameter(
        ('plant', 'front_left/wheel_module', 'front_right/wheel_module', 'rear_left/wheel_module', 'rear_right/wheel_module',
         'icr_steering', 'side_slip_controller'),
        'Nodes that take part; in lock step all of them are waited for.',
    )


@dataclass(frozen=True)
class RecorderParameters(Parameters):
    """The recorder: which topics it takes, and what it makes of them."""

    directory: str = parameter('bag', 'Directory of the bag; must not exist.')
    all: bool = parameter(False, 'Record every topic with a publisher, but for hidden ones (/a/_b). Without all, topics and regex: the topics of the vehicle.')
    topics: tuple[str, ...] = parameter((), 'Names of topics to record, hidden ones included.')
    regex: str = parameter('', 'Record also the topics in whose full name this regular expression is found; hidden ones not.')
    exclude: tuple[str, ...] = parameter((), 'Topics to leave out whatever the others say: names, or regular expressions for full names.')
    compression: str = parameter('zstd', 'Compression of the chunks.', choices=('zstd', 'lz4', 'none'))
    split_size: int = parameter(2_000_000_000, 'Size of a file from which on the next one follows; 0: never.', unit='B', low=0, high=1e15)
    split_time: float = parameter(0.0, 'Time in a file from which on the next one follows; 0: never.', unit='s', low=0.0, high=1e9)
    snapshot: bool = parameter(False, 'Write nothing, but keep the latest messages in memory until the service ~/snapshot is called: then write these.')
    snapshot_size: int = parameter(100_000_000, 'Messages that are kept for a snapshot, in all.', unit='B', low=1, high=1e12)
    snapshot_time: float = parameter(30.0, 'Age up to which messages are kept for a snapshot.', unit='s', low=0.001, high=1e6)

    def __post_init__(self) -> None:
        """Check what no single range can."""
        super().__post_init__()
        for name, pattern in (('regex', self.regex), *(('exclude', entry) for entry in self.exclude)):
            try:
                re.compile(pattern)
            except re.error as error:
                raise ParameterError(f'{name}: {pattern!r} is no regular expression: {error}') from None

        if self.exclude and not self.chooses:
            raise ParameterError('exclude: goes with all, topics or regex; without them the vehicle is recorded')

    @property
    def chooses(self) -> bool:
        """Whether topics are chosen, instead of those of the vehicle."""
        return bool(self.all or self.topics or self.regex)
