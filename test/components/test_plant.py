"""The plant as a component: what its messages say fits together, and bad ones do it no harm."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.components.component import Output
from omni_vehicle_ros.components.joints import JOINT_NAMES, vehicle_joints
from omni_vehicle_ros.components.plant import Plant
from omni_vehicle_ros.messages import Diagnostics, Forces, Imu, Joints, Odometry, Step, Value, Vector
from omni_vehicle_ros.parameters import PlantParameters, VehicleParameters, WheelModuleParameters
from omni_vehicle_ros.wheels import WHEELS

VEHICLE = VehicleParameters()
PERIOD = 5_000_000


def said(outputs: list[Output], topic: str) -> Value:
    return next(output.value for output in outputs if output.topic == topic)


def state(wheel: str, stamp: int, angle: float = 0.0, rate: float = 0.0, torque: float = 0.0) -> tuple[str, Joints]:
    names = (f'{wheel}_steer', f'{wheel}_drive')
    return f'{wheel}/state', Joints(stamp, names, (angle, 0.0), (rate, 0.0), (0.0, torque))


def drive(plant: Plant, cycles: int, angle: float = 0.0, torque: float = 0.0) -> list[Output]:
    outputs = plant.begin()
    for cycle in range(cycles):
        for wheel in WHEELS:
            plant.receive(*state(wheel, cycle * PERIOD, angle, 0.0, torque), cycle * PERIOD)
        outputs = plant.step(cycle * PERIOD)
    return outputs


def test_constant_torque_gives_constant_acceleration() -> None:
    """500 N on each wheel for 2 s: v grows by 4 F t / m = 3.08 m/s, and x by the mean speed times t."""
    outputs = drive(Plant(VEHICLE, PlantParameters(initial_speed=2.0)), 400, torque=500.0 * VEHICLE.wheel_radius)
    odometry = said(outputs, 'odom')
    assert isinstance(odometry, Odometry)
    speed = 2.0 + 4 * 500.0 * 2.0 / VEHICLE.mass
    assert odometry.vx == pytest.approx(speed, rel=1e-9)
    assert odometry.x == pytest.approx((2.0 + speed) / 2.0 * 2.0, rel=1e-9)
    joints = vehicle_joints(said(outputs, 'joint_states'))
    assert joints is not None
    assert joints.wheel_speed == pytest.approx((speed / VEHICLE.wheel_radius,) * 4, rel=1e-9)
    assert joints.rotation == pytest.approx((odometry.x / VEHICLE.wheel_radius,) * 4, rel=1e-9)


def test_messages_of_one_cycle_fit_together() -> None:
    """The forces on the tyres are what the accelerometer feels; loads carry the weight; all stamps are the cycle's."""
    plant = Plant(VEHICLE, PlantParameters(initial_speed=5.0))
    outputs = drive(plant, 200, angle=0.05)
    forces, imu, joints = said(outputs, 'tyres/force'), said(outputs, 'imu'), said(outputs, 'joint_states')
    assert isinstance(forces, Forces)
    assert isinstance(imu, Imu)
    assert sum(force[2] for force in forces.forces) == pytest.approx(VEHICLE.mass * VEHICLE.gravity)
    sideways = sum(force[0] * math.sin(0.05) + force[1] * math.cos(0.05) for force in forces.forces)
    assert imu.ay == pytest.approx(sideways / VEHICLE.mass)
    assert joints.names == JOINT_NAMES
    assert {output.value.stamp for output in outputs} == {200 * PERIOD}


def test_steer_angle_moves_linearly_within_a_cycle() -> None:
    plant = Plant(VEHICLE, PlantParameters())
    plant.begin()
    for wheel in WHEELS:
        plant.receive(*state(wheel, 0, 0.0, 2.0), 0)
    joints = vehicle_joints(said(plant.step(0), 'joint_states'))
    assert joints is not None
    assert joints.steer_angle == pytest.approx((0.01,) * 4)


