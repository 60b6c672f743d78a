"""Equations of motion with 8 degrees of freedom (after Boada et al. 2005, Vehicle System Dynamics 43(10)).

Longitudinal and lateral motion, yaw, roll of the sprung mass and the spin of the four wheels.

**Roll.** Body frame at the centre of gravity of the WHOLE vehicle, yawing but not rolling. The sprung mass
m_s turns by phi about a level axis, its centre h_s above that axis and over the centre of gravity; the rest
of the mass m does not roll. By its definition the centre of gravity keeps still between the two, so that, to
the first order in phi, the sprung mass stands at -(1 - m_s/m) h_s phi and everything that does not roll,
wheels included, at d phi, d = m_s h_s / m, both to the left. Split after Koenig, the kinetic energy has no
term linear in phi:

    2 T = m (vx^2 + vy^2) + Iz r^2 - 2 Ixz r p + J p^2,   J = Ixx - m_s^2 h_s^2 / m,   p = dphi/dt

with Ixx about the roll axis. The potential is 2 V = (K_phi - m_s g h_s) phi^2, dissipation C_phi p. Gravity
across a banked road acts at the centre of gravity and so does no work in phi; nor does the wind, which the
thesis lets act there. The force (Fx_i, Fy_i) of the road moves with its wheel, at the velocity
(vx - y_i r, vy + x_i r + d p). Lagrange's equations in the yawing frame are then

    m (dvx/dt - vy r) = sum Fx_i
    m (dvy/dt + vx r) = sum Fy_i + bank + wind,   ay = sum Fy_i / m
    Iz dr/dt - Ixz dp/dt = sum (x_i Fy_i - y_i Fx_i) + wind moment
    J dp/dt - Ixz dr/dt = m_s h_s ay - (K_phi - m_s g h_s) phi - C_phi p

Constant mass matrix, and power of the road + bank + wind = d(T + V)/dt + C_phi p^2 without remainder. Steady,
the last line is phi = m_s ay h_s / (K_phi - m_s g h_s) (thesis eq. 2.8): both bodies then agree.

**Loads.** Springs, dampers and roll centres move load from the left to the right wheel of an axle, in front
((K_f phi + C_f p) + m_s ay (lr / l) h_f) / Tf (thesis eq. 2.6, 2.7). The last part depends on the side forces
of the same instant, which depend on the loads: this loop is solved in every evaluation.

**Wheels.** Iw dw/dt = torque - R Fx, with combined slip: there is no friction circle to be switched.

**What differs from Boada's vehicle, and why.** It steers by its front wheels (thesis sec. 2.2.1); here all
four do, with the thesis's roll steer, and bank and wind act. Such models are mostly written for the velocity
of a point on the roll axis, which brings m_s h_s dp/dt into the lateral equation and does not conserve energy
unless the terms in r p and r^2 phi stay with it; the velocity of the centre of gravity needs none of them.
The loads do not shift with longitudinal acceleration, as in the thesis. Below walking pace see `rolling`.

**What is left out.** d phi in the lever arms of the road's forces, 4 cm at 1 g: it would make the steady turn
another than that of the plane. Gyroscopic moments of the wheels. And, as in the plane, the roll goes on with
its springs where a wheel has left the road.

Written in the part of Python that numba compiles, like the dynamics in the plane.
"""

import math
from typing import NamedTuple

from omni_vehicle_ros.model.contact import Contact, trimmed, turned
from omni_vehicle_ros.model.disturbances import bank_force, wind_force, wind_moment
from omni_vehicle_ros.model.dynamics import (
    NO_DRIVE,
    Contacts,
    Environment,
    Evaluation,
    Inputs,
    Pair,
    WheelForces,
    body_force_and_moment,
    leftward,
    roll_steer,
    trims,
    use_of_friction,
    wheel_contacts,
)
from omni_vehicle_ros.model.eight_dof.constants import EightDofConstants
from omni_vehicle_ros.model.eight_dof.rolling import Wheel, deflecting, side_slip, spin_rate, tyre_forces
from omni_vehicle_ros.model.eight_dof.state import EightDofState
from omni_vehicle_ros.model.loads import lifted, shifted_loads
from omni_vehicle_ros.model.loop import solve_loop
from omni_vehicle_ros.model.state import State
from omni_vehicle_ros.wheels import PerWheel


class Wheels(NamedTuple):
    """The wheels, and the load that springs and dampers move to the right on the front and rear axle [N]."""

    front_left: Wheel
    front_right: Wheel
    rear_left: Wheel
    rear_right: Wheel
    front_shift: float
    rear_shift: float


