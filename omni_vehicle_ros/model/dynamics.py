"""Equations of motion in the plane: 3 degrees of freedom, or 2 at a held speed (thesis B.9-B.12 and sec. 3.1).

Lateral acceleration, wheel loads, roll steer and side forces depend on each other at the same instant. This
algebraic loop is solved in every evaluation, so that the answer depends neither on the step nor on the past.

Written in the part of Python that numba compiles (see `compiled`); users call `body` and `plant`.
"""

from typing import NamedTuple

from omni_vehicle_ros.model.arithmetic import cos_sin, norm, positive
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.contact import (
    Contact,
    deflection_rate,
    side_slip,
    trim,
    trim_share,
    trimmed,
    turned,
    wheel_force,
)
from omni_vehicle_ros.model.disturbances import bank_force, wind_force, wind_moment
from omni_vehicle_ros.model.lanes import anywhere, select
from omni_vehicle_ros.model.loads import lifted, roll_angle, static_loads, vertical_loads
from omni_vehicle_ros.model.loop import solve_loop
from omni_vehicle_ros.model.state import State
from omni_vehicle_ros.wheels import PerWheel

NO_DRIVE: PerWheel = (0.0, 0.0, 0.0, 0.0)
NO_GAIN: PerWheel = (0.0, 0.0, 0.0, 0.0)

Contacts = tuple[Contact, Contact, Contact, Contact]
Pair = tuple[float, float]
WheelForces = tuple[Pair, Pair, Pair, Pair]  # longitudinal, lateral


class Inputs(NamedTuple):
    """What the wheel modules do: steer angles [rad] and drive forces along the wheels [N], fl, fr, rl, rr.

    With a ``slip_gain`` K > 0 the steer angle is the set-point delta0 of a wheel that a proportional controller
    steers to zero side slip without any lag, at every instant: delta = delta0 - K alpha, which is solved by
    alpha = (delta0 + roll steer - theta) / (1 + K), theta the direction of the wheel's velocity (thesis ch. 5).
    The gain fades out below walking pace; see `contact.trim_share`.
    """

    steer_angle: PerWheel
    drive_force: PerWheel = NO_DRIVE
    slip_gain: PerWheel = NO_GAIN


class Environment(NamedTuple):
    """What the vehicle drives in: bank angle [rad], lateral wind [m/s], friction under each wheel.

    A positive bank pushes the vehicle, and a positive wind blows, to the left.
    """

    bank: float = 0.0
    wind: float = 0.0
    friction: PerWheel = (0.9, 0.9, 0.9, 0.9)


class Evaluation(NamedTuple):
    """Everything that follows from a state at one instant; fl, fr, rl, rr where per wheel.

    ``steer_angle``: the real ones [rad], the set-points less slip gain times slip; ``side_slip`` [rad], roll
    steer included; ``longitudinal_force`` and ``lateral_force`` in the wheel frame and ``vertical_load`` [N];
    ``friction_use``: size of both forces over friction times load, 0 for a wheel in the air; ``lifted``;
    ``roll_angle`` [rad], positive to the right; ``ax``, ``ay``: tyre forces over mass, what an accelerometer at
    the centre of gravity feels [m/s2].
    """

    steer_angle: PerWheel
    side_slip: PerWheel
    longitudinal_force: PerWheel
    lateral_force: PerWheel
    vertical_load: PerWheel
    friction_use: PerWheel
    lifted: tuple[bool, bool, bool, bool]
    roll_angle: float
    ax: float
    ay: float


def evaluation(
    state: State, inputs: Inputs, environment: Environment, constants: Constants, constant_speed: bool
) -> Evaluation:
    """Return slips, forces and loads at one instant; see `body.evaluate`."""
    contacts = wheel_contacts(state, inputs, environment, constants, constant_speed)
    ay, forces = solve(contacts, constants)
    force_fl, force_fr, force_rl, force_rr = forces
    angle, added = inputs.steer_angle, trims(contacts, constants.roll_per_acceleration * ay, constants)
    contacts = _trimmed(contacts, ay, constants)
    fl, fr, rl, rr = contacts
    loads = vertical_loads(ay, fl.load, rl.load, constants)
    cos_front, sin_front, cos_rear, sin_rear = roll_steer(constants.roll_per_acceleration * ay, constants)
    return Evaluation(
        steer_angle=(angle[0] + added[0], angle[1] + added[1], angle[2] + added[2], angle[3] + added[3]),
        side_slip=(
            side_slip(fl, cos_front, sin_front, constants),
            side_slip(fr, cos_front, sin_front, constants),
            side_slip(rl, cos_rear, sin_rear, constants),
            side_slip(rr, cos_rear, sin_rear, constants),
        ),
        longitudinal_force=(force_fl[0], force_fr[0], force_rl[0], force_rr[0]),
        lateral_force=(force_fl[1], force_fr[1], force_rl[1], force_rr[1]),
        vertical_load=loads,
        friction_use=(
            use_of_friction(fl, force_fl, loads[0]),
            use_of_friction(fr, force_fr, loads[1]),
            use_of_friction(rl, force_rl, loads[2]),
            use_of_friction(rr, force_rr, loads[3]),
        ),
        lifted=lifted(loads, constants),
        roll_angle=roll_angle(ay, constants),
        ax=body_force_and_moment(contacts, forces, constants)[0] / constants.mass,
        ay=ay,
    )


