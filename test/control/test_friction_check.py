"""A road that gives less than estimated is noticed in simulated drives, and nothing else is taken for it."""

import re

import pytest

from omni_vehicle_ros.control.friction_check import EVIDENCE, FrictionCheck
from omni_vehicle_ros.control.grip import Grip
from omni_vehicle_ros.control.health import WARN
from omni_vehicle_ros.control.trim import Sensed
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters
from omni_vehicle_ros.scenarios import load_scenario
from omni_vehicle_ros.simulation import record

VEHICLE = VehicleParameters()
PERIOD = 0.005
DRIVE = ('wheel_module.ideal_actuators=false', 'plant.constant_speed=false', 'side_slip_control=true')


def road(friction, radius, speed, controller='allocation', *settings, duration=2.0):
    return load_scenario(
        'simple_turning',
        (
            *DRIVE, f'side_slip.controller={controller}', f'plant.friction={[friction] * 4}',
            f'radius={radius}', f'speed={speed}', f'duration={duration}', *settings,
        ),
    )


def said(scenario, estimate=0.9):
    """Return stamp and text of all that the check says in the drive."""
    bag = record(scenario)
    odom, imu, joints, slips = bag['odom'], bag['imu'], bag['joint_states'], bag['tyres/side_slip']
    check, notes = FrictionCheck(SideSlipParameters(friction_estimate=estimate), scenario.vehicle), []
    for k, stamp in enumerate(odom.stamp):
        sensed = Sensed(
            tuple(slips.position[k]), tuple(slips.velocity[k]), tuple(joints.position[k, :4]),
            tuple(joints.effort[k, 4:]), Twist(odom.vx[k], odom.vy[k], odom.yaw_rate[k]), imu.ay[k],
        )
        for level, text in check.update(sensed, PERIOD if k else 0.0):
            assert level == WARN
            notes.append((stamp, text))
    return notes


@pytest.mark.parametrize('friction, radius, speed', [(0.2, 10, 4), (0.2, -5, 6), (0.4, 10, 6)])
def test_a_slippery_road_is_noticed_before_the_vehicle_spins(friction, radius, speed):
    notes = said(road(friction, radius, speed, duration=1.0))
    when, text = notes[0]
    assert when < 0.6
    found = float(re.fullmatch(r'the road gives less than friction_estimate 0.9: about (.*), or less', text)[1])
    assert found == pytest.approx(friction, abs=0.051)


def test_where_drives_take_the_friction_it_is_at_least_an_upper_bound():
    text = said(road(0.2, 10, 6, 'yaw_moment', duration=1.0))[-1][1]
    assert 0.2 <= float(text.split('about ')[1].split(',')[0]) < 0.9


@pytest.mark.parametrize('controller', ['allocation', 'yaw_moment', 'wheel_slip'])
@pytest.mark.parametrize('radius, speed', [(10, 8), (5, 6)])
def test_at_the_limit_of_a_road_as_estimated_nothing_is_said(controller, radius, speed):
    assert said(road(0.9, radius, speed, controller)) == []


@pytest.mark.parametrize('weather', ['plant.bank=0.15', 'plant.bank=-0.15', 'plant.wind=30', 'plant.wind=-30'])
def test_bank_and_wind_are_no_lack_of_friction(weather):
    assert said(road(0.9, 10, 7, 'allocation', weather)) == []


@pytest.mark.parametrize(
    'name, settings',
    [
        ('demo', ('duration=12', 'side_slip.controller=allocation')),  # its turn becomes slippery, within grip
        ('crosswind', ('duration=8',)),
        ('thesis/bank', ('duration=6',)),
        ('thesis/wind', ('duration=4',)),
        ('thesis/traction_in_turn', ('duration=17',)),
    ],
)
def test_scenarios_within_grip_raise_no_alarm(name, settings):
    assert said(load_scenario(name, settings)) == []


@pytest.mark.parametrize('tyre', ['brush', 'magic_formula'])
def test_tyres_of_another_law_are_no_lack_of_friction(tyre):
    assert said(road(0.9, 10, 8, 'allocation', f'vehicle.tyre_model={tyre}')) == []


def sliding(slip, friction, side=1.0):
    """What is sensed of four equal tyres that roll straight ahead and slip by an angle on a road."""
    speed, grip = 8.0, Grip(VEHICLE, friction)
    acceleration = 0.0
    for _ in range(20):
        forces = [grip.side_force(slip, speed, capacity) for capacity in grip.capacities(acceleration)]
        acceleration = sum(forces) / VEHICLE.mass
    return Sensed((side * slip,) * 4, (speed,) * 4, lateral_acceleration=side * acceleration)


@pytest.mark.parametrize('side', [1.0, -1.0])
def test_it_takes_its_time_and_goes_as_it_comes(side):
    check, good, bad = FrictionCheck(SideSlipParameters(), VEHICLE), sliding(0.1, 0.9, side), sliding(0.1, 0.3, side)
    cycles = round(EVIDENCE / PERIOD)
    assert [bool(check.update(bad, PERIOD)) for _ in range(cycles + 1)].index(True) in (cycles - 1, cycles)
    assert check.found == pytest.approx(0.3, abs=0.03)
    assert [bool(check.update(good, PERIOD)) for _ in range(cycles + 1)].index(False) in (cycles - 1, cycles)
    check.update(bad, PERIOD)
    assert check.update(bad, 0.0) == []


def test_in_the_linear_region_nothing_can_be_known():
    check = FrictionCheck(SideSlipParameters(), VEHICLE)
    felt = sliding(0.03, 0.9)
    half = felt._replace(lateral_acceleration=0.5 * felt.lateral_acceleration)
    assert all(check.update(half, PERIOD) == [] for _ in range(200))


def test_in_a_spin_what_was_found_stands():
    check = FrictionCheck(SideSlipParameters(), VEHICLE)
    for _ in range(100):
        found = check.update(sliding(0.1, 0.3), PERIOD)
    assert found
    assert all(check.update(sliding(0.8, 0.3), PERIOD) == found for _ in range(400))
