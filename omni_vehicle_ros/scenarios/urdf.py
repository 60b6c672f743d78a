"""The vehicle as URDF, for robot_state_publisher and whatever draws.

``python -m omni_vehicle_ros.scenarios.urdf > urdf/omni_vehicle.urdf`` writes the vehicle of the defaults.
"""

import math
from xml.etree import ElementTree

from omni_vehicle_ros.interface import BASE_FRAME
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters, WheelModuleParameters
from omni_vehicle_ros.wheels import WHEELS, drive_joint, steer_joint

TYRE_WIDTH = 0.2  # m, to look at only, as all below
BODY_HEIGHT = 0.5
GAP = 0.1
OVERHANG = 0.5

Element = ElementTree.Element


def urdf(
    vehicle: VehicleParameters, module: WheelModuleParameters, steering: SteeringParameters, name: str = 'omni_vehicle'
) -> str:
    """Return the URDF of a vehicle.

    ``base_link`` lies on the road below the centre of gravity, as in ``odom``, whose z is 0. On it each wheel has a
    knuckle, which steers, and on that ``<wheel>_wheel``, which rolls; the joints are those of ``joint_states``.

    Parameters
    ----------
    vehicle
        Gives the positions and the radius of the wheels [m].
    module, steering
        Give the limits of the joints.
    name
        Of the robot.
    """
    robot = ElementTree.Element('robot', name=name)
    for colour, rgba in (('body', '0.2 0.4 0.7 0.6'), ('tyre', '0.1 0.1 0.1 1'), ('spoke', '0.9 0.6 0.1 1')):
        ElementTree.SubElement(ElementTree.SubElement(robot, 'material', name=colour), 'color', rgba=rgba)
    _add_body(robot, vehicle)
    for wheel, x, y in zip(WHEELS, vehicle.wheel_x, vehicle.wheel_y, strict=True):
        knuckle, rolling = f'{wheel}_knuckle', f'{wheel}_wheel'
        ElementTree.SubElement(robot, 'link', name=knuckle)
        steer = _add_joint(robot, steer_joint(wheel), 'revolute', (BASE_FRAME, knuckle), (x, y, vehicle.wheel_radius))
        ElementTree.SubElement(steer, 'axis', xyz='0 0 1')
        limits = {'lower': -module.steer_limit, 'upper': module.steer_limit, 'velocity': module.steer_rate_limit}
        ElementTree.SubElement(steer, 'limit', _texts(**limits, effort=0.0))
        _add_wheel(robot, rolling, vehicle.wheel_radius)
        drive = _add_joint(robot, drive_joint(wheel), 'continuous', (knuckle, rolling), (0.0, 0.0, 0.0))
        ElementTree.SubElement(drive, 'axis', xyz='0 1 0')
        fastest = steering.maximum_wheel_speed / vehicle.wheel_radius
        ElementTree.SubElement(drive, 'limit', _texts(effort=module.drive_torque_limit, velocity=fastest))
    ElementTree.indent(robot)
    return f'<?xml version="1.0"?>\n{ElementTree.tostring(robot, encoding="unicode")}\n'


def default_urdf() -> str:
    """Return the vehicle of the default parameters."""
    return urdf(VehicleParameters(), WheelModuleParameters(), SteeringParameters())


def _add_body(robot: Element, vehicle: VehicleParameters) -> None:
    link = ElementTree.SubElement(robot, 'link', name=BASE_FRAME)
    size = (vehicle.wheelbase + OVERHANG, min(vehicle.front_track, vehicle.rear_track) - TYRE_WIDTH, BODY_HEIGHT)
    middle = 0.5 * (vehicle.cg_to_front_axle - vehicle.cg_to_rear_axle)
    height = vehicle.wheel_radius + 0.5 * BODY_HEIGHT + GAP
    _add_visual(link, 'body', (middle, 0.0, height), 'box', size=_triple(size))
    nose = (vehicle.cg_to_front_axle + 0.5 * OVERHANG, 0.0, height)
    _add_visual(link, 'spoke', nose, 'box', size=_triple((GAP, 0.5 * size[1], GAP)))


def _add_wheel(robot: Element, name: str, radius: float) -> None:
    link = ElementTree.SubElement(robot, 'link', name=name)
    across = {'radius': f'{radius:.10g}', 'length': f'{TYRE_WIDTH:.10g}'}
    _add_visual(link, 'tyre', (0.0, 0.0, 0.0), 'cylinder', roll=0.5 * math.pi, **across)
    _add_visual(link, 'spoke', (0.0, 0.0, 0.0), 'box', size=_triple((1.6 * radius, 1.05 * TYRE_WIDTH, 0.1 * radius)))


def _add_visual(
    link: Element, colour: str, place: tuple[float, float, float], shape: str, roll: float = 0.0, **sizes: str
) -> None:
    visual = ElementTree.SubElement(link, 'visual')
    ElementTree.SubElement(visual, 'origin', xyz=_triple(place), rpy=_triple((roll, 0.0, 0.0)))
    ElementTree.SubElement(ElementTree.SubElement(visual, 'geometry'), shape, sizes)
    ElementTree.SubElement(visual, 'material', name=colour)


def _add_joint(
    robot: Element, name: str, kind: str, links: tuple[str, str], place: tuple[float, float, float]
) -> Element:
    joint = ElementTree.SubElement(robot, 'joint', name=name, type=kind)
    ElementTree.SubElement(joint, 'parent', link=links[0])
    ElementTree.SubElement(joint, 'child', link=links[1])
    ElementTree.SubElement(joint, 'origin', xyz=_triple(place), rpy='0 0 0')
    return joint


def _texts(**numbers: float) -> dict[str, str]:
    return {name: f'{number:.10g}' for name, number in numbers.items()}


def _triple(numbers: tuple[float, float, float]) -> str:
    return ' '.join(f'{number:.10g}' for number in numbers)


if __name__ == '__main__':
    print(default_urdf(), end='')
