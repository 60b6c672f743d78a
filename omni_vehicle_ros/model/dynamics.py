"""Equations of motion in the plane: 3 degrees of freedom, or 2 at a held speed (thesis B.9-B.12 and sec. 3.1).

Lateral acceleration, wheel loads, roll steer and side forces depend on each other at the same instant. This
algebraic loop is solved in every evaluation, so that the answer depends neither on the step nor on the past.

Written in the part of Python that numba compiles (see `compiled`); users call `body` and `plant`.
"""

import math
from typing import NamedTuple

from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.contact import Contact, deflection_rate, side_slip, turned, wheel_force
from omni_vehicle_ros.model.disturbances import bank_force, wind_force, wind_moment
from omni_vehicle_ros.model.loads import lifted, roll_angle, static_loads, vertical_loads
from omni_vehicle_ros.model.state import State
from omni_vehicle_ros.wheels import PerWheel

LOOP_TOLERANCE = 1e-11  # of 1 m/s2 plus the acceleration
LOOP_STEPS = 12
BISECTIONS = 64
NO_DRIVE: PerWheel = (0.0, 0.0, 0.0, 0.0)

Contacts = tuple[Contact, Contact, Contact, Contact]
Pair = tuple[float, float]
WheelForces = tuple[Pair, Pair, Pair, Pair]  # longitudinal, lateral


class Inputs(NamedTuple):
    """What the wheel modules do: steer angles [rad] and drive forces along the wheels [N], fl, fr, rl, rr."""

    steer_angle: PerWheel
    drive_force: PerWheel = NO_DRIVE


class Environment(NamedTuple):
    """What the vehicle drives in: bank angle [rad], lateral wind [m/s], friction under each wheel.

    A positive bank pushes the vehicle, and a positive wind blows, to the left.
    """

    bank: float = 0.0
    wind: float = 0.0
    friction: PerWheel = (0.9, 0.9, 0.9, 0.9)


class Evaluation(NamedTuple):
    """Everything that follows from a state at one instant; fl, fr, rl, rr where per wheel.

    ``side_slip`` [rad], roll steer included; ``longitudinal_force`` and ``lateral_force`` in the wheel frame and
    ``vertical_load`` [N]; ``friction_use``: size of both forces over friction times load, 0 for a wheel in the
    air; ``lifted``; ``roll_angle`` [rad], positive to the right; ``ax``, ``ay``: tyre forces over mass, what an
    accelerometer at the centre of gravity feels [m/s2].
    """

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
    contacts = _contacts(state, inputs, environment, constants, constant_speed)
    ay, forces = solve_loop(contacts, constants)
    fl, fr, rl, rr = contacts
    force_fl, force_fr, force_rl, force_rr = forces
    loads = vertical_loads(ay, fl.load, rl.load, constants)
    cos_front, sin_front, cos_rear, sin_rear = _roll_steer(ay, constants)
    return Evaluation(
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
            _friction_use(fl, force_fl, loads[0]),
            _friction_use(fr, force_fr, loads[1]),
            _friction_use(rl, force_rl, loads[2]),
            _friction_use(rr, force_rr, loads[3]),
        ),
        lifted=lifted(loads, constants),
        roll_angle=roll_angle(ay, constants),
        ax=_body_force_and_moment(contacts, forces, constants)[0] / constants.mass,
        ay=ay,
    )


def state_rate(
    state: State, inputs: Inputs, environment: Environment, constants: Constants, constant_speed: bool
) -> State:
    """Return the time derivative of every entry of the state (thesis B.9, B.10); see `body.derivative`."""
    contacts = _contacts(state, inputs, environment, constants, constant_speed)
    ay, forces = solve_loop(contacts, constants)
    fl, fr, rl, rr = contacts
    force_x, moment = _body_force_and_moment(contacts, forces, constants)
    wind = wind_force(environment.wind, state.vx, constants)
    side_force = bank_force(environment.bank, constants) + wind
    cos_front, sin_front, cos_rear, sin_rear = _roll_steer(ay, constants)
    cos_psi, sin_psi = math.cos(state.psi), math.sin(state.psi)
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


def solve_loop(contacts: Contacts, constants: Constants) -> tuple[float, WheelForces]:
    """Return the lateral acceleration [m/s2] that its own loads and roll steer cause, and the tyre forces.

    Inverse quadratic interpolation from 0, where the loads are static; if it fails, bisection between the
    largest accelerations that friction allows. The start never depends on the past, so that the result is a
    function of the contacts.

    Parameters
    ----------
    contacts
        The wheels.
    constants
        The vehicle.
    """
    limit = _largest_acceleration(contacts, constants)
    guess = slope = last = gap_last = gap_before_last = 0.0
    for number in range(LOOP_STEPS):
        reached, forces = _response(guess, contacts, constants)
        gap = reached - guess
        if abs(gap) <= LOOP_TOLERANCE * (1.0 + abs(guess)):
            return reached, forces
        if number == 0:
            step = gap
        elif gap in (gap_last, gap_before_last):
            break
        else:
            # Newton's form of the inverse interpolation through the last points, taken at gap 0.
            slope_last, slope = slope, (guess - last) / (gap - gap_last)
            bend = (slope - slope_last) / (gap - gap_before_last) if number > 1 else 0.0
            step = gap * (gap_last * bend - slope)
        gap_before_last, gap_last, last = gap_last, gap, guess
        guess = max(-limit, min(limit, guess + step))
    return _bisect(limit, contacts, constants)


