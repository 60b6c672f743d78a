"""What a message says, as plain values.

Stamps are nanoseconds, always int; everything else is SI and rad. What the project doesn't use of a message is left
out: it is written as 0 and ignored when read.
"""

from typing import NamedTuple


class Joints(NamedTuple):
    """A ``JointState``: arrays are as long as ``names``, or empty."""

    stamp: int
    names: tuple[str, ...]
    position: tuple[float, ...] = ()
    velocity: tuple[float, ...] = ()
    effort: tuple[float, ...] = ()
    frame: str = ''


class Point(NamedTuple):
    """A ``PointStamped`` [m]."""

    stamp: int
    x: float
    y: float
    z: float = 0.0
    frame: str = 'base_link'


class Vector(NamedTuple):
    """A ``Vector3Stamped``, in the unit of its topic."""

    stamp: int
    x: float
    y: float
    z: float = 0.0
    frame: str = 'base_link'


class Twist(NamedTuple):
    """A ``TwistStamped`` in the plane [m/s, rad/s]."""

    stamp: int
    vx: float
    vy: float = 0.0
    yaw_rate: float = 0.0
    frame: str = 'base_link'


class Wrench(NamedTuple):
    """A ``WrenchStamped`` [N, N m]."""

    stamp: int
    fx: float
    fy: float = 0.0
    fz: float = 0.0
    tx: float = 0.0
    ty: float = 0.0
    tz: float = 0.0
    frame: str = 'base_link'


class Forces(NamedTuple):
    """The forces of a ``MultiDOFJointState`` [N]: (x, y, z) for each name."""

    stamp: int
    names: tuple[str, ...]
    forces: tuple[tuple[float, float, float], ...]
    frame: str = ''


class Odometry(NamedTuple):
    """An ``Odometry`` in the plane [m, rad, m/s, rad/s].

    The heading travels as a quaternion: what is read lies in -pi .. pi.
    """

    stamp: int
    x: float
    y: float
    heading: float
    vx: float
    vy: float
    yaw_rate: float
    frame: str = 'odom'
    child_frame: str = 'base_link'


class Imu(NamedTuple):
    """An ``Imu`` [rad, rad/s, m/s2] without pitch.

    Roll and heading travel as a quaternion: what is read lies in -pi .. pi.
    """

    stamp: int
    roll: float
    heading: float
    yaw_rate: float
    ax: float
    ay: float
    az: float
    frame: str = 'base_link'


class Clock(NamedTuple):
    """A ``Clock``."""

    stamp: int


class Step(NamedTuple):
    """A ``TimeReference``: ``end`` [ns] is its time_ref, ``topics`` the words of its source."""

    stamp: int
    end: int
    topics: tuple[str, ...] = ()


class Text(NamedTuple):
    """A ``String``."""

    data: str


class Flag(NamedTuple):
    """A ``Bool``."""

    data: bool

    @property
    def stamp(self) -> int:
        """0, which means now: a ``Bool`` has no stamp."""
        return 0


class Status(NamedTuple):
    """A ``DiagnosticStatus``: level 0 OK, 1 warning, 2 error, 3 stale."""

    level: int
    name: str
    message: str
    values: tuple[tuple[str, str], ...] = ()
    hardware_id: str = ''


class Diagnostics(NamedTuple):
    """A ``DiagnosticArray``."""

    stamp: int
    statuses: tuple[Status, ...]
    frame: str = ''


Value = Clock | Diagnostics | Flag | Forces | Imu | Joints | Odometry | Point | Step | Twist | Vector | Wrench
"""What a message says that belongs to a time."""
