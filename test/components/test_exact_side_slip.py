"""Side-slip control with ideal actuators: solved exactly offline, refused where it would diverge, sampled."""

import math

import numpy as np
import pytest
from scipy.integrate import simpson

from omni_vehicle_ros.checks import check_loop
from omni_vehicle_ros.components.plant import Plant
from omni_vehicle_ros.errors import RunError, ScenarioError
from omni_vehicle_ros.messages import Joints
from omni_vehicle_ros.parameters import PlantParameters, VehicleParameters
from omni_vehicle_ros.scenarios import load_scenario
from omni_vehicle_ros.simulation import record
from omni_vehicle_ros.wheels import WHEELS

GAINS = np.array([5.0, 1.0, 0.0, 0.0])
CONTROLLED = ('side_slip_control=true', 'side_slip.proportional_gains=[5, 1, 0, 0]', 'duration=4')


@pytest.fixture(scope='module')
def bag():
    return record(load_scenario('simple_turning', CONTROLLED))


def test_trims_are_the_gains_times_the_slips(bag):
    slip = bag['tyres/side_slip'].position
    trims = np.stack([bag[f'{wheel}/trim'].position[:, 0] for wheel in WHEELS], axis=1)
    assert trims == pytest.approx(-GAINS * slip, abs=1e-9)
    assert len(trims) == len(slip) == 801


def test_joints_are_the_set_points_of_the_cycle_before_and_the_trims(bag):
    angle = bag['joint_states'].position[:, :4]
    set_points = np.stack([bag[f'{wheel}/command'].position[:, 0] for wheel in WHEELS], axis=1)
    trims = np.stack([bag[f'{wheel}/trim'].position[:, 0] for wheel in WHEELS], axis=1)
    assert angle[1:] == pytest.approx(set_points[:-1] + trims[1:], abs=1e-12)


def test_rates_are_the_mean_rates_of_the_real_angles(bag):
    joints = bag['joint_states']
    means = np.diff(joints.position[:, :2], axis=0) / 0.005
    assert joints.velocity[1:, :2] == pytest.approx(means, rel=1e-9, abs=1e-9)


def test_wheel_speeds_are_along_the_real_angles(bag):
    joints, odom, vehicle = bag['joint_states'], bag['odom'], VehicleParameters()
    for i in range(4):
        angle = joints.position[:, i]
        along = odom.vx - vehicle.wheel_y[i] * odom.yaw_rate
        across = odom.vy + vehicle.wheel_x[i] * odom.yaw_rate
        speed = along * np.cos(angle) + across * np.sin(angle)
        assert joints.velocity[:, 4 + i] * vehicle.wheel_radius == pytest.approx(speed, abs=1e-9)


def test_a_plant_without_gains_has_no_trims():
    plant = Plant(VehicleParameters(), PlantParameters(initial_speed=5.0))
    plant.begin()
    for wheel in WHEELS:
        joints = Joints(0, (f'{wheel}_steer', f'{wheel}_drive'), (0.1, 0.0), (0.2, 0.0), (0.0, 0.0))
        plant.receive(f'{wheel}/state', joints, 0)
    plant.step(0)
    assert plant.trims == (0.0,) * 4


def test_the_recorded_motion_closes_on_the_yaw_equation(bag):
    """The forces and real angles of the bag are what turned the vehicle: the mean moment is Iz times dr/dt."""
    vehicle, force, angle = VehicleParameters(), bag['tyres/force'].forces, bag['joint_states'].position[:, :4]
    x, y = np.array(vehicle.wheel_x), np.array(vehicle.wheel_y)
    ahead = force[:, :, 0] * np.cos(angle) - force[:, :, 1] * np.sin(angle)
    left = force[:, :, 0] * np.sin(angle) + force[:, :, 1] * np.cos(angle)
    moment = (x * left - y * ahead).sum(axis=1)
    later = slice(40, None)  # past the step at the start, which a rule for smooth integrands does not resolve
    gain = simpson(moment[later], dx=0.005) / vehicle.yaw_inertia
    rate = bag['odom'].yaw_rate[later]
    assert rate[-1] - rate[0] == pytest.approx(gain, rel=1e-4)


