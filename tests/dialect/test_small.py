"""What every protocol stands on: comparisons, draws, the outbox, plain records."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect import outbox, plain, rng
from innervate.dialect.arith import HALF16, HALF30, MASK16, MASK30, after, later


@pytest.mark.parametrize(("a", "b", "is_after"), [
    (5, 5, True), (6, 5, True), (5, 6, False), (5 + HALF30 - 1, 5, True), (5 + HALF30, 5, False),
    (3, MASK30, True), (MASK30, 3, False), (0, HALF30, False), (0, HALF30 + 1, True),
])  # fmt: skip
def test_a_clock_reading_is_after_another_within_half_a_round(a, b, is_after):
    assert bool(after(a, b)) == is_after


@pytest.mark.parametrize(("a", "b", "is_later"), [
    (5, 5, False), (6, 5, True), (5, 6, False), (5 + HALF16 - 1, 5, True), (5 + HALF16, 5, False),
    (0, MASK16, True), (MASK16, 0, False), (0, HALF16 + 1, True),
])  # fmt: skip
def test_a_sequence_number_is_later_within_half_of_all_and_not_itself(a, b, is_later):
    assert bool(later(a, b)) == is_later


@pytest.mark.parametrize(("seed", "state"), [
    (1, 1), (0, 1), (rng.FIXED_POINT, 1), (rng.FIXED_POINT + 5, 5),
    (rng.FIXED_POINT - 1, rng.FIXED_POINT - 1),
])  # fmt: skip
def test_any_seed_is_a_state_that_goes_on(seed, state):
    assert rng.seeded(seed) == state
    assert 0 < rng.step(state) < 1 << 30
    assert rng.step(state) != state


def test_a_step_multiplies_with_carry():
    assert rng.step(1) == 32_730
    assert rng.step((7 << 15) | 3) == 3 * 32_730 + 7


def state(x=12_345, choice=rng.GENERATE):
    return Of(rng=x, choice=choice, asked=-9)


@pytest.mark.parametrize("n", [1, 2, 7, rng.LOW15])
def test_a_small_draw_takes_one_step(n):
    one = state()
    x = rng.step(12_345)
    assert rng.draw(one, n) == ((x & 32_767) * n) >> 15
    assert (one.rng, one.asked) == (x, -9)


@pytest.mark.parametrize("n", [rng.LOW15 + 1, 1_000_000, (1 << 30) - 1])
def test_a_large_draw_takes_two(n):
    one = state()
    x = rng.step(12_345)
    y = rng.step(x)
    assert rng.draw(one, n) == (((x & 32_767) << 15) | (y & 32_767)) % n
    assert one.rng == y


@pytest.mark.parametrize(("choice", "n", "drawn"), [(0, 4, 0), (3, 4, 3), (4, 4, 3), (9, 1, 0)])
def test_whoever_chooses_is_asked_of_how_many_and_draws_nothing(choice, n, drawn):
    one = state(choice=choice)
    assert rng.draw(one, n) == drawn
    assert (one.rng, one.asked) == (12_345, n)


FRAME = (("kind", 0, 1, 9, "", ""), ("path", 2, 0, 9, "", ""), ("heard", "ports", -3, -1, "", ""))


def test_plain_records_begin_in_their_ranges_and_apart():
    made = plain.make("Frame", FRAME, (("more", 0, -5, 5, "", ""),), ports=3)
    one, other = made(), made()
    assert (one.kind, one.path, one.heard, one.more) == (1, [0, 0], [-1] * 3, 0)
    one.path[0] = 7
    assert (other.path, made().path) == ([0, 0], [0, 0])
    with pytest.raises(AttributeError):
        one.pth = 1
    assert made.__name__ == "Frame"
    assert plain.make("One", (("only", 1, 2, 9, "", ""),))().only == [2]


def test_actions_are_put_one_behind_the_other_until_there_is_no_room():
    out = plain.Outbox(plain.make("Frame", FRAME[:2]), 4)
    assert [outbox.send(out, 1, 20, 3), outbox.set_timer(out, 2, 30), outbox.deliver(out, 4),
            outbox.report(out, 5, 6, 7)] == [0, 1, 2, 3]  # fmt: skip
    assert [(act.kind, act.a, act.b, act.c) for act in out.action] == [
        (outbox.SEND, 1, 20, 3), (outbox.SET_TIMER, 2, 30, 0), (outbox.DELIVER, 4, 0, 0),
        (outbox.REPORT, 5, 6, 7),
    ]  # fmt: skip
    assert (out.count, out.overflow) == ([4], [0])
    assert outbox.report(out, 9, 9, 9) == 3  # a place that there is
    assert (out.count, out.overflow, out.action[3].a) == ([4], [1], 5)
    assert len({outbox.URGENT, outbox.FLUSH, outbox.STOP}) == 3
