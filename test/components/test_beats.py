"""The beats of a vehicle among those of strangers."""

from hypothesis import given
from hypothesis import strategies as st

from omni_vehicle_ros.components.beats import FOREIGN, Beats

STEP, ENOUGH = 5_000_000, 10
MOST = 2**31 * 10**9
strange = st.integers(-MOST, MOST).filter(lambda stamp: stamp < 0 or stamp > 10**6 * STEP + 2 * FOREIGN)


@given(st.integers(0, 10**6), st.lists(st.lists(strange, max_size=ENOUGH - 1), max_size=20))
def test_strangers_in_between_change_nothing(first, between):
    beats = Beats(ENOUGH)
    assert beats.accept(first * STEP)
    for number, others in enumerate(between):
        assert not any(map(beats.accept, others))
        assert beats.accept((first + number % 2) * STEP)


@given(st.integers(0, 10**6), st.integers(0, MOST))
def test_a_plant_that_was_started_anew_is_followed(before, begin):
    """After as many beats as it takes, all of them count; a clock that jumped by less than a second is the same one."""
    beats = Beats(ENOUGH)
    beats.accept(before * STEP)
    far = abs(begin - before * STEP) > FOREIGN
    taken = [beats.accept(begin + number * STEP) for number in range(2 * ENOUGH)]
    if far and abs(begin + (ENOUGH - 1) * STEP - before * STEP) > FOREIGN:
        assert taken == [False] * (ENOUGH - 1) + [True] * (ENOUGH + 1)
    assert all(taken[ENOUGH - 1 :])
