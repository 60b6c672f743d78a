"""The body in the plane: 3 degrees of freedom, or 2 at a held speed (thesis B.9-B.12 and sec. 3.1).

Lateral acceleration, wheel loads, roll steer and side forces depend on each other at the same instant. This
algebraic loop is solved in every evaluation, so that the answer depends neither on the step nor on the past.
"""

import math
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.contact import Contact, deflection_rate, side_slip, turned, wheel_force
from omni_vehicle_ros.model.disturbances import bank_force, wind_force, wind_moment
from omni_vehicle_ros.model.integrate import Vector
from omni_vehicle_ros.model.loads import lifted, roll_angle, static_loads, vertical_loads
from omni_vehicle_ros.model.state import State, state_view
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


def evaluate(
    state: Vector, inputs: Inputs, environment: Environment, constants: Constants, constant_speed: bool = False
) -> Evaluation:
    """Return slips, forces and loads at one instant.

    Parameters
    ----------
    state
        State vector, shape (10,); see `State`.
    inputs, environment, constants
        What the wheels do, what acts on the vehicle, and the vehicle.
    constant_speed
        The 2-degree-of-freedom model: drive forces are left out.
    """
    contacts = _contacts(state_view(state), inputs, environment, constants, constant_speed)
    ay, forces = solve_loop(contacts, constants)
    loads = vertical_loads(ay, contacts[0].load, contacts[2].load, constants)
    cos_front, sin_front, cos_rear, sin_rear = _roll_steer(ay, constants)
    fl, fr, rl, rr = contacts
    return Evaluation(
        side_slip=(
            side_slip(fl, cos_front, sin_front, constants),
            side_slip(fr, cos_front, sin_front, constants),
            side_slip(rl, cos_rear, sin_rear, constants),
            side_slip(rr, cos_rear, sin_rear, constants),
        ),
        longitudinal_force=(forces[0][0], forces[1][0], forces[2][0], forces[3][0]),
        lateral_force=(forces[0][1], forces[1][1], forces[2][1], forces[3][1]),
        vertical_load=loads,
        friction_use=(
            _friction_use(fl, forces[0], loads[0]),
            _friction_use(fr, forces[1], loads[1]),
            _friction_use(rl, forces[2], loads[2]),
            _friction_use(rr, forces[3], loads[3]),
        ),
        lifted=lifted(loads, constants),
        roll_angle=roll_angle(ay, constants),
        ax=_body_force_and_moment(contacts, forces, constants)[0] / constants.mass,
        ay=ay,
    )


def derivative(
    state: Vector, inputs: Inputs, environment: Environment, constants: Constants, constant_speed: bool = False
) -> Vector:
    """Return the time derivative of the state, shape (10,) (thesis B.9, B.10).

    Parameters
    ----------
    state, inputs, environment, constants
        As in `evaluate`.
    constant_speed
        Hold vx and leave out the drive forces (thesis sec. 3.1) instead of integrating vx.
    """
    now = state_view(state)
    contacts = _contacts(now, inputs, environment, constants, constant_speed)
    ay, forces = solve_loop(contacts, constants)
    fl, fr, rl, rr = contacts
    force_x, _, moment = _body_force_and_moment(contacts, forces, constants)
    wind = wind_force(environment.wind, now.vx, constants)
    side_force = bank_force(environment.bank, constants) + wind
    cos_front, sin_front, cos_rear, sin_rear = _roll_steer(ay, constants)
    cos_psi, sin_psi = math.cos(now.psi), math.sin(now.psi)
    return np.array(
        (
            0.0 if constant_speed else force_x / constants.mass + now.vy * now.r,
            ay + side_force / constants.mass - now.vx * now.r,
            (moment + wind_moment(wind, constants)) / constants.yaw_inertia,
            now.vx * cos_psi - now.vy * sin_psi,
            now.vx * sin_psi + now.vy * cos_psi,
            now.r,
            deflection_rate(fl, *turned(fl, cos_front, sin_front), constants),
            deflection_rate(fr, *turned(fr, cos_front, sin_front), constants),
            deflection_rate(rl, *turned(rl, cos_rear, sin_rear), constants),
            deflection_rate(rr, *turned(rr, cos_rear, sin_rear), constants),
        )
    )


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


def _body_force_and_moment(
    contacts: Contacts, forces: WheelForces, constants: Constants
) -> tuple[float, float, float]:
    total_x = total_y = moment = 0.0
    for contact, (traction, lateral), x, y in zip(contacts, forces, constants.wheel_x, constants.wheel_y, strict=True):
        force_x = traction * contact.cos_steer - lateral * contact.sin_steer
        force_y = traction * contact.sin_steer + lateral * contact.cos_steer
        total_x += force_x
        total_y += force_y
        moment += x * force_y - y * force_x
    return total_x, total_y, moment


def _friction_use(contact: Contact, force: Pair, load: float) -> float:
    capacity = contact.friction * load
    return math.hypot(force[0], force[1]) / capacity if capacity > 0.0 else 0.0
