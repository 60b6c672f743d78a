"""Write the figures of docs/safety.md: the scenarios of faults, driven with and without the reaction."""

import math
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.components.component import Output
from omni_vehicle_ros.faults import Fault
from omni_vehicle_ros.interface import SIDE_SLIP_CONTROLLER
from omni_vehicle_ros.messages import Diagnostics, Joints, Odometry
from omni_vehicle_ros.scenarios import Scenario, load_scenario, scenario_names
from omni_vehicle_ros.simulation import Simulation
from omni_vehicle_ros.wheels import WHEELS

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'safety.md'
BEGIN, END = '<!-- figures: begin -->', '<!-- figures: end -->'
HEAD = (
    '| scenario | fault | named after | path error with | without | slip with | without '
    '| speed at the end with | without |\n'
    '| --- | --- | --- | --- | --- | --- | --- | --- | --- |'
)


class Drive(NamedTuple):
    """What a vehicle did: its places [m], largest side slip of a tyre, its speed [m/s], and what was said when."""

    path: np.ndarray
    slip: np.ndarray
    speed: float
    said: list[tuple[int, str]]


def drive(scenario: Scenario) -> Drive:
    """Drive a scenario offline."""
    outputs: list[Output] = []
    Simulation(scenario, outputs.append).run()
    poses: list[Odometry] = list(_truth(outputs, 'odom'))
    slips: list[Joints] = list(_truth(outputs, 'tyres/side_slip'))
    said = [
        (output.value.stamp, f'{status.name.strip("/")}: {status.message}')
        for output in outputs
        if output.topic == '/diagnostics' and isinstance(output.value, Diagnostics)
        for status in output.value.statuses
        if status.level
    ]
    return Drive(
        np.array([(pose.x, pose.y) for pose in poses]),
        np.array([max(map(abs, slip.position)) for slip in slips]),
        math.hypot(poses[-1].vx, poses[-1].vy),
        said,
    )


def _truth(outputs: list[Output], topic: str) -> Iterator:
    """Return what is true, cycle by cycle, be the sensor right or not."""
    lies = {i for i, output in enumerate(outputs) if output.topic == topic
            and i + 1 < len(outputs) and outputs[i + 1].topic == f'{topic}/truth'}
    for i, output in enumerate(outputs):
        if (output.topic == topic and i not in lies) or output.topic == f'{topic}/truth':
            yield output.value


def path_error(path: np.ndarray, reference: np.ndarray) -> float:
    """Return the largest distance of a path from another one, wherever on it [m]."""
    begin, way = reference[:-1], np.diff(reference, axis=0)
    square = np.maximum((way * way).sum(axis=1), 1e-12)

    def distance(place: np.ndarray) -> float:
        share = np.clip(((place - begin) * way).sum(axis=1) / square, 0.0, 1.0)
        return float(np.hypot(*(begin + share[:, None] * way - place).T).min())

    return max(map(distance, path[::10]))


def named_after(said: list[tuple[int, str]], fault: Fault, at: float, period: float) -> str:
    """Return after how many cycles a diagnostic named what fails, and which node said it."""
    name = fault.component.removeprefix('messages/')
    wheel = name.partition('/')[0]
    subject = wheel if wheel in WHEELS else name
    if subject in WHEELS:  # which the side-slip controller names for their side slip
        said = [entry for entry in said if not entry[1].startswith(SIDE_SLIP_CONTROLLER)]
    for stamp, text in said:
        cycles = round((stamp / 1e9 - at) / period)
        if cycles >= 0 and subject in text:
            return f'{cycles} ({text.partition(":")[0]})'
    return 'not seen'


def row(name: str) -> str:
    """Return the row of one scenario."""
    scenario = load_scenario(name)
    event = next(event for event in scenario.faults if event.fault.failure != 'ok')
    reference = drive(replace(scenario, faults=()))
    without = drive(
        replace(
            scenario,
            steering=replace(scenario.steering, fault_reaction=False),
            side_slip=replace(scenario.side_slip, fault_reaction=False),
        )
    )
    reacting = drive(scenario)
    begin = round(event.at / scenario.plant.control_period)
    figures = (
        f'{path_error(reacting.path, reference.path):.2f} m', f'{path_error(without.path, reference.path):.2f} m',
        f'{reacting.slip[begin:].max():.3f} rad', f'{without.slip[begin:].max():.3f} rad',
        f'{reacting.speed:.1f} m/s', f'{without.speed:.1f} m/s',
    )
    seen = named_after(reacting.said, event.fault, event.at, scenario.plant.control_period)
    fault = f'`{event.fault.component}` {event.fault.words}'
    return f'| {name.partition("/")[2]} | {fault} | {seen} | {" | ".join(figures)} |'


def page(text: str, rows: list[str]) -> str:
    """Return the text of the page with these rows between its marks."""
    before, _, rest = text.partition(BEGIN)
    return '\n'.join([f'{before}{BEGIN}', HEAD, *rows, f'{END}{rest.partition(END)[2]}'])


def main() -> None:
    """Put the table between the marks of the page."""
    names = [name for name in scenario_names() if name.startswith('faults/')]
    with ProcessPoolExecutor() as pool:
        rows = list(pool.map(row, names))
    PAGE.write_text(page(PAGE.read_text(encoding='utf-8'), rows), encoding='utf-8')


if __name__ == '__main__':
    main()
