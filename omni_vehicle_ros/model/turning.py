"""A vehicle whose wheels stand still while its forward speed is held, and what its steady turns are like.

The wheels stand as an ICR beside the centre of gravity wants them, and vx is held (thesis sec. 3.1). A steady turn is
a twist whose vy and r do not change: a root of the equations of motion. Of a body with more degrees of freedom, the
steady turns are the same.
"""

import math
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.errors import CommandError
from omni_vehicle_ros.model.body import Environment, Inputs, derivative, evaluate
from omni_vehicle_ros.model.constants import Constants, constants
from omni_vehicle_ros.model.continuation import Curve, Point
from omni_vehicle_ros.model.kinematics import Icr, Twist, steer_angles, twist_of_icr
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.model.tyres.region import Region, region
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

SPEED_UNIT = 5.0  # m/s, of the first unknown: bends a curve about as much as 1 rad of slip does
SIDEWAYS = 2.0  # vy over vx from which on a vehicle skids rather than turns

_ACTING = [1, 2, 6, 7, 8, 9]  # vy, r and the deflections, in the state
_WEIGHTS = np.array((1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0))  # the deflections only follow
_STRAIGHT_AHEAD: PerWheel = (0.0, 0.0, 0.0, 0.0)


class SteadyTurn(NamedTuple):
    """A steady turn; fl, fr, rl, rr where per wheel.

    ``twist``: of the centre of gravity [m/s, m/s, rad/s]; ``side_slip`` [rad]; ``vertical_load`` [N];
    ``friction_use`` [1]; ``region``: where on its curve each tyre works; ``lifted``: whether a wheel carries nothing,
    past which the model says little; ``lateral_acceleration``: of the tyre forces [m/s2]; ``path_radius``: of the
    centre of gravity [m], positive to the left, inf on a straight path; ``eigenvalues`` of (vy, r) [1/s], with the
    deflections of slow tyres in equilibrium; ``residual``: largest rate that is left of vy [m/s2] and r [rad/s2].
    """

    twist: Twist
    side_slip: PerWheel
    vertical_load: PerWheel
    friction_use: PerWheel
    region: tuple[Region, Region, Region, Region]
    lifted: bool
    lateral_acceleration: float
    path_radius: float
    eigenvalues: tuple[complex, complex]
    residual: float

    @property
    def stable(self) -> bool:
        """Whether every small disturbance decays."""
        return self.decay_rate > 0.0

    @property
    def decay_rate(self) -> float:
        """Rate at which a small disturbance decays in the end [1/s]; negative if it grows."""
        return -max(value.real for value in self.eigenvalues)

    @property
    def damping_ratio(self) -> float | None:
        """Damping ratio of both eigenvalues together, 1 or more without oscillation; None for a saddle."""
        first, second = self.eigenvalues
        square = (first * second).real
        return -0.5 * (first + second).real / math.sqrt(square) if square > 0.0 else None

    @property
    def slides(self) -> bool:
        """Whether both tyres of an axle slide, where more slip gives no more force; it may be stable all the same."""
        front_left, front_right, rear_left, rear_right = (place is Region.SLIDING for place in self.region)
        return (front_left and front_right) or (rear_left and rear_right)

    @property
    def skids(self) -> bool:
        """Whether the vehicle moves sideways rather than forward, at a side slip of the body of 63 deg or more."""
        return abs(self.twist.vy) >= SIDEWAYS * self.twist.vx


