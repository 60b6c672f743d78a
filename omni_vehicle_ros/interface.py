"""The wiring table: every topic with its type, frame, quality of service, publishers and subscribers.

Nodes make their ports from it, the recorder takes its list of topics from it, and ``msg_docs/`` is made from it.
Names are relative to the vehicle's namespace, except those that begin with ``/``.
"""

from typing import NamedTuple

from omni_vehicle_ros.wheels import WHEELS

BASE_FRAME = 'base_link'
ODOM_FRAME = 'odom'

PLANT = 'plant'
ICR_STEERING = 'icr_steering'
SIDE_SLIP_CONTROLLER = 'side_slip_controller'
DRIVER = 'driver'
RECORDER = 'recorder'
WHEEL_MODULES = tuple(f'{wheel}/wheel_module' for wheel in WHEELS)
ANYONE = 'anyone'
EMERGENCY_STOP = 'emergency_stop'

NODES = (PLANT, *WHEEL_MODULES, ICR_STEERING, SIDE_SLIP_CONTROLLER, DRIVER, RECORDER)


class Qos(NamedTuple):
    """A quality of service, by its ROS names.

    Every profile here is reliable and keeps the last ``depth`` messages. A latched topic's last message
    reaches those who come later.
    """

    depth: int
    latched: bool


STATE = Qos(depth=64, latched=False)
COMMAND = Qos(depth=64, latched=False)
LATCHED = Qos(depth=16, latched=True)


class Topic(NamedTuple):
    """One row of the wiring table.

    Attributes
    ----------
    name, type, qos, frame
        As in ROS.
    publishers, subscribers
        Nodes, relative to the namespace of the vehicle; `ANYONE` for what any user may publish.
    text, fields
        What it says, and what each field means.
    cyclic
        Whether there is one message in every control cycle.
    repeated
        Whether it is said again and again as long as it is to hold.
    recorded
        Whether the recorder writes it.
    example
        A message to publish by hand, as ``ros2 topic pub`` takes it.
    """

    name: str
    type: str
    qos: Qos
    publishers: tuple[str, ...]
    subscribers: tuple[str, ...]
    text: str
    fields: tuple[tuple[str, str], ...]
    frame: str = ''
    cyclic: bool = False
    repeated: bool = False
    recorded: bool = True
    example: str = ''


def _wheel_topics(number: int) -> tuple[Topic, ...]:
    wheel, module = WHEELS[number], WHEEL_MODULES[number]
    joints = f'{wheel}_steer, {wheel}_drive'
    return (
        Topic(
            f'{wheel}/command', 'sensor_msgs/msg/JointState', COMMAND, (ICR_STEERING,), (module,),
            f'What ICR steering asks of the {wheel.replace("_", " ")} wheel module in this cycle.',
            (
                ('header.stamp', 'the cycle that it belongs to'),
                ('name', joints),
                ('position', 'steer angle [rad], 0'),
                ('velocity', '0, wheel speed [rad/s]'),
                ('effort', '0, drive torque [N m]'),
            ), cyclic=True,
        ),
        Topic(
            f'{wheel}/trim', 'sensor_msgs/msg/JointState', COMMAND, (SIDE_SLIP_CONTROLLER,), (module, ICR_STEERING),
            'Steer angle and drive torque that the side-slip controller adds to the command; the module holds the '
            'angle to trim_limit. With the controller wheel_slip in reverse, gains on the front wheels turn these, '
            'which trail then, inward until they make no side force: the vehicle turns tighter than commanded, and '
            'spins from 4 m/s on.',
            (
                ('header.stamp', 'the cycle that it belongs to'),
                ('name', joints),
                ('position', 'added steer angle [rad], 0'),
                ('velocity', '0, 0'),
                ('effort', '0, added drive torque [N m]'),
            ), cyclic=True,
        ),
        Topic(
            f'{wheel}/state', 'sensor_msgs/msg/JointState', STATE, (module,), (PLANT, ICR_STEERING),
            'What the actuators of the module do from this cycle to the next.',
            (
                ('header.stamp', 'the cycle that it begins with'),
                ('name', joints),
                ('position', 'steer angle at the begin of the cycle [rad], 0'),
                ('velocity', 'mean steer rate over the cycle [rad/s], measured wheel speed [rad/s]'),
                ('effort', '0, drive torque over the cycle [N m]'),
            ), cyclic=True,
        ),
    )


_TWIST_FIELDS = (
    ('header.stamp', 'when it was said; 0 means now'),
    ('header.frame_id', 'base_link, or empty'),
    ('twist.linear.x, twist.linear.y', 'velocity of the centre of gravity, ahead and to the left [m/s]'),
    ('twist.angular.z', 'yaw rate, anticlockwise [rad/s]'),
    ('the rest', 'not used'),
)

