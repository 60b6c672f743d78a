"""Which drives a campaign makes: each shipped fault alone, then random pairs of faults; from a seed."""

from dataclasses import replace
from random import Random
from typing import Any, NamedTuple

from omni_vehicle_ros.faults import COMPONENTS, KINDS, PROCESSES, kind_of
from omni_vehicle_ros.run import MODES
from omni_vehicle_ros.scenarios import Scenario, load_scenario, scenario_names
from omni_vehicle_ros.scenarios.scenario import make_scenario

MIXED = 'mixed'
CAMPAIGN_MODES = (MIXED, *MODES)

SHARES = {'offline': 0.6, 'one-process': 0.2, 'processes': 0.2}
"""Of the modes in a mixed campaign, among drives in which no process fails."""

ALONE = 'faults/'
LONGEST = 4.0
DURATIONS = (2.5, 3.0, 3.5)
WATCHED = 1.5
"""Time from the last fault to the end of a drive, at least [s]."""

JUMP = 0.1
"""A clock that jumps ahead by less does not differ from one of which messages were lost [s]."""

MANOEUVRES = ('turn', 'lane change', 'straight')


class Drive(NamedTuple):
    """One drive of a campaign.

    Attributes
    ----------
    number
        From 1.
    mode
        One of `omni_vehicle_ros.run.MODES`.
    manoeuvre
        One of `MANOEUVRES`, or the name of a shipped scenario.
    scenario
        With all its faults.
    """

    number: int
    mode: str
    manoeuvre: str
    scenario: Scenario


def draw(runs: int, seed: int, mode: str) -> list[Drive]:
    """Return the drives of a campaign; those of a longer one begin with the same.

    Parameters
    ----------
    runs
        How many.
    seed
        Of all that is random. Each drive has its own stream of numbers.
    mode
        One of `CAMPAIGN_MODES`.
    """
    alone = [name for name in scenario_names() if name.startswith(ALONE)]
    return [_drive(number, f'{seed}/{number}', mode, alone) for number in range(1, runs + 1)]


def _drive(number: int, seed: str, mode: str, alone: list[str]) -> Drive:
    random = Random(seed)
    if number <= len(alone):
        manoeuvre = alone[number - 1]
        scenario = load_scenario(manoeuvre)
        last = max(event.at for event in scenario.faults)
        scenario = replace(scenario, duration=min(scenario.duration, max(LONGEST, last + WATCHED)))
    else:
        manoeuvre = random.choice(MANOEUVRES)
        scenario = _random_scenario(random, number, manoeuvre)
    return Drive(number, _mode(random, scenario) if mode == MIXED else mode, manoeuvre, scenario)


def _mode(random: Random, scenario: Scenario) -> str:
    """Return how to run a drive: in processes wherever one of them fails."""
    if any(event.fault.component in PROCESSES for event in scenario.faults):
        return 'processes'
    return random.choices(tuple(SHARES), tuple(SHARES.values()))[0]


def _random_scenario(random: Random, number: int, manoeuvre: str) -> Scenario:
    duration = random.choice(DURATIONS)
    speed, radius = round(random.uniform(2.0, 6.0), 2), round(random.uniform(10.0, 20.0), 2)
    first, second = _components(random)
    faults = [_fault(random, component, duration - WATCHED) for component in (first, second)]
    return make_scenario(
        f'campaign_{number}',
        {
            'duration': duration,
            'side_slip_control': True,
            'plant': {'initial_speed': speed},
            'steering': {'fault_reaction': number % 2 == 0},
            'side_slip': {'fault_reaction': number % 2 == 0},
            'commands': _commands(manoeuvre, speed, radius),
            'faults': sorted(faults, key=lambda fault: float(fault['at'])),
        },
    )


def _components(random: Random) -> list[str]:
    """Return two components, each kind as likely as the others: most components are messages."""
    kinds = random.choices(tuple(KINDS), k=2)
    first = random.choice([component for component in COMPONENTS if kind_of(component) == kinds[0]])
    others = [c for c in COMPONENTS if c != first and kind_of(c) == kinds[1]]
    return [first, random.choice(others or [c for c in COMPONENTS if c != first])]


def _fault(random: Random, component: str, latest: float) -> dict[str, Any]:
    """Return a fault in words of a scenario: half of them with their default, and a third of them over before long."""
    kind = kind_of(component)
    failure = random.choice(tuple(KINDS[kind]))
    fault: dict[str, Any] = {'at': round(random.uniform(0.5, latest), 2), 'component': component, 'failure': failure}
    late = kind == 'process' and failure == 'delayed'
    if KINDS[kind][failure].default is not None and random.random() < 0.5:
        fault['value'] = round(_value(random, kind, failure), 3)
    if late or (kind not in ('process', 'clock') and random.random() < 1.0 / 3.0):
        fault['for'] = round(random.uniform(0.2, 0.8), 2)
    return fault


def _value(random: Random, kind: str, failure: str) -> float:
    _, default, _, low, high = KINDS[kind][failure]
    if kind == 'clock':
        return random.choice((-1.0, 1.0)) * random.uniform(JUMP, high)
    if kind == 'process' and default is not None:  # a second late in each cycle is in time for no limit of wall time
        return random.uniform(low, 2.0 * default)
    return random.uniform(low, high)


def _commands(manoeuvre: str, speed: float, radius: float) -> list[dict[str, Any]]:
    icrs: dict[str, list[tuple[float, Any]]] = {
        'straight': [(0.0, 'straight')],
        'turn': [(0.0, 'straight'), (0.3, [0.0, radius])],
        'lane change': [(0.0, 'straight'), (0.3, [0.0, radius]), (1.5, [0.0, -radius]), (2.7, 'straight')],
    }
    return [{'at': at, 'icr': icr, 'speed': speed} for at, icr in icrs[manoeuvre]]
