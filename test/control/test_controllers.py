"""Every controller on a drive through all that the vehicle can do: it stays sane, and comes to rest."""

import math

import numpy as np
import pytest

from omni_vehicle_ros.control.allocation import AllocationController
from omni_vehicle_ros.control.controllers import make_controller
from omni_vehicle_ros.control.rear_steering import RearSteeringController
from omni_vehicle_ros.control.side_slip import SideSlipController
from omni_vehicle_ros.control.yaw_moment import YawMomentController
from omni_vehicle_ros.model.body import Environment
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters

LAWS = {
    'wheel_slip': SideSlipController,
    'yaw_moment': YawMomentController,
    'rear_steering': RearSteeringController,
    'allocation': AllocationController,
}

# Twist, friction, bank, and for how long: straight on, a turn that becomes slippery, straight on over a bank with
# wind, sideways, stop and go, a spin in place, reverse, rest.
LEGS = [
    ((4.0, 0.0, 0.0), 0.9, 0.0, 2.5),
    ((4.0, 0.0, 0.5), 0.9, 0.0, 3.0),
    ((4.0, 0.0, 0.5), 0.5, 0.0, 2.0),
    ((4.0, 0.0, 0.0), 0.9, 0.03, 2.5),
    ((1.7, 1.0, 0.0), 0.9, 0.0, 3.0),
    ((0.0, 0.0, 0.0), 0.9, 0.0, 1.5),
    ((2.0, 0.0, 0.2), 0.9, 0.0, 2.5),
    ((0.0, 0.0, 0.0), 0.9, 0.0, 2.0),
    ((0.0, 0.0, 0.6), 0.9, 0.0, 2.5),
    ((0.0, 0.0, 0.0), 0.9, 0.0, 1.5),
    ((-2.0, 0.0, 0.3), 0.9, 0.0, 3.0),
    ((0.0, 0.0, 0.0), 0.9, 0.0, 2.5),
]


@pytest.mark.parametrize('name', LAWS)
def test_the_parameter_selects_the_law(name):
    assert type(make_controller(SideSlipParameters(controller=name), VehicleParameters())) is LAWS[name]


@pytest.mark.parametrize('name', LAWS)
def test_a_drive_through_everything(closed_loop, name):
    loop = closed_loop(slip=SideSlipParameters(controller=name))
    for twist, friction, bank, duration in LEGS:
        wind = 10.0 if bank else 0.0
        loop.environment = Environment(bank=bank, wind=wind, friction=(friction,) * 4)
        angles = []
        for state in loop.run(duration, lambda twist=twist: loop.twist(*twist)):
            assert all(map(math.isfinite, state))
            assert max(map(abs, loop.seen.side_slip)) < math.radians(6.0)
            assert max(loop.seen.friction_use) < 0.95
            angles.append(loop.angles)
        # Nothing swings any more at the end of a leg.
        assert np.ptp(angles[-60:], axis=0).max() < math.radians(0.3)
        assert math.hypot(loop.state.vx - twist[0], loop.state.vy - twist[1]) < 0.5
    assert max(map(abs, loop.state[:3])) < 1e-3
    assert loop.trims.torque == (0.0,) * 4