TOPICS: tuple[Topic, ...] = (
    Topic(
        'driver/icr', 'geometry_msgs/msg/PointStamped', COMMAND, (DRIVER, ANYONE), (ICR_STEERING,),
        'Where the driver wants the instantaneous centre of rotation (ICR).',
        (
            ('header.stamp', 'when it was said; 0 means now'),
            ('header.frame_id', 'base_link, or empty'),
            ('point.x, point.y', 'ICR ahead of and to the left of the centre of gravity [m]; farther away than '
             'straight_radius (1e5 m): straight on if it lies across, else crab across its bearing'),
            ('point.z', 'not used'),
        ), BASE_FRAME, repeated=True,
        example='{header: {frame_id: base_link}, point: {x: 0.0, y: 8.0}}',
    ),
    Topic(
        'driver/speed', 'geometry_msgs/msg/TwistStamped', COMMAND, (DRIVER, ANYONE), (ICR_STEERING,),
        'How fast the driver wants to go; negative is backwards.',
        (
            ('header.stamp', 'when it was said; 0 means now'),
            ('header.frame_id', 'base_link, or empty'),
            ('twist.linear.x', 'signed speed of the centre of gravity [m/s]'),
            ('the rest', 'not used'),
        ), BASE_FRAME, repeated=True,
        example='{header: {frame_id: base_link}, twist: {linear: {x: 2.0}}}',
    ),
    Topic(
        'driver/traction', 'geometry_msgs/msg/WrenchStamped', COMMAND, (DRIVER, ANYONE), (ICR_STEERING,),
        'Open-loop traction or brake, in place of driver/speed.',
        (
            ('header.stamp', 'when it was said; 0 means now'),
            ('header.frame_id', 'base_link, or empty'),
            ('wrench.force.x', 'total traction force (+) or brake force (-) [N]; a brake never drives backwards'),
            ('wrench.torque.z', 'yaw moment by more traction on one side than on the other [N m]'),
            ('the rest', 'not used'),
        ), BASE_FRAME, repeated=True,
        example='{header: {frame_id: base_link}, wrench: {force: {x: 500.0}}}',
    ),
    Topic(
        'cmd_vel', 'geometry_msgs/msg/TwistStamped', COMMAND, (DRIVER, ANYONE), (ICR_STEERING,),
        'Body twist, for Nav2 and other autonomy, in place of driver/icr and driver/speed: crab and spin in place '
        'included. Ignored while driver/speed, driver/traction or teleop/cmd_vel is fresh.',
        _TWIST_FIELDS, BASE_FRAME, repeated=True,
        example='{header: {frame_id: base_link}, twist: {linear: {x: 1.0, y: 1.0}, angular: {z: 0.2}}}',
    ),
    Topic(
        'teleop/cmd_vel', 'geometry_msgs/msg/TwistStamped', COMMAND, (DRIVER, ANYONE), (ICR_STEERING,),
        'The same from a hand: as long as it comes, cmd_vel is ignored. The latest of this, driver/speed and '
        'driver/traction holds.',
        _TWIST_FIELDS, BASE_FRAME, repeated=True,
        example='{header: {frame_id: base_link}, twist: {linear: {x: 1.0}}}',
    ),
    Topic(
        EMERGENCY_STOP, 'std_msgs/msg/Bool', LATCHED, (DRIVER, ANYONE), (ICR_STEERING, *WHEEL_MODULES),
        'Emergency stop: true brakes to rest with the steer angles held. It lasts until false has been said, the '
        'vehicle stands, and whoever drives commands speed 0. Latched publishers reach nodes that start later; a '
        'volatile one does as well for those that run.',
        (('data', 'true: stop; false: a stop may end'),),
        example='{data: true}',
    ),
    Topic(
        'driver/step', 'sensor_msgs/msg/TimeReference', COMMAND, (DRIVER,),
        (ICR_STEERING, *WHEEL_MODULES, PLANT, RECORDER, SIDE_SLIP_CONTROLLER),
        'Lock step only: the driver has said all that it has to say in this cycle. The side-slip controller listens '
        'with fault_injection only.',
        (
            ('header.stamp', 'the cycle'),
            ('time_ref', 'end of the scenario'),
            ('source', 'names of the topics that it published on in this cycle, separated by spaces'),
        ), cyclic=True,
    ),
    Topic(
        'commanded_twist', 'geometry_msgs/msg/TwistStamped', COMMAND, (ICR_STEERING,), (SIDE_SLIP_CONTROLLER,),
        'The one rigid motion that the set-points of this cycle belong to.',
        (
            ('header.stamp', 'the cycle that it belongs to'),
            ('twist.linear.x, twist.linear.y', 'velocity of the centre of gravity, ahead and to the left [m/s]'),
            ('twist.angular.z', 'yaw rate, anticlockwise [rad/s]'),
            ('the rest', '0; all of it before any command'),
        ), BASE_FRAME, cyclic=True,
    ),
    *(topic for number in range(4) for topic in _wheel_topics(number)),
    Topic(
        'joint_states', 'sensor_msgs/msg/JointState', STATE, (PLANT,),
        (ICR_STEERING, SIDE_SLIP_CONTROLLER, DRIVER, RECORDER, *WHEEL_MODULES),
        'All eight joints, as robot_state_publisher wants them; the message that begins a control cycle.',
        (
            ('header.stamp', 'simulated time'),
            ('name', '<wheel>_steer for the four wheels, then <wheel>_drive'),
            ('position', 'steer angles [rad], wheel rotations [rad]'),
            ('velocity', 'steer rates [rad/s], wheel speeds [rad/s]'),
            ('effort', '0, drive torques [N m]'),
        ), BASE_FRAME, cyclic=True,
    ),
    Topic(
        'odom', 'nav_msgs/msg/Odometry', STATE, (PLANT,), (SIDE_SLIP_CONTROLLER,),
        'True pose and twist of the centre of gravity.',
        (
            ('header.stamp', 'simulated time'),
            ('pose.pose', 'x, y [m] and heading (quaternion) in odom'),
            ('twist.twist', 'vx, vy [m/s] and yaw rate [rad/s] in base_link'),
            ('covariances', '0: this is the truth'),
        ), ODOM_FRAME, cyclic=True,
    ),
    Topic(
        'imu', 'sensor_msgs/msg/Imu', STATE, (PLANT,), (SIDE_SLIP_CONTROLLER,),
        'Heading, yaw rate and acceleration at the centre of gravity.',
        (
            ('header.stamp', 'simulated time'),
            ('orientation', 'heading, and the roll of the body (quaternion)'),
            ('angular_velocity.z', 'yaw rate [rad/s]'),
            ('linear_acceleration', 'what an accelerometer feels in the road plane [m/s2]; z: gravity'),
        ), BASE_FRAME, cyclic=True,
    ),
    Topic(
        'tyres/side_slip', 'sensor_msgs/msg/JointState', STATE, (PLANT,), (SIDE_SLIP_CONTROLLER,),
        'How each tyre slips sideways, and how much of its grip it uses.',
        (
            ('header.stamp', 'simulated time'),
            ('name', 'the four wheels'),
            ('position', 'side-slip angle [rad], positive where it makes a force to the left'),
            ('velocity', 'speed of the wheel along its heading [m/s]'),
            ('effort', 'friction use: force in the road plane over friction times load [1]'),
        ), BASE_FRAME, cyclic=True,
    ),
    Topic(
        'tyres/force', 'sensor_msgs/msg/MultiDOFJointState', STATE, (PLANT,), (),
        'The forces of the road on each tyre, in the frame of the wheel.',
        (
            ('header.stamp', 'simulated time'),
            ('joint_names', 'the four wheels'),
            ('wrench[i].force', 'x: traction or brake, y: lateral force, z: load [N]'),
            ('transforms, twist', 'empty'),
        ), cyclic=True,
    ),
    Topic(
        'environment/bank', 'geometry_msgs/msg/Vector3Stamped', LATCHED, (DRIVER, ANYONE), (PLANT,),
        'Bank of the road.',
        (
            ('header.stamp', 'from when on'),
            ('vector.x', 'bank angle [rad]; positive pushes the vehicle to its left'),
            ('the rest', 'not used'),
        ), BASE_FRAME,
        example='{vector: {x: 0.02}}',
    ),
    Topic(
        'environment/wind', 'geometry_msgs/msg/Vector3Stamped', LATCHED, (DRIVER, ANYONE), (PLANT,),
        'Lateral wind.',
        (
            ('header.stamp', 'from when on'),
            ('vector.y', 'wind speed [m/s]; positive blows to the left of the vehicle'),
            ('the rest', 'not used'),
        ), BASE_FRAME,
        example='{vector: {y: 5.0}}',
    ),
    Topic(
        'environment/friction', 'sensor_msgs/msg/JointState', LATCHED, (DRIVER, ANYONE), (PLANT,),
        'Friction between tyres and road.',
        (
            ('header.stamp', 'from when on'),
            ('name', 'wheels; those not named keep their friction'),
            ('effort', 'friction coefficients [1]'),
        ),
        example='{name: [front_left, front_right, rear_left, rear_right], effort: [0.5, 0.5, 0.5, 0.5]}',
    ),
    Topic(
        'faults', 'diagnostic_msgs/msg/DiagnosticArray', COMMAND,
        (DRIVER, ANYONE, PLANT, *WHEEL_MODULES, ICR_STEERING, SIDE_SLIP_CONTROLLER),
        (PLANT, *WHEEL_MODULES, ICR_STEERING, SIDE_SLIP_CONTROLLER),
        'Injects faults, if the parameter fault_injection allows it; docs/faults.md lists them. Nodes say here what '
        'their parameters fault.* are set to, so that all nodes and the bag know it.',
        (
            ('header.stamp', 'the cycle from which on it holds'),
            ('status[].level', '0 for the failure ok, 2 for others'),
            ('status[].name', 'the component, such as front_left/steering'),
            ('status[].message', 'its failure, such as slow, or ok'),
            ('status[].values', 'one with the key value, if the failure has a value other than its default'),
        ),
        example="{status: [{name: front_left/steering, message: slow, values: [{key: value, value: '0.3'}]}]}",
    ),
    *(
        Topic(
            f'{sensor}/truth', topic_type, STATE, (PLANT,), (),
            f'What {sensor} should say, in each cycle in which a fault keeps it from saying so.',
            (('all', f'as in {sensor}'),), frame,
        )
        for sensor, topic_type, frame in (
            ('joint_states', 'sensor_msgs/msg/JointState', BASE_FRAME),
            ('odom', 'nav_msgs/msg/Odometry', ODOM_FRAME),
            ('imu', 'sensor_msgs/msg/Imu', BASE_FRAME),
            ('tyres/side_slip', 'sensor_msgs/msg/JointState', BASE_FRAME),
        )
    ),
    Topic(
        'recorder/step', 'sensor_msgs/msg/TimeReference', COMMAND, (RECORDER,), (PLANT,),
        'Lock step only: the recorder has what came before this cycle; the plant does not run far ahead of it.',
        (
            ('header.stamp', 'the cycle'),
            ('source', 'recorder'),
        ), recorded=False,
    ),
    Topic(
        'ready', 'std_msgs/msg/String', LATCHED, NODES, (PLANT,),
        'A node is connected to all its peers. In lock step the plant starts when all have said so.',
        (('data', 'name of the node, relative to the namespace of the vehicle'),),
        recorded=False,
    ),
    Topic(
        '/clock', 'rosgraph_msgs/msg/Clock', STATE, (PLANT,), (),
        'Simulated time. One plant on a network owns it: parameter publish_clock.',
        (('clock', 'simulated time'),), cyclic=True,
    ),
    Topic(
        '/diagnostics', 'diagnostic_msgs/msg/DiagnosticArray', STATE, NODES, (),
        'Health of every node: once a second of simulated time, and at every change; what was wrong is said for a '
        'second after it has ended.',
        (
            ('header.stamp', 'simulated time'),
            ('status[].level', '0 OK, 1 warning, 2 error, 3 stale'),
            ('status[].name', 'the node, with its namespace'),
            ('status[].message', 'what is wrong, with the value and the limit'),
        ),
    ),
)