def test_a_wheel_turns_no_faster_than_it_can_to_where_its_module_has_it() -> None:
    """As after lost messages; ideal actuators have no such limit."""
    limits = WheelModuleParameters(steer_rate_limit=2.0)
    plant = Plant(VEHICLE, PlantParameters(), steering=limits)
    ideal = Plant(VEHICLE, PlantParameters(), steering=replace(limits, ideal_actuators=True))
    angles = []
    for one in (plant, ideal):
        one.begin()
        for cycle in range(12):
            one.receive(*state('front_left', cycle * PERIOD, 0.1), 0)
            joints = vehicle_joints(said(one.step(cycle * PERIOD), 'joint_states'))
            assert joints is not None
            angles.append(joints.steer_angle[0])
    assert angles[:10] == pytest.approx([0.01 * cycle for cycle in range(1, 11)])
    assert angles[10:] == pytest.approx([0.1] * 14)


def test_a_silent_module_leaves_its_wheel_passive_and_is_named() -> None:
    plant = Plant(VEHICLE, PlantParameters())
    plant.begin()
    for wheel in WHEELS:
        plant.receive(*state(wheel, 0, 0.0, 1.0, 50.0), 0)
    plant.step(0)
    outputs = plant.step(PERIOD, ('rear_left/state',))
    joints = vehicle_joints(said(outputs, 'joint_states'))
    diagnostics = said(outputs, '/diagnostics')
    assert joints is not None
    assert isinstance(diagnostics, Diagnostics)
    assert joints.torque == (50.0, 50.0, 0.0, 50.0)
    assert joints.steer_angle[2] == pytest.approx(0.005)
    assert joints.steer_rate[2] == 0.0
    assert diagnostics.statuses[0].level == 2
    assert 'rear_left/wheel_module' in diagnostics.statuses[0].message


def test_stops_at_the_end_of_the_scenario() -> None:
    plant = Plant(VEHICLE, PlantParameters())
    plant.receive('driver/step', Step(0, 2 * PERIOD, ()), 0)
    plant.begin()
    assert plant.step(0)
    assert plant.step(PERIOD)
    assert plant.step(2 * PERIOD) == []


@pytest.mark.parametrize(
    ('topic', 'value', 'words'),
    [
        ('environment/bank', Vector(0, math.nan, 0.0), 'nan is outside -0.7 .. 0.7 rad'),
        ('environment/wind', Vector(0, 0.0, 100.0), '100 is outside -60 .. 60 m/s'),
        ('environment/friction', Joints(0, ('front_left',), (), (), (0.0,)), '0 is outside 0.01 .. 2'),
        ('environment/friction', Joints(0, ('wheel',), (), (), (0.5,)), "unknown wheel 'wheel'"),
        ('environment/friction', Joints(0, ('front_left',)), 'needs one effort'),
        ('rear_left/state', Joints(0, ('a',)), 'rear_left/state has no angle'),
        ('rear_left/state', state('rear_left', 0, math.inf)[1], 'not finite'),
    ],
)
def test_bad_input_is_named_and_the_last_good_one_kept(topic: str, value: Value, words: str) -> None:
    plant = Plant(VEHICLE, PlantParameters())
    plant.begin()
    plant.receive(topic, value, 0)
    diagnostics = said(plant.step(0), '/diagnostics')
    assert isinstance(diagnostics, Diagnostics)
    assert words in diagnostics.statuses[0].message


@settings(deadline=None, max_examples=30)
@given(st.lists(st.tuples(st.sampled_from(WHEELS), st.floats(), st.floats(), st.floats()), max_size=12))
def test_nothing_but_finite_numbers_comes_out(states: list[tuple[str, float, float, float]]) -> None:
    plant = Plant(VEHICLE, PlantParameters(initial_speed=3.0))
    plant.begin()
    for cycle, (wheel, angle, rate, torque) in enumerate(states):
        plant.receive(*state(wheel, cycle * PERIOD, angle, rate, torque), cycle * PERIOD)
        odometry = said(plant.step(cycle * PERIOD), 'odom')
        assert all(map(math.isfinite, odometry[1:7]))