def evaluation(
    state: EightDofState,
    inputs: Inputs,
    environment: Environment,
    constants: EightDofConstants,
    constant_speed: bool,
) -> Evaluation:
    """Return slips, forces and loads at one instant, as the evaluation in the plane does."""
    set_points = _set_points(state, inputs, environment, constants, constant_speed)
    added = trims(set_points, state.roll, constants.plane)
    wheels = _wheels(set_points, state, constants)
    ay, forces = _solve(wheels, constants)
    fl, fr, rl, rr, _, _ = wheels
    force_fl, force_fr, force_rl, force_rr = forces
    loads = _loads(ay, wheels, constants)
    angle, contacts = inputs.steer_angle, _contacts_of(wheels)
    return Evaluation(
        steer_angle=(angle[0] + added[0], angle[1] + added[1], angle[2] + added[2], angle[3] + added[3]),
        side_slip=(
            side_slip(fl, constants),
            side_slip(fr, constants),
            side_slip(rl, constants),
            side_slip(rr, constants),
        ),
        longitudinal_force=(force_fl[0], force_fr[0], force_rl[0], force_rr[0]),
        lateral_force=(force_fl[1], force_fr[1], force_rl[1], force_rr[1]),
        vertical_load=loads,
        friction_use=(
            use_of_friction(fl.contact, force_fl, loads[0]),
            use_of_friction(fr.contact, force_fr, loads[1]),
            use_of_friction(rl.contact, force_rl, loads[2]),
            use_of_friction(rr.contact, force_rr, loads[3]),
        ),
        lifted=lifted(loads, constants.plane),
        roll_angle=state.roll,
        ax=body_force_and_moment(contacts, forces, constants.plane)[0] / constants.plane.mass,
        ay=ay,
    )


def state_rate(
    state: EightDofState,
    inputs: Inputs,
    environment: Environment,
    constants: EightDofConstants,
    constant_speed: bool,
) -> EightDofState:
    """Return the time derivative of every entry of the state."""
    plane = constants.plane
    wheels = _wheels(_set_points(state, inputs, environment, constants, constant_speed), state, constants)
    ay, forces = _solve(wheels, constants)
    force_x, moment = body_force_and_moment(_contacts_of(wheels), forces, plane)
    wind = wind_force(environment.wind, state.vx, plane)
    side_force = bank_force(environment.bank, plane) + wind
    yaw_acceleration, roll_acceleration = _angular(moment + wind_moment(wind, plane), ay, state, constants)
    cos_psi, sin_psi = math.cos(state.psi), math.sin(state.psi)
    spin, long_deflection, lat_deflection = _wheel_rates(wheels, forces, inputs, constants, constant_speed)
    return EightDofState(
        0.0 if constant_speed else force_x / plane.mass + state.vy * state.r,
        ay + side_force / plane.mass - state.vx * state.r,
        yaw_acceleration,
        state.vx * cos_psi - state.vy * sin_psi,
        state.vx * sin_psi + state.vy * cos_psi,
        state.r,
        state.roll_rate,
        roll_acceleration,
        spin,
        long_deflection,
        lat_deflection,
    )


def _angular(moment: float, ay: float, state: EightDofState, constants: EightDofConstants) -> Pair:
    """Return yaw and roll acceleration [rad/s2]: the two lines of the mass matrix that Ixz couples."""
    rolling = (
        constants.roll_coupling * ay
        - constants.net_roll_stiffness * state.roll
        - constants.roll_damping * state.roll_rate
    )
    yaw_inertia, roll_inertia, product = constants.plane.yaw_inertia, constants.roll_inertia, constants.roll_yaw_inertia
    determinant = yaw_inertia * roll_inertia - product * product
    return (
        (roll_inertia * moment + product * rolling) / determinant,
        (yaw_inertia * rolling + product * moment) / determinant,
    )