LONGEST = 1 << 16
"""A message that is longer is dropped [byte]; the longest that a vehicle needs have some 2,000."""


def topics(*, publish_clock: bool, fault_injection: bool) -> list[Topic]:
    """Return the rows that a vehicle uses, with those of its nodes that use them.

    Parameters
    ----------
    publish_clock
        Whether it owns /clock.
    fault_injection
        Whether its nodes take faults: without, nobody waits for the driver to say that there is none.
    """
    rows = [row for row in TOPICS if row.name != '/clock' or publish_clock]
    return rows if fault_injection else [_without_faults(row) for row in rows if not row.name.endswith('/truth')]


def _without_faults(row: Topic) -> Topic:
    if row.name == 'faults':  # the plant says that it refuses them
        return row._replace(publishers=(ANYONE,), subscribers=(PLANT,))
    if row.name == 'driver/step':
        return row._replace(subscribers=(ICR_STEERING, *WHEEL_MODULES, PLANT, RECORDER))
    return row


def topic(name: str) -> Topic:
    """Return the row of the wiring table for a topic.

    Raises
    ------
    KeyError
        There is no such topic.
    """
    return _BY_NAME[name]


_BY_NAME = {row.name: row for row in TOPICS}


def resolve(name: str, namespace: str) -> str:
    """Return the full name of what is called ``name`` in ``namespace`` ('' or '/' for the root)."""
    if name.startswith('/'):
        return name
    base = namespace.strip('/')
    return '/' + '/'.join(part for part in (base, name) if part)
