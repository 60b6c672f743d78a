"""The component of a wheel module: who it misses, and what it does not let through."""

import math

import pytest

from omni_vehicle_ros.components.joints import module_joints
from omni_vehicle_ros.components.wheel_module import WheelModule
from omni_vehicle_ros.messages import Diagnostics, Joints
from omni_vehicle_ros.parameters import WheelModuleParameters
from omni_vehicle_ros.wheels import WHEELS

STEP, SECOND = 5_000_000, 1_000_000_000
WHEEL = 'rear_left'


class Bench:
    """One module in lock step; a trim comes with every command, if there is one."""

    def __init__(self, *, trimmed=True, **values):
        parameters = WheelModuleParameters(ideal_actuators=True, **values)
        self.module = WheelModule(WHEEL, parameters, 0.005, 0.2, trimmed=trimmed)
        self.stamp, self.said, self.state = 0, [], None

    def run(self, seconds, trim=None):
        """Run, and return what was said on /diagnostics."""
        self.said = []
        for _ in range(round(seconds * SECOND / STEP)):
            self.module.receive(f'{WHEEL}/command', self.joints(0.3), self.stamp)
            if trim is not None:
                self.module.receive(f'{WHEEL}/trim', self.joints(trim), self.stamp)
            for topic, value in self.module.step(self.stamp):
                if isinstance(value, Diagnostics):
                    self.said += [(self.stamp, status.level, status.message) for status in value.statuses]
                else:
                    assert topic == f'{WHEEL}/state'
                    self.state = value
            self.stamp += STEP
        return self.said

    def joints(self, angle):
        return module_joints(WHEEL, self.stamp, angle, 0.0, 0.0, 0.0)


def test_a_controller_that_ends_is_named():
    bench = Bench()
    assert {level for _, level, _ in bench.run(1.0, trim=0.05)} == {0}
    when, _, message = next(entry for entry in bench.run(1.0) if entry[1] == 1)
    assert message == 'no trim from side_slip_controller for module_timeout, 0.1 s: set-point alone'
    assert SECOND + 0.1 * SECOND <= when <= SECOND + 0.1 * SECOND + 2 * STEP
    assert bench.state.position[0] == 0.3


@pytest.mark.parametrize('trimmed', [True, False])
def test_a_controller_that_never_comes_is_named_where_there_should_be_one(trimmed):
    bench = Bench(trimmed=trimmed)
    assert {level for _, level, _ in bench.run(1.9)} == {0}
    said = [message for _, level, message in bench.run(1.0) if level]
    assert set(said) == ({'no trim from side_slip_controller yet: set-point alone'} if trimmed else set())


@pytest.mark.parametrize('trim', [0.6, -0.6])
def test_no_trim_moves_the_wheel_by_more_than_trim_limit(trim):
    bench = Bench()
    said = bench.run(0.1, trim=trim)
    assert bench.state.position[0] == pytest.approx(0.3 + (0.2 if trim > 0.0 else -0.2))
    assert {(level, text) for _, level, text in said} == {(1, 'trim is beyond trim_limit, 0.2 rad: clipped')}


def test_a_trim_at_the_limit_is_whole():
    bench = Bench()
    assert {level for _, level, _ in bench.run(0.1, trim=-0.2)} == {0}
    assert bench.state.position[0] == pytest.approx(0.1)


def test_malformed_trims_between_good_ones_do_not_flap():
    bench = Bench()
    said = []
    for k in range(100):
        if k % 2:
            bench.module.receive(f'{WHEEL}/trim', bench.joints(0.0)._replace(effort=()), bench.stamp)
        said += bench.run(0.02, trim=0.05)
    assert [level for _, level, _ in said] == [0] + [1] * (len(said) - 1)
    assert len(said) <= 4
    assert 'needs position, velocity and effort' in said[1][2]


def test_a_module_that_falls_back_holds_its_angle_without_torque_and_begins_anew_from_where_the_wheel_is():
    """The wheel may have been moved meanwhile; the torque builds up from 0 by the lag of the drive."""
    module = WheelModule(WHEEL, WheelModuleParameters(), 0.005, 0.2, trimmed=False)

    def cycle(stamp, measured, torque):
        joints = [0.0] * 8
        joints[2] = measured
        names = tuple(f'{wheel}_{joint}' for joint in ('steer', 'drive') for wheel in WHEELS)
        beat = Joints(stamp, names, *[tuple(joints)] * 3)
        module.receive('joint_states', beat, stamp)
        module.receive(f'{WHEEL}/command', module_joints(WHEEL, stamp, measured, 0.0, 0.0, torque), stamp)
        return module.step(stamp)

    for k in range(200):
        *_, (_, state) = cycle(k * STEP, 0.1, 300.0)
    assert state.effort[1] == pytest.approx(300.0)
    said, (topic, state) = module.fall_back(200 * STEP)
    assert topic == f'{WHEEL}/state'
    assert (state.position[0], state.velocity[0], state.effort[1]) == (0.1, 0.0, 0.0)
    assert said.value.statuses[0].level == 2
    assert said.value.statuses[0].message == (
        'no joint_states from plant for module_timeout, 0.1 s: angle held, no torque'
    )
    *_, (_, state) = cycle(600 * STEP, -0.2, 300.0)
    assert state.position[0] == -0.2
    # Mean over one cycle of a lag of 0.05 s from rest.
    assert state.effort[1] == pytest.approx(300.0 * (1.0 - (1.0 - math.exp(-0.1)) / 0.1))


def test_a_module_that_has_fallen_back_does_not_act_on_what_it_heard_before():
    module = WheelModule(WHEEL, WheelModuleParameters(), 0.005, 0.2, trimmed=False)
    module.receive(f'{WHEEL}/command', module_joints(WHEEL, STEP, 0.3, 0.0, 0.0, 300.0), STEP)
    module.fall_back(STEP)
    *_, (_, state) = module.step(2 * STEP)
    assert state.effort[1] == state.velocity[0] == 0.0
