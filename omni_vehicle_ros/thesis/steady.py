"""Tasks without runs: steady turns found directly, and the speed that a turn without drive leaves."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.model.body import Environment
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.kinematics import Icr, road_steer_angles
from omni_vehicle_ros.model.plant import advance
from omni_vehicle_ros.model.state import initial_state, state_view
from omni_vehicle_ros.model.steady_turn import Branch, Limit, steady_turns
from omni_vehicle_ros.scenarios import Scenario
from omni_vehicle_ros.thesis.tasks import Run, run

NO_RATE = NO_FORCE = (0.0, 0.0, 0.0, 0.0)


def branch(study: Run, radius: float, top_speed: float) -> Branch:
    """Return the steady turns of the vehicle of a study on its road, for a radius [m], up to a speed [m/s]."""
    scenario = study.load()
    return steady_turns(scenario.vehicle, radius, _road(scenario), top_speed)


def _road(scenario: Scenario) -> Environment:
    plant = scenario.plant
    return Environment(plant.bank, plant.wind, plant.friction)


def slips(turns: Branch, speed: float) -> list[float]:
    """Return the steady slips of the four wheels at a speed [rad], NaN past the limit of the turn."""
    lost = turns.limit.speed is not None and speed > turns.limit.speed
    turn = None if lost else turns.turn(speed)
    return [float('nan')] * 4 if turn is None else list(turn.side_slip)


class SlipMap(NamedTuple):
    """Steady slips over radius and speed.

    Attributes
    ----------
    radius
        Of the turns [m], shape (n,).
    speed, side_slip
        The speeds that were asked for [m/s], shape (k,), and the slips there [rad], shape (n, k, 4); NaN past the
        limit, where slow driving leads to no stable steady turn.
    top_speed
        Up to which speed it does, at most the largest of the above [m/s], shape (n,).
    mesh_speed, mesh_slip
        Speeds that end there [m/s], shape (n, m), and the slips [rad], shape (n, m, 4), without NaN; m may be 0.
    """

    radius: Array
    speed: Array
    side_slip: Array
    top_speed: Array
    mesh_speed: Array
    mesh_slip: Array


@dataclass(frozen=True)
class SlipMapTask:
    """The steady slips of a study.

    Attributes
    ----------
    study
        Whose vehicle and road count.
    radii
        Of the turns [m].
    speeds
        Rising [m/s].
    mesh
        How many speeds the mesh has at every radius.
    """

    study: Run
    radii: tuple[float, ...]
    speeds: tuple[float, ...]
    mesh: int = 0

    def work(self) -> SlipMap:
        """Find the steady turns."""
        branches = [branch(self.study, radius, self.speeds[-1]) for radius in self.radii]
        ends = [turns.end if turns.limit.speed is None else turns.limit.speed for turns in branches]
        tops = np.minimum(ends, self.speeds[-1])
        mesh = np.outer(tops, np.arange(1, self.mesh + 1) / max(self.mesh, 1))
        return SlipMap(
            radius=np.array(self.radii),
            speed=np.array(self.speeds),
            side_slip=np.array([[slips(turns, speed) for speed in self.speeds] for turns in branches]),
            top_speed=tops,
            mesh_speed=mesh,
            mesh_slip=np.array(
                [[slips(turns, speed) for speed in row] for turns, row in zip(branches, mesh, strict=True)]
            ),
        )


@dataclass(frozen=True)
class Limits:
    """Up to which speed slow driving leads to a stable steady turn, for each of some radii [m]."""

    study: Run
    radii: tuple[float, ...]
    top_speed: float

    def work(self) -> tuple[Limit, ...]:
        """Return the limits."""
        return tuple(branch(self.study, radius, self.top_speed).limit for radius in self.radii)


@dataclass(frozen=True)
class SpeedRatios:
    """Speeds after a turn without drive over those before it: no run each, but the compiled physics at once.

    Attributes
    ----------
    radius
        Commanded [m].
    speeds
        At the start [m/s].
    """

    radius: float
    speeds: tuple[float, ...]

    def work(self) -> Array:
        """Return the ratios, shape (len(speeds),)."""
        scenario = run('speed_loss', radius=self.radius).load()
        vehicle, plant = constants(scenario.vehicle), scenario.plant
        angles = road_steer_angles(Icr(0.0, self.radius), scenario.vehicle)

        def ratio(speed: float) -> float:
            state = advance(
                initial_state(speed),
                angles,
                NO_RATE,
                NO_FORCE,
                _road(scenario),
                vehicle,
                scenario.duration,
                plant.integration_step,
            )
            return state_view(state).vx / speed

        return np.array([ratio(speed) for speed in self.speeds])
