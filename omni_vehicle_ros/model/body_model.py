"""What a body is to those who drive it: one small interface, whatever moves behind it."""

import math
from collections.abc import Callable, Collection
from typing import Protocol

from omni_vehicle_ros.model import body, plant
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.dynamics import Environment, Evaluation, Inputs
from omni_vehicle_ros.model.eight_dof import state as eight_dof_state
from omni_vehicle_ros.model.eight_dof import vehicle as eight_dof
from omni_vehicle_ros.model.eight_dof.constants import eight_dof_constants
from omni_vehicle_ros.model.state import Vector, initial_state, state_view
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, as_four, per_wheel

SLIDING_PACE = 0.1
"""Speed below which the friction of a locked wheel fades [m/s]: slow enough for one control cycle to stop nothing."""


class BodyModel(Protocol):
    """A vehicle that moves. Its state is a vector that begins with vx, vy, r, x, y and psi, as in `State`."""

    def initial_state(self, speed: float) -> Vector:
        """Return the state of a vehicle that rolls straight on through the origin of odom.

        Parameters
        ----------
        speed
            Forward speed [m/s].
        """

    def advance(
        self,
        state: Vector,
        inputs: Inputs,
        steer_rate: PerWheel,
        environment: Environment,
        duration: float,
        step: float,
        constant_speed: bool = False,
    ) -> Vector:
        """Return the state after one control cycle; it is finite whenever the input is.

        Parameters
        ----------
        state
            State at the start; left as it is.
        inputs, steer_rate
            What the wheel modules do at the start, and the rates of the steer angles, held [rad/s].
        environment
            What acts on the vehicle.
        duration, step
            Length of the cycle and longest integration step [s].
        constant_speed
            Hold vx; drive forces are left out.
        """

    def evaluate(
        self, state: Vector, inputs: Inputs, environment: Environment, constant_speed: bool = False
    ) -> Evaluation:
        """Return slips, forces and loads at one instant; parameters as in `advance`."""

    def wheel_speeds(self, state: Vector, steer_angle: PerWheel) -> PerWheel:
        """Return the spins of the wheels [rad/s].

        Parameters
        ----------
        state
            State vector.
        steer_angle
            Real steer angles [rad].
        """

    def locked(self, state: Vector, wheels: Collection[int]) -> Vector:
        """Return the state with the spins of locked wheels stopped, where they are part of it.

        Parameters
        ----------
        state
            State vector; left as it is.
        wheels
            Numbers of the locked wheels.
        """

    def locking_force(self, wheel: int, state: Vector, now: Evaluation, friction: float) -> float:
        """Return the force of a brake along a wheel that keeps it from turning [N].

        Parameters
        ----------
        wheel
            Its number.
        state, now
            Of the vehicle with the wheel stopped.
        friction
            Under the wheel.
        """


class YawPlane:
    """Motion in the plane, 3 degrees of freedom or 2; roll follows at once, wheels roll without slip."""

    def __init__(self, vehicle: VehicleParameters) -> None:
        self._vehicle = vehicle
        self._constants = constants(vehicle)

    def initial_state(self, speed: float) -> Vector:
        """Return the state of a vehicle that rolls straight on; see `BodyModel`."""
        return initial_state(speed)

    def advance(
        self,
        state: Vector,
        inputs: Inputs,
        steer_rate: PerWheel,
        environment: Environment,
        duration: float,
        step: float,
        constant_speed: bool = False,
    ) -> Vector:
        """Return the state after one control cycle; see `BodyModel`."""
        angle, force, gain = inputs
        model = self._constants
        return plant.advance(
            state, angle, steer_rate, force, environment, model, duration, step, constant_speed, gain
        )

    def evaluate(
        self, state: Vector, inputs: Inputs, environment: Environment, constant_speed: bool = False
    ) -> Evaluation:
        """Return slips, forces and loads at one instant; see `BodyModel`."""
        return body.evaluate(state, inputs, environment, self._constants, constant_speed)

    def wheel_speeds(self, state: Vector, steer_angle: PerWheel) -> PerWheel:
        """Return the speeds over ground along the wheels, over the radius; see `BodyModel`."""
        vx, vy, r = state[:3].tolist()
        radius, places = self._vehicle.wheel_radius, zip(self._vehicle.wheel_x, self._vehicle.wheel_y, strict=True)
        return as_four([
            (math.cos(angle) * (vx - y * r) + math.sin(angle) * (vy + x * r)) / radius
            for angle, (x, y) in zip(steer_angle, places, strict=True)
        ])

    def locked(self, state: Vector, wheels: Collection[int]) -> Vector:
        """Return the state as it is: the spins are no part of it; see `BodyModel`."""
        return state

    def locking_force(self, wheel: int, state: Vector, now: Evaluation, friction: float) -> float:
        """Return the part along the wheel of the friction of a locked wheel, which is against its motion.

        The friction circle leaves the rest to the side force. Below `SLIDING_PACE` friction fades, to nothing at
        rest; see `BodyModel`.
        """
        view, angle = state_view(state), now.steer_angle[wheel]
        along = view.vx - self._vehicle.wheel_y[wheel] * view.r
        across = view.vy + self._vehicle.wheel_x[wheel] * view.r
        rolling = along * math.cos(angle) + across * math.sin(angle)
        return -friction * now.vertical_load[wheel] * rolling / max(math.hypot(along, across), SLIDING_PACE)


class EightDof:
    """Motion in the plane, roll and the spin of four wheels: 8 degrees of freedom, or 7 at a held speed."""

    def __init__(self, vehicle: VehicleParameters) -> None:
        self._constants = eight_dof_constants(vehicle)

    def initial_state(self, speed: float) -> Vector:
        """Return the state of a vehicle that rolls straight on; see `BodyModel`."""
        return eight_dof_state.initial_state(speed, self._constants.wheel_radius)

    def advance(
        self,
        state: Vector,
        inputs: Inputs,
        steer_rate: PerWheel,
        environment: Environment,
        duration: float,
        step: float,
        constant_speed: bool = False,
    ) -> Vector:
        """Return the state after one control cycle; see `BodyModel`."""
        return eight_dof.advance(
            state, inputs, steer_rate, environment, self._constants, duration, step, constant_speed
        )

    def evaluate(
        self, state: Vector, inputs: Inputs, environment: Environment, constant_speed: bool = False
    ) -> Evaluation:
        """Return slips, forces and loads at one instant; see `BodyModel`."""
        return eight_dof.evaluate(state, inputs, environment, self._constants, constant_speed)

    def wheel_speeds(self, state: Vector, steer_angle: PerWheel) -> PerWheel:
        """Return the spins of the wheels; see `BodyModel`."""
        return eight_dof_state.state_view(state).spin

    def locked(self, state: Vector, wheels: Collection[int]) -> Vector:
        """Return the state with the spins of locked wheels stopped; see `BodyModel`."""
        view = eight_dof_state.state_view(state)
        spin = per_wheel(lambda i: 0.0 if i in wheels else view.spin[i])
        return eight_dof_state.state_vector(view._replace(spin=spin))

    def locking_force(self, wheel: int, state: Vector, now: Evaluation, friction: float) -> float:
        """Return what the road does to the stopped wheel: a brake that holds as much lets it not turn."""
        return now.longitudinal_force[wheel]


BODY_MODELS: dict[str, Callable[[VehicleParameters], BodyModel]] = {'yaw_plane': YawPlane, 'eight_dof': EightDof}


def body_model(vehicle: VehicleParameters) -> BodyModel:
    """Return the body that the parameters name."""
    return BODY_MODELS[vehicle.body_model](vehicle)