@pytest.mark.parametrize('name', ['integral_gains', 'derivative_gains'])
def test_gains_with_a_past_have_no_exact_form(name):
    scenario = load_scenario('simple_turning', (*CONTROLLED, f'side_slip.{name}=[0.1, 0, 0, 0]'))
    with pytest.raises(ScenarioError, match=rf'side_slip.{name}: \[0.1, 0.0, 0.0, 0.0\] must be 0 .*ideal_actuators'):
        check_loop(scenario, 'offline')
    with pytest.raises(ScenarioError, match='must be 0'):
        record(scenario)


def test_a_derivative_gain_counts_over_its_time_constant():
    settings = (*CONTROLLED, 'side_slip.derivative_gains=[0, 0.03, 0, 0]')
    check_loop(load_scenario('simple_turning', (*settings, 'side_slip.proportional_gains=[0, 0.3, 0, 0]')))
    more = load_scenario('simple_turning', (*settings, 'side_slip.proportional_gains=[0, 0.5, 0, 0]'))
    with pytest.raises(RunError, match=r'proportional_gains, derivative_gains: 0.5, 0.03 is not'):
        check_loop(more)


@pytest.mark.parametrize('gain', [0.9, 1.0, 5.0])
def test_the_sampled_loop_with_ideal_actuators_is_refused_from_its_limit_on(gain):
    scenario = load_scenario('simple_turning', (*CONTROLLED, f'side_slip.proportional_gains=[0, 0, {gain}, 0]'))
    check_loop(scenario, 'offline')
    if gain < 1.0:
        check_loop(scenario)
        return
    with pytest.raises(RunError, match=rf'{gain:g} is not below 1, .*--mode offline'):
        check_loop(scenario)
    check_loop(load_scenario('simple_turning', (*CONTROLLED, 'wheel_module.ideal_actuators=false')))
    check_loop(load_scenario('simple_turning', (*CONTROLLED, 'side_slip.controller=rear_steering')))


@pytest.mark.parametrize('mode', ['processes', 'offline'])
def test_gains_beyond_the_limit_of_real_actuators_are_refused(mode):
    real = ('wheel_module.ideal_actuators=false', 'side_slip_control=true')
    check_loop(load_scenario('simple_turning', (*real, 'side_slip.proportional_gains=[20, 0, 0, 0]')), mode)
    beyond = load_scenario('simple_turning', (*real, 'side_slip.proportional_gains=[21, 0, 0, 0]'))
    with pytest.raises(RunError, match=r'side_slip.proportional_gains: 21 is not below 20.5, .* front_left'):
        check_loop(beyond, mode)


def test_in_reverse_the_controlled_wheels_trail_and_the_circle_is_tighter():
    # As the parameter's text has it: 3.8 m for 5 m at 3 m/s; forward the same gains make it wider.
    real = ('wheel_module.ideal_actuators=false', 'side_slip_control=true', 'radius=5', 'duration=6')
    radii = []
    for speed in (-3, 3):
        odom = record(load_scenario('simple_turning', (f'speed={speed}', *real)))['odom']
        radii.append(abs(math.hypot(odom.vx[-1], odom.vy[-1]) / odom.yaw_rate[-1]))
    assert radii[0] == pytest.approx(3.8, abs=0.1)
    assert radii[1] > 5.5


def test_a_spin_past_the_grip_stays_finite():
    scenario = load_scenario('simple_turning', ('radius=2', 'speed=6', *CONTROLLED))
    bag = record(scenario)
    assert all(map(math.isfinite, bag['odom'].yaw_rate))
    assert np.isfinite(bag['joint_states'].position).all()