def _bisect(limit: float, contacts: Contacts, constants: Constants) -> tuple[float, WheelForces]:
    low, high = -limit, limit
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if _response(middle, contacts, constants)[0] > middle:
            low = middle
        else:
            high = middle
    return _response(0.5 * (low + high), contacts, constants)


def _largest_acceleration(contacts: Contacts, constants: Constants) -> float:
    # A wheel may carry its whole axle, and without the friction circle use its grip both ways.
    fl, fr, rl, rr = contacts
    grip = fl.friction * fl.load + fr.friction * fr.load + rl.friction * rl.load + rr.friction * rr.load
    return 3.0 * grip / constants.mass


def _response(ay: float, contacts: Contacts, constants: Constants) -> tuple[float, WheelForces]:
    """Return the lateral acceleration and the forces of tyres loaded and roll-steered as by ``ay``."""
    fl, fr, rl, rr = contacts
    cos_front, sin_front, cos_rear, sin_rear = _roll_steer(ay, constants)
    load_fl, load_fr, load_rl, load_rr = vertical_loads(ay, fl.load, rl.load, constants)
    force_fl = wheel_force(fl, cos_front, sin_front, load_fl, constants)
    force_fr = wheel_force(fr, cos_front, sin_front, load_fr, constants)
    force_rl = wheel_force(rl, cos_rear, sin_rear, load_rl, constants)
    force_rr = wheel_force(rr, cos_rear, sin_rear, load_rr, constants)
    total = _leftward(fl, force_fl) + _leftward(fr, force_fr) + _leftward(rl, force_rl) + _leftward(rr, force_rr)
    return total / constants.mass, (force_fl, force_fr, force_rl, force_rr)


def _leftward(contact: Contact, force: Pair) -> float:
    return force[0] * contact.sin_steer + force[1] * contact.cos_steer


def _roll_steer(ay: float, constants: Constants) -> tuple[float, float, float, float]:
    """Return cosine and sine of the roll steer of the front wheels, then of the rear ones."""
    roll = constants.roll_per_acceleration * ay
    front, rear = constants.front_roll_steer * roll, constants.rear_roll_steer * roll
    return math.cos(front), math.sin(front), math.cos(rear), math.sin(rear)


def _contacts(
    state: State, inputs: Inputs, environment: Environment, constants: Constants, constant_speed: bool
) -> Contacts:
    loads = static_loads(constants, environment.bank)
    drive = NO_DRIVE if constant_speed else inputs.drive_force
    angle, friction = inputs.steer_angle, environment.friction
    return (
        _contact(state, 0, state.front_left, angle[0], drive[0], loads[0], friction[0], constants),
        _contact(state, 1, state.front_right, angle[1], drive[1], loads[1], friction[1], constants),
        _contact(state, 2, state.rear_left, angle[2], drive[2], loads[2], friction[2], constants),
        _contact(state, 3, state.rear_right, angle[3], drive[3], loads[3], friction[3], constants),
    )


def _contact(
    state: State,
    wheel: int,
    deflection: float,
    steer_angle: float,
    drive_force: float,
    load: float,
    friction: float,
    constants: Constants,
) -> Contact:
    cos, sin = math.cos(steer_angle), math.sin(steer_angle)
    along = state.vx - constants.wheel_y[wheel] * state.r
    across = state.vy + constants.wheel_x[wheel] * state.r
    v_long, v_lat = along * cos + across * sin, across * cos - along * sin
    return Contact(v_long, v_lat, deflection, drive_force, load, max(0.0, friction), cos, sin)


def _body_force_and_moment(contacts: Contacts, forces: WheelForces, constants: Constants) -> Pair:
    """Return the forward force [N] and the yaw moment [N m] of all tyres."""
    forward = moment = 0.0
    for wheel in range(4):
        contact, force = contacts[wheel], forces[wheel]
        force_x = force[0] * contact.cos_steer - force[1] * contact.sin_steer
        forward += force_x
        moment += constants.wheel_x[wheel] * _leftward(contact, force) - constants.wheel_y[wheel] * force_x
    return forward, moment


def _friction_use(contact: Contact, force: Pair, load: float) -> float:
    capacity = contact.friction * load
    return math.hypot(force[0], force[1]) / capacity if capacity > 0.0 else 0.0
