"""The SROS2 policy says what the wiring table says, in the form that sros2 takes."""

import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from omni_vehicle_ros.interface import ANYONE, NODES, RECORDER, TOPICS, resolve
from omni_vehicle_ros.scenarios.sros2 import enclaves, policy

FILE = Path(__file__).parents[2] / 'config' / 'sros2' / 'policy.xml'


def profiles(namespace=''):
    """Return the profiles by the paths of their enclaves, checking the structure of sros2's schema 0.2.0."""
    root = ET.fromstring(policy(namespace))
    assert (root.tag, root.attrib, [child.tag for child in root]) == ('policy', {'version': '0.2.0'}, ['enclaves'])
    found = {}
    for enclave in root[0]:
        assert (enclave.tag, list(enclave.attrib)) == ('enclave', ['path'])
        ((profile,),) = enclave
        assert (profile.tag, sorted(profile.attrib)) == ('profile', ['node', 'ns'])
        for rule in profile:
            kind = rule.tag.removesuffix('s')
            assert kind in ('topic', 'service')
            assert {*rule.attrib} <= {'topic': {'publish', 'subscribe'}, 'service': {'reply', 'request'}}[kind]
            assert {*rule.attrib.values()} == {'ALLOW'}
            assert len(rule) and all(entry.tag == kind and entry.text for entry in rule)
        assert resolve(profile.get('node'), profile.get('ns')) == enclave.get('path')
        found[enclave.get('path')] = profile
    return found


def names(profile, qualifier):
    return {entry.text for rule in profile for entry in rule if qualifier in rule.attrib}


def test_the_file_is_what_the_table_makes():
    assert FILE.read_text(encoding='utf-8') == policy(), (
        'run .venv/bin/python -m omni_vehicle_ros.scenarios.sros2 > config/sros2/policy.xml'
    )


@pytest.mark.parametrize('namespace', ['', 'car', '/fleet/car'])
def test_every_node_may_do_what_the_table_says_and_no_more(namespace):
    found = profiles(namespace)
    assert list(found) == enclaves(namespace)
    for node in NODES:
        profile = found[resolve(node, namespace)]
        publishes = {resolve(row.name, namespace) for row in TOPICS if node in row.publishers}
        reads = {
            resolve(row.name, namespace)
            for row in TOPICS if node in row.subscribers or (node == RECORDER and row.recorded)
        }
        assert names(profile, 'publish') == publishes | {'/rosout', '/parameter_events', '~/transition_event'}
        assert names(profile, 'subscribe') == reads | {'/clock', '/parameter_events'}
        assert not names(profile, 'request')


def test_who_is_not_of_the_vehicle_publishes_nothing_that_belongs_to_a_node():
    free = {resolve(row.name, '') for row in TOPICS if ANYONE in row.publishers} | {'/rosout', '/parameter_events'}
    others = {path: profile for path, profile in profiles().items() if path.strip('/') not in NODES}
    assert set(others) == {'/teleop', '/autonomy', '/stop_button', '/scene', '/observer'}
    assert all(names(profile, 'publish') <= free for profile in others.values())
    assert [path for path, profile in others.items() if '/cmd_vel' in names(profile, 'publish')] == ['/autonomy']
    assert not any('/set_' in name for profile in others.values() for name in names(profile, 'request'))


def test_the_paths_of_the_enclaves_are_printed():
    command = [sys.executable, '-m', 'omni_vehicle_ros.scenarios.sros2', '--list', '--namespace', 'car']
    out = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert out.splitlines() == enclaves('car')
