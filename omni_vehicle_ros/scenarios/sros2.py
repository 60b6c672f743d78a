"""SROS2 policy of a vehicle, from the wiring table: who publishes and reads what, one enclave a node.

``ros2 security create_permission`` turns it into signed DDS permissions; see ``docs/security.md``.
"""

import argparse
import sys
import xml.etree.ElementTree as ET
from typing import NamedTuple

from omni_vehicle_ros import interface
from omni_vehicle_ros.interface import ANYONE, TOPICS, resolve

VERSION = '0.2.0'
"""Of the schema of policies, as sros2 checks it."""

SERVICES = tuple(
    f'~/{name}'
    for name in (
        'describe_parameters', 'get_parameter_types', 'get_parameters', 'get_type_description', 'list_parameters',
        'set_parameters', 'set_parameters_atomically',
    )
)
"""What every node of rclpy offers."""

LIFECYCLE = tuple(
    f'~/{name}'
    for name in (
        'change_state', 'get_available_states', 'get_available_transitions', 'get_state', 'get_transition_graph',
    )
)
"""What a managed node offers beside; it publishes `TRANSITIONS`."""
TRANSITIONS = '~/transition_event'

TELEOP = tuple(row.name for row in TOPICS if row.name.startswith(('driver/', 'teleop/')) and ANYONE in row.publishers)
ENVIRONMENT = tuple(row.name for row in TOPICS if row.name.startswith('environment/'))


class Rights(NamedTuple):
    """What an enclave may do.

    Attributes
    ----------
    name
        Of its node, relative to the namespace of the vehicle.
    publishes, reads
        Topics, as in the wiring table.
    replies
        Services that it offers.
    requests
        Services of others that it may call.
    """

    name: str
    publishes: tuple[str, ...]
    reads: tuple[str, ...]
    replies: tuple[str, ...] = SERVICES
    requests: tuple[str, ...] = ()


def rights() -> tuple[Rights, ...]:
    """Return what each node of the vehicle may do, and those who drive, stop, set the scene and look on."""
    seen = tuple(row.name for row in TOPICS)
    return (
        *map(_of_node, interface.NODES),
        Rights('teleop', (*TELEOP, interface.EMERGENCY_STOP), ('odom', '/diagnostics')),
        Rights('autonomy', ('cmd_vel',), seen),
        Rights('stop_button', (interface.EMERGENCY_STOP,), ('/diagnostics',)),
        Rights('scene', ENVIRONMENT, ('odom',)),
        Rights('observer', (), (*seen, '/rosout'), requests=_looks()),
    )


def _of_node(node: str) -> Rights:
    reads = [row.name for row in TOPICS if node in row.subscribers or (node == interface.RECORDER and row.recorded)]
    services = ('~/snapshot',) if node == interface.RECORDER else ()
    publishes = tuple(row.name for row in TOPICS if node in row.publishers)
    return Rights(node, (*publishes, TRANSITIONS), tuple(reads), (*SERVICES, *LIFECYCLE, *services))


def _looks() -> tuple[str, ...]:
    """Return the services by which an observer reads parameters and states of the nodes; it sets none."""
    services = (*SERVICES, *LIFECYCLE)
    reading = [service.removeprefix('~') for service in services if 'set' not in service and 'change' not in service]
    return tuple(f'{node}{service}' for node in interface.NODES for service in reading)


def policy(namespace: str = '') -> str:
    """Return the policy file of a vehicle in a namespace, as XML."""
    root = ET.Element('policy', version=VERSION)
    enclaves = ET.SubElement(root, 'enclaves')
    for each in rights():
        full = resolve(each.name, namespace)
        profiles = ET.SubElement(ET.SubElement(enclaves, 'enclave', path=full), 'profiles')
        base, _, name = full.rpartition('/')
        _profile(ET.SubElement(profiles, 'profile', ns=base or '/', node=name), each, namespace)
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


def _profile(profile: ET.Element, each: Rights, namespace: str) -> None:
    _rules(profile, 'topic', ('publish',), _full(('/rosout', *each.publishes), namespace))
    _rules(profile, 'topic', ('subscribe',), _full(('/clock', *each.reads), namespace))
    _rules(profile, 'topic', ('publish', 'subscribe'), ['/parameter_events'])
    _rules(profile, 'service', ('reply',), list(each.replies))
    if each.requests:
        _rules(profile, 'service', ('request',), _full(each.requests, namespace))


def _full(names: tuple[str, ...], namespace: str) -> list[str]:
    """Return full names, each once: a relative one would be taken in the namespace of a wheel; ``~`` is the node."""
    return sorted({name if name.startswith('~') else resolve(name, namespace) for name in names})


def _rules(profile: ET.Element, kind: str, qualifiers: tuple[str, ...], names: list[str]) -> None:
    rule = ET.SubElement(profile, f'{kind}s', dict.fromkeys(qualifiers, 'ALLOW'))
    for name in names:
        ET.SubElement(rule, kind).text = name


def enclaves(namespace: str = '') -> list[str]:
    """Return the paths of all enclaves of a vehicle."""
    return [resolve(each.name, namespace) for each in rights()]


def main() -> None:
    """Print the policy of a vehicle, or the paths of its enclaves."""
    parser = argparse.ArgumentParser(prog='python -m omni_vehicle_ros.scenarios.sros2', description=__doc__)
    parser.add_argument('--namespace', default='', help='of the vehicle')
    parser.add_argument('--list', action='store_true', help='print the paths of the enclaves, a line each')
    options = parser.parse_args()
    if options.list:
        print('\n'.join(enclaves(options.namespace)))
    else:
        sys.stdout.write(policy(options.namespace))


if __name__ == '__main__':
    main()