class Turning(NamedTuple):
    """A vehicle, its wheels held as an ICR at ``radius`` [m] to its left wants them, and its road; made by `turning`.

    A place has the 7 coordinates vx / `SPEED_UNIT`, vy / vx, ``wheelbase`` r / vx and, by wheel, the deflection of
    the tyre over its relaxation length, all without unit.
    """

    constants: Constants
    inputs: Inputs
    environment: Environment
    wheelbase: float
    radius: float

    @property
    def curve(self) -> Curve:
        """The places of all steady turns; their parameter is the speed."""
        return Curve(self.rates, _WEIGHTS)

    def level(self, speed: float) -> float:
        """Return the first coordinate of a speed [m/s]."""
        return speed / SPEED_UNIT

    def creeping(self, speed: float) -> Point | None:
        """Return the steady turn at a speed that is next to none [m/s], or None if there is no grip for it."""
        return self.curve.at(np.array((self.level(speed), 0.0, self.wheelbase / self.radius, 0.0, 0.0, 0.0, 0.0)))

    def near(self, twist: Twist) -> SteadyTurn | None:
        """Return the steady turn that Newton's method finds from a motion, at its forward speed; None without one."""
        slopes = twist.vy / twist.vx, self.wheelbase * twist.r / twist.vx
        found = self.curve.at(np.array((self.level(twist.vx), *slopes, 0.0, 0.0, 0.0, 0.0)))
        return None if found is None else self.turn(found)

    def rates(self, place: Vector) -> Vector:
        """Return what is 0 in a steady turn: the rates of vy, r and the deflections, shape (6,)."""
        rates = derivative(self._state(place), self.inputs, self.environment, self.constants, constant_speed=True)
        return rates[_ACTING]

    def turn(self, point: Point) -> SteadyTurn:
        """Return what a steady turn is like."""
        state = self._state(point.place)
        vx, vy, r = state[:3].tolist()
        found = evaluate(state, self.inputs, self.environment, self.constants, constant_speed=True)
        slip, load = found.side_slip, found.vertical_load
        return SteadyTurn(
            twist=Twist(vx, vy, r),
            side_slip=slip,
            vertical_load=load,
            friction_use=found.friction_use,
            region=per_wheel(lambda i: self._region(i, Twist(vx, vy, r), slip[i], load[i])),
            lifted=any(found.lifted),
            lateral_acceleration=found.ay,
            path_radius=math.hypot(vx, vy) / r if r != 0.0 else math.inf,
            eigenvalues=self._eigenvalues(point),
            residual=float(np.max(np.abs(self.rates(point.place)[:2]))),
        )

    def _state(self, place: Vector) -> Vector:
        speed, slope, curvature, *stretches = place.tolist()
        vx = SPEED_UNIT * speed
        deflections = (self.constants.relaxation_length * stretch for stretch in stretches)
        return np.array((vx, slope * vx, curvature * vx / self.wheelbase, 0.0, 0.0, 0.0, *deflections))

    def _region(self, wheel: int, twist: Twist, side_slip: float, load: float) -> Region:
        x, y = self.constants.wheel_x[wheel], self.constants.wheel_y[wheel]
        speed = math.hypot(twist.vx - y * twist.r, twist.vy + x * twist.r) * math.cos(side_slip)
        return region(side_slip, speed, self.environment.friction[wheel] * load, self.constants)

    def _eigenvalues(self, point: Point) -> tuple[complex, complex]:
        slopes = point.slopes[:, 1:]
        body = slopes[:2, :2] - slopes[:2, 2:] @ np.linalg.solve(slopes[2:, 2:], slopes[2:, :2])
        first, second = np.linalg.eigvals(body * (1.0, self.wheelbase) / speed_of(point))
        return complex(first), complex(second)


def speed_of(point: Point) -> float:
    """Return the forward speed at a point [m/s]."""
    return SPEED_UNIT * float(point.place[0])


def turning(vehicle: VehicleParameters, radius: float, environment: Environment) -> Turning:
    """Make the vehicle with its wheels turned by the road rule about an ICR beside the centre of gravity.

    Parameters
    ----------
    vehicle
        The vehicle.
    radius
        Distance of the ICR to the left of the centre of gravity [m]; negative to the right, inf straight on.
    environment
        Bank, wind and friction.

    Raises
    ------
    CommandError
        A wheel would have to turn by more than 90 deg, as the ICR lies within the track.
    """
    angles = _STRAIGHT_AHEAD
    if not math.isinf(radius):
        steering = steer_angles(twist_of_icr(Icr(0.0, radius), 1.0), angles, math.pi, vehicle, 'road')
        if not all(steering.reachable):
            nearest = 0.5 * max(vehicle.front_track, vehicle.rear_track)
            raise CommandError(f'radius: {radius:g} m must be beyond half of the track, {nearest:g} m')
        angles = steering.angles
    return Turning(constants(vehicle), Inputs(angles), environment, vehicle.wheelbase, radius)