def _wheel_rates(
    wheels: Wheels,
    forces: WheelForces,
    inputs: Inputs,
    constants: EightDofConstants,
    constant_speed: bool,
) -> tuple[PerWheel, PerWheel, PerWheel]:
    """Return the rates of spins, longitudinal and lateral deflections."""
    fl, fr, rl, rr, _, _ = wheels
    drive = NO_DRIVE if constant_speed else inputs.drive_force
    rate_fl, rate_fr = deflecting(fl, constants), deflecting(fr, constants)
    rate_rl, rate_rr = deflecting(rl, constants), deflecting(rr, constants)
    return (
        (
            spin_rate(fl, drive[0], forces[0][0], constants),
            spin_rate(fr, drive[1], forces[1][0], constants),
            spin_rate(rl, drive[2], forces[2][0], constants),
            spin_rate(rr, drive[3], forces[3][0], constants),
        ),
        (rate_fl.long_rate, rate_fr.long_rate, rate_rl.long_rate, rate_rr.long_rate),
        (rate_fl.lat_rate, rate_fr.lat_rate, rate_rl.lat_rate, rate_rr.lat_rate),
    )


def _solve(wheels: Wheels, constants: EightDofConstants) -> tuple[float, WheelForces]:
    """Return the lateral acceleration [m/s2] that its own loads cause, and the tyre forces."""
    fl, fr, rl, rr = _contacts_of(wheels)
    grip = fl.friction * fl.load + fr.friction * fr.load + rl.friction * rl.load + rr.friction * rr.load
    # Each wheel may carry its whole axle.
    return solve_loop(_response, 2.0 * grip / constants.plane.mass, wheels, constants)


def _response(ay: float, wheels: Wheels, constants: EightDofConstants) -> tuple[float, WheelForces]:
    """Return the lateral acceleration and the forces of tyres loaded as by ``ay``."""
    fl, fr, rl, rr, _, _ = wheels
    load_fl, load_fr, load_rl, load_rr = _loads(ay, wheels, constants)
    force_fl, force_fr = tyre_forces(fl, load_fl, constants), tyre_forces(fr, load_fr, constants)
    force_rl, force_rr = tyre_forces(rl, load_rl, constants), tyre_forces(rr, load_rr, constants)
    front = leftward(fl.contact, force_fl) + leftward(fr.contact, force_fr)
    rear = leftward(rl.contact, force_rl) + leftward(rr.contact, force_rr)
    return (front + rear) / constants.plane.mass, (force_fl, force_fr, force_rl, force_rr)


def _loads(ay: float, wheels: Wheels, constants: EightDofConstants) -> PerWheel:
    fl, _, rl, _, front_shift, rear_shift = wheels
    front, rear = front_shift + constants.front_link * ay, rear_shift + constants.rear_link * ay
    return shifted_loads(front, rear, fl.contact.load, rl.contact.load)


def _contacts_of(wheels: Wheels) -> Contacts:
    fl, fr, rl, rr, _, _ = wheels
    return fl.contact, fr.contact, rl.contact, rr.contact


def _set_points(
    state: EightDofState,
    inputs: Inputs,
    environment: Environment,
    constants: EightDofConstants,
    constant_speed: bool,
) -> Contacts:
    """Return the wheels at the angles of the modules, moving with the body that roll pushes aside."""
    lat = state.lat_deflection
    across = state.vy + constants.roll_shift * state.roll_rate
    frame = State(
        state.vx, across, state.r, state.x, state.y, state.psi, lat[0], lat[1], lat[2], lat[3]
    )
    return wheel_contacts(frame, inputs, environment, constants.plane, constant_speed)


def _wheels(set_points: Contacts, state: EightDofState, constants: EightDofConstants) -> Wheels:
    fl, fr, rl, rr = set_points
    cos_front, sin_front, cos_rear, sin_rear = roll_steer(state.roll, constants.plane)
    roll, rate = state.roll, state.roll_rate
    return Wheels(
        _wheel(fl, 0, cos_front, sin_front, state, constants),
        _wheel(fr, 1, cos_front, sin_front, state, constants),
        _wheel(rl, 2, cos_rear, sin_rear, state, constants),
        _wheel(rr, 3, cos_rear, sin_rear, state, constants),
        constants.front_spring * roll + constants.front_damper * rate,
        constants.rear_spring * roll + constants.rear_damper * rate,
    )


def _wheel(
    set_point: Contact,
    number: int,
    cos_roll: float,
    sin_roll: float,
    state: EightDofState,
    constants: EightDofConstants,
) -> Wheel:
    steered = trimmed(set_point, cos_roll, sin_roll)
    v_long, v_lat = turned(steered, cos_roll, sin_roll)
    contact = Contact(
        v_long,
        v_lat,
        steered.deflection,
        steered.drive_force,
        steered.load,
        steered.friction,
        steered.cos_steer,
        steered.sin_steer,
        steered.trim_share,
    )
    return Wheel(contact, constants.wheel_radius * state.spin[number], state.long_deflection[number])

