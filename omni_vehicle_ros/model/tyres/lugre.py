"""The averaged LuGre tyre (Canudas de Wit et al. 2003, Deur et al. 2004; in the plane Velenis et al. 2005).

Each bristle of a patch with uniform pressure is stretched by the slip and let go by friction, while the rim
carries it from the front edge of the patch, zeta = 0, to its rear edge, zeta = L, at the speed of rolling:

    dz/dt + rolling dz/dzeta = v_r - k norm(v_r) / (mu Fz h) z,    F = k mean(z)     (each direction)

with the Stribeck curve h(norm(v_r)), 1 at rest and the sliding share far away. Its steady state, averaged over
the patch, is the law of this tyre: with x = 2 C norm(sigma) / (mu Fz h)

    F = mu Fz h (1 - (1 - exp(-x)) / x) sigma / norm(sigma)

where k L = 2 C, so that the slope at no slip is C whatever the length. Bristle damping does not show in steady
state, and viscous friction is left out. `bristle_rate` is the lumped model, whose steady state is the same. The
default share and speed of the Stribeck curve, 0.5 / 0.9 and 12.5 m/s, are those of Canudas de Wit & Tsiotras
1999.
"""

import math

from omni_vehicle_ros.model.arithmetic import norm, positive
from omni_vehicle_ros.model.lanes import select

FULL_STRETCH = 8.0 / 2.0  # slip, in units of capacity over stiffness, at 7/8 of the grip: x = 8
SERIES, FAR = 0.02, 700.0  # x below which the closed form loses digits, and from which on exp(-x) is nothing


def stribeck(speed: float, sliding_share: float, stribeck_speed: float) -> float:
    """Return friction over that of a tyre that just begins to slide, c + (1 - c) exp(-v / v_s) (Tustin 1947).

    Of the exponents in use, 1/2 to 2, it is the one that neither has a cusp at rest nor falls all at once.

    Parameters
    ----------
    speed
        Speed of the slip over ground [m/s], >= 0.
    sliding_share
        Coulomb over static friction, at most 1.
    stribeck_speed
        Speed at which what is above Coulomb friction has fallen to 1/e [m/s].
    """
    return sliding_share + (1.0 - sliding_share) * math.exp(-speed / stribeck_speed)


def patch_share(needed: float, available: float) -> float:
    """Return 1 - (1 - exp(-x)) / x at x = needed / available: the mean force of the patch over its limit.

    Parameters
    ----------
    needed, available
        Any two numbers >= 0 in the proportion of x; 0 available stands for infinity.
    """
    far = needed >= FAR * available
    x = select(far, FAR, needed / positive(available))
    series = x * (1 / 2 - x * (1 / 6 - x * (1 / 24 - x * (1 / 120 - x * (1 / 720 - x / 5040)))))
    near = select(x < SERIES, series, 1.0 + math.expm1(-x) / positive(x))
    return select(far, select(needed > 0.0, 1.0 - available / positive(needed), 0.0), near)


def lugre_force(
    slip: tuple[float, float],
    rolling: float,
    speed: float,
    capacity: float,
    stiffness: tuple[float, float],
    sliding_share: float,
    stribeck_speed: float,
) -> tuple[float, float]:
    """Return both forces of a tyre in steady state, longitudinal and lateral [N]; together at most ``capacity``.

    Parameters
    ----------
    slip, rolling, capacity, stiffness
        As in `brush.brush_force`.
    speed
        Speed of the slip over ground [m/s].
    sliding_share, stribeck_speed
        As in `stribeck`.
    """
    size = norm(slip[0], slip[1])
    limit = capacity * stribeck(speed, sliding_share, stribeck_speed)
    available = limit * rolling
    long_share = patch_share(2.0 * stiffness[0] * size, available)
    lat_share = patch_share(2.0 * stiffness[1] * size, available)
    return limit * long_share * (slip[0] / positive(size)), limit * lat_share * (slip[1] / positive(size))


def bristle_rate(
    deflection: float, slip_speed: float, speed: float, rolling: float, stiffness: float, limit: float, length: float
) -> float:
    """Return the rate of the mean bristle deflection in one direction, the lumped model [m/s].

    With k = 2 C / length it is ``v - (k speed / limit + kappa rolling) z``. The flow kappa of bristles out of the
    patch is taken such that the steady state is that of the whole patch (Deur et al. 2004; Canudas de Wit et al.
    2003): kappa = (1 - exp(-x)) / (length (1 - (1 - exp(-x)) / x)), 2 / length where the bristles stick.

    Parameters
    ----------
    deflection
        Mean deflection [m]; the force is ``k`` times it.
    slip_speed, speed
        Speed of the slip in this direction, with its sign, and in all [m/s].
    rolling
        Speed of the rim, >= 0 [m/s].
    stiffness
        Force per unit slip, C [N].
    limit
        Friction that the road gives at this speed of slip [N], > 0.
    length
        Of the patch [m].
    """
    bristle = 2.0 * stiffness / length
    release = bristle * speed / limit
    return slip_speed - (release + _flow(release * length, rolling) / length) * deflection


def _flow(needed: float, rolling: float) -> float:
    """Return kappa times length times rolling."""
    share = patch_share(needed, rolling)
    # (1 - exp(-x)) / x = 1 - share; times x rolling it is (1 - share) needed.
    return (1.0 - share) * needed / share if share > 0.0 else 2.0 * rolling


def past_peak(
    slip: float, speed: float, capacity: float, stiffness: float, sliding_share: float, stribeck_speed: float
) -> bool:
    """Return whether the side force of a free wheel has passed its peak.

    Far beyond it, where friction falls no more, the force rises again a little; that is still past the peak. What
    falls by friction compares worst with what rises in the patch near twice the Stribeck speed: where the slope
    is negative there, the peak lies below.

    Parameters
    ----------
    slip
        tan(alpha), > 0.
    speed
        Speed of the contact along the wheel [m/s], >= 0.
    capacity
        Friction coefficient times vertical load [N], > 0.
    stiffness
        Cornering stiffness [N/rad].
    sliding_share, stribeck_speed
        As in `stribeck`.
    """
    if slip * speed > 2.0 * stribeck_speed:
        slip = 2.0 * stribeck_speed / speed
    share = stribeck(slip * speed, sliding_share, stribeck_speed)
    fall = (share - sliding_share) * slip * speed / stribeck_speed  # -dh / d(log slip)
    x = 2.0 * stiffness * slip / (capacity * share)
    patch = patch_share(x, 1.0)
    rise = 1.0 - patch - math.exp(-x)  # d(patch share) / d(log x)
    # F = h patch(x), x ~ slip / h:  dF / d(log slip) = -fall patch + rise (h + fall).
    return rise * (share + fall) < fall * patch
