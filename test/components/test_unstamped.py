"""Messages without a stamp get the time of the cycle that names them, in whatever order they come in."""

from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.components.journal import Journal
from omni_vehicle_ros.components.unstamped import Unstamped
from omni_vehicle_ros.messages import Flag, Joints, Step, encode

STOP = 'emergency_stop'


@settings(deadline=None)
@given(st.data(), st.integers(0, 6))
def test_the_order_of_message_and_step_does_not_matter(data, count):
    """Within its topic each comes in order; which of the two topics is ahead is chance."""
    sides = data.draw(st.permutations(['message'] * count + ['step'] * count))
    unstamped, found, messages, steps = Unstamped(), [], 0, 0
    for side in sides:
        if side == 'message':
            found += unstamped.hear(STOP, bytes([messages]), 999)
            messages += 1
        else:
            found += unstamped.name(Step(10 * steps, 0, ('driver/icr', STOP)))
            steps += 1
    assert found == [(STOP, bytes([k]), 10 * k) for k in range(count)]
    assert unstamped.give_up(None) == []


def test_what_nobody_names_has_the_time_at_which_it_came():
    unstamped = Unstamped()
    assert unstamped.hear(STOP, b'a', 5) == unstamped.hear(STOP, b'b', 50) == []
    assert unstamped.give_up(20) == [(STOP, b'a', 5)]
    assert unstamped.give_up(None) == [(STOP, b'b', 50)]


class Pages(list):
    def add_topic(self, name, type_name, qos):
        pass

    def write(self, name, data, log_time):
        self.append((name, log_time))


def test_a_journal_writes_a_stop_of_somebody_else_when_it_came():
    pages = Pages()
    journal = Journal(pages, '', 5)
    for stamp in range(0, 1000, 5):
        journal.add('joint_states', encode('sensor_msgs/msg/JointState', Joints(stamp, ())))
        if stamp == 300:
            journal.add(STOP, encode('std_msgs/msg/Bool', Flag(True)))
    journal.flush()
    assert [entry for entry in pages if entry[0] == '/emergency_stop'] == [('/emergency_stop', 300)]
    assert [time for _, time in pages] == sorted(time for _, time in pages)
