"""Times by clocks that are made up: what is compared, what can be told apart, and how coarse a clock may be."""

from __future__ import annotations

import math
import time

import pytest
from terrainav.core.mission.methods import Method
from terrainav.core.report.measure import Measured, Saving, baseline
from terrainav.core.report.tables import compared_text, savings_table
from terrainav.core.timing import Effort, Quartiles, Seconds, timed, timed_together

ROUNDS = Effort(9, 9, 0.0)


class Clock:
    """A clock of seconds that shows whole steps, and moves by what works spend and by a part of a step at each look."""

    def __init__(self, step_s=1e-6):
        self.now_s, self.step_s = 0.0, step_s

    def __call__(self):
        self.now_s += 0.03 * self.step_s
        return math.floor(self.now_s / self.step_s) * self.step_s

    def work(self, seconds, noise=0.0, turn=0):
        """Work of so many seconds, more and less in turn by a share of noise."""
        runs = iter(range(turn, 10**9))

        def run():
            index = next(runs)
            # Three values that no batch or round has in step with another.
            self.now_s += seconds * (1.0 + noise * (index * 7 % 3 - 1))

        return run


def measured(clock, *works):
    return [seconds for _, seconds in timed_together(works, ROUNDS, clock)]


def method(name, seconds, chosen=False):
    return Measured(Method("pixels", name, 0.1, 0.1), 0.01, seconds, chosen)


def test_a_work_beside_itself_is_not_told_apart():
    clock = Clock()
    one, other = measured(clock, clock.work(0.01, 0.05), clock.work(0.01, 0.05, turn=1))
    assert one.rounds != other.rounds
    low, _, high = one.ratio(other)
    assert low < 1.0 < high
    assert not one.is_distinct(other)
    assert not other.is_distinct(one)
    text = compared_text(method("rays", one), method("mesh", other, chosen=True))
    assert text == "not distinguishable from mesh in time"
    saved = savings_table([Saving("rays", "the mesh fits", one - other, one.is_distinct(other), 0)]).rows[0]
    assert saved[2] == "too small to measure"


def test_a_longer_work_is_told_apart_and_by_how_much():
    clock = Clock()
    one, other = measured(clock, clock.work(0.03, 0.05), clock.work(0.01, 0.05, turn=1))
    assert one.is_distinct(other)
    assert other.is_distinct(one)
    assert one.ratio(other).median == pytest.approx(3.0, rel=0.11)
    text = compared_text(method("rays", one), method("mesh", other, chosen=True))
    assert text == "2.86 times mesh (2.85 to 3.32)"
    saved = savings_table([Saving("rays", "the mesh fits", one - other, one.is_distinct(other), 0)]).rows[0]
    assert saved[2] == "19.5\u00a0ms (18.5 to 22)"


def test_a_machine_that_slows_down_hides_no_difference_from_pairs():
    clock = Clock()

    def work(seconds):
        def run():
            clock.now_s += seconds * (1.0 + 5.0 * clock.now_s)

        return run

    quick, slow = measured(clock, work(0.010), work(0.012))
    # The slow one's lower quartile is below the quick one's upper: taken alone they say nothing.
    assert slow.quartiles.low < quick.quartiles.high
    assert slow.is_distinct(quick)
    assert slow.ratio(quick).median == pytest.approx(1.2, rel=0.1)


@pytest.mark.parametrize("step_s", [1e-9, 1e-6, 1 / 64])
@pytest.mark.parametrize("steps", [0.03, 0.9, 7.3, 3e4])
def test_a_coarse_clock_tells_short_work_to_a_hundredth(step_s, steps):
    clock = Clock(step_s)
    (found,) = measured(clock, clock.work(steps * step_s))
    # Up to a step is not seen at either end, of a hundred or more.
    assert found.rounds == pytest.approx([steps * step_s] * ROUNDS.least, rel=0.011)


def test_works_that_are_compared_take_turns():
    clock, runs = Clock(), []

    def work(name):
        def run():
            clock.now_s += 1.0
            runs.append(name)
            return name

        return run

    found = timed_together([work("a"), work("b"), work("c")], Effort(12, 12, 0.0), clock)
    assert [result for result, _ in found] == ["a", "b", "c"]
    assert [seconds.rounds for _, seconds in found] == [pytest.approx((1.0,) * 12, rel=1e-5)] * 3
    warm_up, *rounds = ("".join(runs[k : k + 3]) for k in range(0, len(runs), 3))
    assert warm_up == "abc"
    assert {"".join(sorted(one)) for one in rounds} == {"abc"}
    # None always comes after the same one.
    assert len(set(rounds)) > 3


def test_waiting_is_not_counted():
    _, seconds = timed(lambda: time.sleep(0.02), Effort(1, 1, 0.0))
    assert 0.0 < seconds.median < 0.01


def test_rounds_go_on_until_every_work_has_had_its_seconds():
    clock = Clock()
    for least, most, seconds, rounds in ((2, 9, 0.0, 2), (2, 9, 0.45, 5), (2, 4, 9.0, 4)):
        found = timed_together([clock.work(0.1)] * 2, Effort(least, most, seconds), clock)
        assert [len(taken.rounds) for _, taken in found] == [rounds] * 2


def test_rounds_end_when_all_works_have_had_their_seconds_together():
    clock = Clock()
    for most_s, rounds in ((0.5, 3), (0.05, 1)):
        found = timed_together([clock.work(0.1)] * 2, Effort(7, 9, 0.25, most_s), clock)
        assert [len(taken.rounds) for _, taken in found] == [rounds] * 2


def test_a_few_rounds_tell_apart_only_where_all_agree():
    def ratio(*ratios):
        return Seconds(ratios).is_distinct(Seconds((1.0,) * len(ratios)))

    assert not ratio(*[2.0] * 5)
    assert ratio(*[2.0] * 6)
    # The quartiles are above 1, but as many rounds agree by chance in 18 of 100 cases.
    assert not ratio(*[2.0] * 7, 0.9, 0.9)
    assert ratio(*[2.0] * 8, 0.9)
    assert ratio(*[0.5] * 8, 1.1)
    assert not ratio(*[1.0] * 25)
    assert not ratio(*[2.0] * 18, *[0.9] * 7)
    assert ratio(*[2.0] * 19, *[0.9] * 6)


def test_one_round_tells_nothing():
    one, other = Seconds((1.0,)), Seconds((5.0,))
    assert not one.is_distinct(other)
    assert compared_text(method("rays", other), method("mesh", one)) == "–"


def test_times_add_up_round_by_round():
    drawing, looking = Seconds((1.0, 2.0, 4.0)), Seconds((8.0, 4.0, 2.0))
    assert (drawing + looking * 0.5).rounds == (5.0, 4.0, 5.0)
    assert (drawing - looking).rounds == (-7.0, -2.0, 2.0)
    assert (drawing - looking).median == -2.0
    assert Quartiles.from_values((1.0, 2.0, 3.0, 4.0, 5.0)) == (2.0, 3.0, 4.0)


def test_times_are_compared_with_the_chosen_method_or_else_the_cheapest():
    outside = Measured(Method("pixels", "none", 1.0, 1.0, "not here"))
    first, second = method("mesh", Seconds((1.0,))), method("rays", Seconds((2.0,)))
    assert baseline([outside, first, second]) is first
    taken = method("rays", Seconds((2.0,)), chosen=True)
    assert baseline([outside, first, taken]) is taken
    assert baseline([outside]) is None
