"""What acts on the vehicle from outside: bank angle of the road and lateral wind (thesis sec. 4.4)."""

import math
from typing import NamedTuple

from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.model.arithmetic import cos_sin, positive
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.lanes import anywhere, select

# Thesis, Table 4.1: upper wind speed of each pair of numbers (B0 and B1, B2 and B3, ...) [m/s].
WIND_BOUNDS = (
    0.0, 3.0, 7.0, 12.0, 18.0, 25.0, 33.0, 42.0, 51.0, 61.0, 71.0, 82.0, 93.0, 105.0, 117.0, 130.0, 143.0,
)  # fmt: skip
BEAUFORT_NUMBERS = range(2 * (len(WIND_BOUNDS) - 1))
WIND_CLASSES = ('sub-critical', 'weak', 'strong', 'violent')


class WindLevel(NamedTuple):
    """One line of the extended Beaufort scale: its class and the wind speeds that it covers [m/s]."""

    name: str
    low: float
    high: float

    @property
    def mean(self) -> float:
        """Middle of the range [m/s]."""
        return 0.5 * (self.low + self.high)


def beaufort(number: int) -> WindLevel:
    """Return the wind of a Beaufort number, one of `BEAUFORT_NUMBERS` (thesis, Table 4.1: they come in pairs).

    Raises
    ------
    ParameterError
        The table has no such number.
    """
    if number not in BEAUFORT_NUMBERS:
        raise ParameterError(f'beaufort number: {number!r} is outside 0 .. {BEAUFORT_NUMBERS[-1]}')
    line = number // 2
    return WindLevel(WIND_CLASSES[line // 4], WIND_BOUNDS[line], WIND_BOUNDS[line + 1])


def bank_force(bank: float, constants: Constants) -> float:
    """Return the side force of a banked road [N], Yb = m g sin(bank); positive pushes to the left (eq. 4.3).

    Parameters
    ----------
    bank
        Bank angle [rad].
    constants
        The vehicle.
    """
    return constants.mass * constants.gravity * cos_sin(bank)[1]


def side_force_coefficient(airflow_angle: float, constants: Constants) -> float:
    """Return Cy at the angle of the airflow, by linear interpolation.

    Below the first angle of the table it falls in proportion to 0, as a wind from ahead makes no side force;
    above the last one it holds.

    Parameters
    ----------
    airflow_angle
        Angle between the airflow and the vehicle's axis, 0 .. pi/2 [rad].
    constants
        The vehicle.
    """
    low_angle = low_value = 0.0
    coefficient = 0.0 * airflow_angle
    for line in range(len(constants.airflow_angles)):
        angle, value = constants.airflow_angles[line], constants.side_force_coefficients[line]
        share = min(1.0, (airflow_angle - low_angle) / positive(angle - low_angle))
        coefficient = select(airflow_angle < low_angle, coefficient, low_value + share * (value - low_value))
        low_angle, low_value = angle, value
    return coefficient


def wind_force(wind: float, speed: float, constants: Constants) -> float:
    """Return the side force of a lateral wind [N], with the sign of the wind (thesis eq. 4.6, 4.8).

    Parameters
    ----------
    wind
        Lateral wind [m/s]; positive blows to the left.
    speed
        Forward speed [m/s].
    constants
        The vehicle.
    """
    if not anywhere(wind != 0.0):
        return 0.0 * wind
    coefficient = side_force_coefficient(math.atan2(abs(wind), abs(speed)), constants)
    pressure = 0.5 * constants.air_density * (speed * speed + wind * wind)
    return select(wind != 0.0, math.copysign(pressure * coefficient * constants.side_area, wind), 0.0)


def wind_moment(force: float, constants: Constants) -> float:
    """Return the yaw moment of a wind force [N m], Nw = lw Yw (thesis eq. 4.7)."""
    return constants.aerodynamic_centre * force