def state_rate(
    state: State, inputs: Inputs, environment: Environment, constants: Constants, constant_speed: bool
) -> State:
    """Return the time derivative of every entry of the state (thesis B.9, B.10); see `body.derivative`."""
    contacts = wheel_contacts(state, inputs, environment, constants, constant_speed)
    ay, forces = solve(contacts, constants)
    contacts = _trimmed(contacts, ay, constants)
    fl, fr, rl, rr = contacts
    force_x, moment = body_force_and_moment(contacts, forces, constants)
    wind = wind_force(environment.wind, state.vx, constants)
    side_force = bank_force(environment.bank, constants) + wind
    cos_front, sin_front, cos_rear, sin_rear = roll_steer(constants.roll_per_acceleration * ay, constants)
    cos_psi, sin_psi = cos_sin(state.psi)
    return State(
        0.0 if constant_speed else force_x / constants.mass + state.vy * state.r,
        ay + side_force / constants.mass - state.vx * state.r,
        (moment + wind_moment(wind, constants)) / constants.yaw_inertia,
        state.vx * cos_psi - state.vy * sin_psi,
        state.vx * sin_psi + state.vy * cos_psi,
        state.r,
        _stretching(fl, cos_front, sin_front, constants),
        _stretching(fr, cos_front, sin_front, constants),
        _stretching(rl, cos_rear, sin_rear, constants),
        _stretching(rr, cos_rear, sin_rear, constants),
    )


def _stretching(contact: Contact, cos_roll: float, sin_roll: float, constants: Constants) -> float:
    v_long, v_lat = turned(contact, cos_roll, sin_roll)
    return deflection_rate(contact, v_long, v_lat, constants)


def solve(contacts: Contacts, constants: Constants) -> tuple[float, WheelForces]:
    """Return the lateral acceleration [m/s2] that its own loads, roll steer and trims cause, and the forces.

    Parameters
    ----------
    contacts
        The wheels at their set-points.
    constants
        The vehicle.
    """
    return solve_loop(_response, _largest_acceleration(contacts, constants), contacts, constants)


def _largest_acceleration(contacts: Contacts, constants: Constants) -> float:
    # A wheel may carry its whole axle, and without the friction circle use its grip both ways.
    fl, fr, rl, rr = contacts
    grip = fl.friction * fl.load + fr.friction * fr.load + rl.friction * rl.load + rr.friction * rr.load
    return 3.0 * grip / constants.mass


def _response(ay: float, contacts: Contacts, constants: Constants) -> tuple[float, WheelForces]:
    """Return the lateral acceleration and the forces of tyres loaded, roll-steered and trimmed as by ``ay``."""
    fl, fr, rl, rr = _trimmed(contacts, ay, constants)
    cos_front, sin_front, cos_rear, sin_rear = roll_steer(constants.roll_per_acceleration * ay, constants)
    load_fl, load_fr, load_rl, load_rr = vertical_loads(ay, fl.load, rl.load, constants)
    force_fl = wheel_force(fl, cos_front, sin_front, load_fl, constants)
    force_fr = wheel_force(fr, cos_front, sin_front, load_fr, constants)
    force_rl = wheel_force(rl, cos_rear, sin_rear, load_rl, constants)
    force_rr = wheel_force(rr, cos_rear, sin_rear, load_rr, constants)
    total = leftward(fl, force_fl) + leftward(fr, force_fr) + leftward(rl, force_rl) + leftward(rr, force_rr)
    return total / constants.mass, (force_fl, force_fr, force_rl, force_rr)


def trims(contacts: Contacts, roll: float, constants: Constants) -> PerWheel:
    """Return what exact side-slip control adds to the steer angles at a roll angle [rad]."""
    fl, fr, rl, rr = contacts
    cos_front, sin_front, cos_rear, sin_rear = roll_steer(roll, constants)
    return (
        trim(fl, cos_front, sin_front),
        trim(fr, cos_front, sin_front),
        trim(rl, cos_rear, sin_rear),
        trim(rr, cos_rear, sin_rear),
    )


