"""Notices that the road gives less than the friction that a controller reckons with."""

import math

from omni_vehicle_ros.control.grip import Grip
from omni_vehicle_ros.control.health import WARN, Note
from omni_vehicle_ros.control.trim import Sensed
from omni_vehicle_ros.model.tyres.dugoff import first_critical_slip
from omni_vehicle_ros.model.tyres.friction_circle import lateral_capacity, limited_drive_force
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters
from omni_vehicle_ros.wheels import per_wheel

RATIO = 1.5
"""How much more side force the slips must mean, with the estimate, than there is."""

EVIDENCE = 0.1
"""For how long they must [s]; it may be in pieces, but what speaks against it counts the other way."""

_SPINNING = 0.5  # rad; beyond it no law of a tyre is worth a comparison
_STEPS = 40  # of the estimate, from 1 down
_TOLERANCE = 0.1  # m/s2, that of 0.01 of friction


class FrictionCheck:
    """Compares the lateral acceleration with what the measured slips would make on the estimated friction.

    In the linear region of a tyre its force says nothing about friction. So all four tyres must slip to the
    same side, and on the mean past the first critical slip of the estimate, where Dugoff's tyre leaves its
    linear region (thesis, 2.5). There a smaller friction is what makes less force of the same slip. Bank and
    wind do not matter: an accelerometer in the road plane feels what the tyres make, whatever else pushes.

    Parameters
    ----------
    parameters, vehicle
        The friction estimate; mass, tyres and loads.

    Attributes
    ----------
    found
        About what the road gave when it was noticed; None while nothing is wrong.
    """

    def __init__(self, parameters: SideSlipParameters, vehicle: VehicleParameters) -> None:
        self._estimate, self._vehicle = parameters.friction_estimate, vehicle
        self._grip = Grip(vehicle, parameters.friction_estimate)
        self._evidence = 0.0
        self.found: float | None = None

    def update(self, sensed: Sensed, dt: float) -> list[Note]:
        """Take one cycle, and return what there is to say.

        Parameters
        ----------
        sensed
            What was measured, all of it numbers (`Sensed.usable`).
        dt
            Time since the last cycle [s]; 0 starts anew.
        """
        if max(map(abs, sensed.side_slip)) > _SPINNING and dt > 0.0:
            return self._notes()
        short = self._falls_short(sensed)
        self._evidence = max(self._evidence + (dt if short else -dt), 0.0) if dt > 0.0 else 0.0
        if self._evidence == 0.0:
            self.found = None
        elif self._evidence >= EVIDENCE:
            self._evidence = EVIDENCE
            if self.found is None and short:
                self.found = self._friction(sensed)
        return self._notes()

    def _notes(self) -> list[Note]:
        if self.found is None:
            return []
        found = f'about {self.found:.1f}, or less'
        return [(WARN, f'the road gives less than friction_estimate {self._estimate:g}: {found}')]

    def _falls_short(self, sensed: Sensed) -> bool:
        slip = sensed.side_slip
        if min(slip) < 0.0 < max(slip):
            return False
        if 0.25 * abs(sum(slip)) < self._slip_of_interest(sensed):
            return False
        made = math.copysign(sensed.lateral_acceleration, sensed.lateral_acceleration * sum(slip))
        return self._lateral_acceleration(sensed, 1.0) > RATIO * max(made, 0.0)

    def _slip_of_interest(self, sensed: Sensed) -> float:
        """Return the first critical slip of a mean tyre on the estimated friction [rad]."""
        vehicle = self._vehicle
        speed = 0.25 * sum(map(abs, sensed.wheel_speed))
        capacity = 0.25 * self._estimate * vehicle.mass * vehicle.gravity
        return first_critical_slip(speed, capacity, vehicle.cornering_stiffness, vehicle.adhesion_reduction)

    def _lateral_acceleration(self, sensed: Sensed, share: float) -> float:
        """Return what the slips mean for a share of the estimate, to the side that they are on [m/s2]."""
        grip, angle, slip, speed = self._grip, sensed.steer_angle, sensed.side_slip, sensed.wheel_speed
        whole = grip.capacities(sensed.lateral_acceleration)
        radius, torque = self._vehicle.wheel_radius, sensed.drive_torque
        drive = per_wheel(lambda i: limited_drive_force(torque[i] / radius, share * whole[i]))
        rest = per_wheel(lambda i: lateral_capacity(share * whole[i], drive[i]))
        side = per_wheel(lambda i: grip.side_force(slip[i], abs(speed[i]), rest[i]))
        force = sum(side[i] * math.cos(angle[i]) + drive[i] * math.sin(angle[i]) for i in range(4))
        return math.copysign(1.0, sum(slip)) * force / self._vehicle.mass

    def _friction(self, sensed: Sensed) -> float:
        """Return the largest friction at which the measured slips mean no more than the measured acceleration.

        Where the drives take all of a tyre's friction, any smaller one would mean the same.
        """
        made = math.copysign(sensed.lateral_acceleration, sensed.lateral_acceleration * sum(sensed.side_slip))
        shares = (k / _STEPS for k in range(_STEPS - 1, 0, -1))
        fitting = (share for share in shares if self._lateral_acceleration(sensed, share) <= made + _TOLERANCE)
        return self._estimate * next(fitting, 1.0 / _STEPS)
