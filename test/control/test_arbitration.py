"""One source of commands at a time, by priority and freshness."""

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from omni_vehicle_ros.control.arbitration import Arbitration, Source
from omni_vehicle_ros.control.driver import Driver
from omni_vehicle_ros.control.freshness import Freshness
from omni_vehicle_ros.messages import Point, Twist
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters

MS = 1_000_000
TIMEOUT = 500 * MS


class Arbiter(RuleBasedStateMachine):
    """Sources that speak and fall silent as they like, beside what must be true of the one that drives."""

    def __init__(self):
        super().__init__()
        self.arbitration = Arbitration(TIMEOUT / 1e9)
        self.now = 0
        self.said = {}  # when each spoke last, and its turn among all

    @rule(source=st.sampled_from(Source))
    def speak(self, source):
        self.turn = getattr(self, 'turn', 0) + 1
        self.said[source] = self.now, self.turn
        self.arbitration.received(source, 0, self.now)

    @rule(wait=st.integers(1, 700))
    def pass_time(self, wait):
        self.now += wait * MS

    @invariant()
    def the_first_of_those_that_speak_drives(self):
        found = self.arbitration.choose(self.now)
        fresh = {source: turn for source, (when, turn) in self.said.items() if self.now - when <= TIMEOUT}
        state = self.arbitration.state(self.now)
        ignored = self.arbitration.ignored(self.now)
        if not fresh:
            assert state is (Freshness.STALE if self.said else Freshness.NEVER)
            assert ignored == []
            return
        assert state is Freshness.FRESH
        assert found in fresh
        hands = {source: turn for source, turn in fresh.items() if source is not Source.CMD_VEL}
        expected = max(hands, key=hands.get) if hands else Source.CMD_VEL
        assert found is expected
        assert ignored == ([Source.CMD_VEL] if hands and Source.CMD_VEL in fresh else [])


Arbiter.TestCase.settings = settings(deadline=None, max_examples=60, stateful_step_count=25)
TestArbiter = Arbiter.TestCase


def test_without_a_time_out_a_hand_keeps_the_vehicle():
    arbitration = Arbitration(0.0)
    arbitration.received(Source.SPEED, 0, 0)
    arbitration.received(Source.CMD_VEL, 0, 10**12)
    assert arbitration.choose(10**12) is Source.SPEED
    arbitration.received(Source.TELEOP, 0, 10**12)
    assert arbitration.choose(10**12) is Source.TELEOP


def test_what_was_long_under_way_does_not_push_out_who_speaks_now():
    arbitration = Arbitration(0.5)
    arbitration.received(Source.CMD_VEL, 1000 * MS, 1000 * MS)
    arbitration.received(Source.SPEED, 100 * MS, 1000 * MS)
    assert arbitration.choose(1000 * MS) is Source.CMD_VEL


def test_the_driver_says_whom_it_ignores_and_why():
    driver = Driver(VehicleParameters(), SteeringParameters())
    driver.icr(Point(0, 0.0, 5.0), 0)
    driver.teleop(Twist(0, 1.0), 0)
    driver.cmd_vel(Twist(0, 5.0), 1)
    assert driver.demand(1).magnitude == 1.0
    (note,) = driver.notes(1)
    assert note[1] == 'cmd_vel is ignored: teleop/cmd_vel holds, and teleop goes before autonomy'
    assert driver.source == 'teleop/cmd_vel'


def test_a_bad_command_of_a_hand_does_not_take_over():
    driver = Driver(VehicleParameters(), SteeringParameters())
    driver.cmd_vel(Twist(0, 2.0), 0)
    driver.teleop(Twist(0, float('nan')), 1)
    assert driver.demand(1).magnitude == 2.0
    assert 'teleop/cmd_vel: vx = nan' in driver.notes(1)[0][1]