def _trimmed(contacts: Contacts, ay: float, constants: Constants) -> Contacts:
    """Return the wheels at their real steer angles."""
    fl, fr, rl, rr = contacts
    if not anywhere(fl.trim_share + fr.trim_share + rl.trim_share + rr.trim_share > 0.0):
        return contacts
    cos_front, sin_front, cos_rear, sin_rear = roll_steer(constants.roll_per_acceleration * ay, constants)
    return (
        trimmed(fl, cos_front, sin_front),
        trimmed(fr, cos_front, sin_front),
        trimmed(rl, cos_rear, sin_rear),
        trimmed(rr, cos_rear, sin_rear),
    )


def leftward(contact: Contact, force: Pair) -> float:
    """Return the component to the left of the body [N] of a force along and across the wheel [N]."""
    return force[0] * contact.sin_steer + force[1] * contact.cos_steer


def forward(contact: Contact, force: Pair) -> float:
    """Return the component forward along the body [N] of a force along and across the wheel [N]."""
    return force[0] * contact.cos_steer - force[1] * contact.sin_steer


def roll_steer(roll: float, constants: Constants) -> tuple[float, float, float, float]:
    """Return cosine and sine of the roll steer of the front wheels, then of the rear ones, at a roll angle [rad]."""
    cos_front, sin_front = cos_sin(constants.front_roll_steer * roll)
    cos_rear, sin_rear = cos_sin(constants.rear_roll_steer * roll)
    return cos_front, sin_front, cos_rear, sin_rear


def wheel_contacts(
    state: State, inputs: Inputs, environment: Environment, constants: Constants, constant_speed: bool
) -> Contacts:
    """Return the wheels at their set-points; parameters as in `evaluation`."""
    loads = static_loads(constants, environment.bank)
    drive = NO_DRIVE if constant_speed else inputs.drive_force
    angle, gain, friction = inputs.steer_angle, inputs.slip_gain, environment.friction
    return (
        _contact(state, 0, state.front_left, angle[0], drive[0], gain[0], loads[0], friction[0], constants),
        _contact(state, 1, state.front_right, angle[1], drive[1], gain[1], loads[1], friction[1], constants),
        _contact(state, 2, state.rear_left, angle[2], drive[2], gain[2], loads[2], friction[2], constants),
        _contact(state, 3, state.rear_right, angle[3], drive[3], gain[3], loads[3], friction[3], constants),
    )


def _contact(
    state: State,
    wheel: int,
    deflection: float,
    steer_angle: float,
    drive_force: float,
    slip_gain: float,
    load: float,
    friction: float,
    constants: Constants,
) -> Contact:
    cos, sin = cos_sin(steer_angle)
    along = state.vx - constants.wheel_y[wheel] * state.r
    across = state.vy + constants.wheel_x[wheel] * state.r
    v_long, v_lat = along * cos + across * sin, across * cos - along * sin
    share = 0.0 * slip_gain
    if anywhere(slip_gain > 0.0):
        share = trim_share(slip_gain, norm(along, across))
    return Contact(v_long, v_lat, deflection, drive_force, load, max(0.0, friction), cos, sin, share)


def body_force_and_moment(contacts: Contacts, forces: WheelForces, constants: Constants) -> Pair:
    """Return the forward force [N] and the yaw moment [N m] of all tyres.

    Parameters
    ----------
    contacts
        The wheels at their real steer angles.
    forces
        Along and across each wheel [N].
    constants
        The vehicle.
    """
    fl, fr, rl, rr = contacts
    force_fl, force_fr, force_rl, force_rr = forces
    x, y = constants.wheel_x, constants.wheel_y
    forward_fl, forward_fr = forward(fl, force_fl), forward(fr, force_fr)
    forward_rl, forward_rr = forward(rl, force_rl), forward(rr, force_rr)
    front = x[0] * leftward(fl, force_fl) - y[0] * forward_fl + x[1] * leftward(fr, force_fr) - y[1] * forward_fr
    rear = x[2] * leftward(rl, force_rl) - y[2] * forward_rl + x[3] * leftward(rr, force_rr) - y[3] * forward_rr
    return forward_fl + forward_fr + forward_rl + forward_rr, front + rear


def use_of_friction(contact: Contact, force: Pair, load: float) -> float:
    """Return the size of a force in the road plane over friction times load [N]; 0 for a wheel in the air."""
    capacity = contact.friction * load
    return select(capacity > 0.0, norm(force[0], force[1]) / positive(capacity), 0.0)
