"""The formulas that the solver is given do what the protocol does, call by call."""

import random

import pytest

from innervate.prove.solve import Formulas, z3
from innervate.prove.terms import Terms
from tests.networks.skin.prove.twins import HANDLERS, twins
from tests.prove.parity import compiled

CALLS = 150  # of each handler
ALL_CALLS = 25_000  # ... in `make full`: 100,000 in all


def test_drawn_calls_leave_the_same_state_and_outbox():
    made = twins()
    assert [one.step.name for one in made] == list(HANDLERS)
    assert [one.calls(CALLS, 1) for one in made] == [""] * 4


@pytest.mark.slow
@pytest.mark.parametrize("number", range(4))
def test_a_hundred_thousand_drawn_calls_do(number):
    assert twins()[number].calls(ALL_CALLS, 2) == ""


WRONG = {
    "on_timer": ("cell.hold = cell.hold + 1", "cell.hold = cell.hold + 2"),
    "on_frame": ("onward.hops = frame.hops + 1\n\n\ndef hand_down", "\n\ndef hand_down"),
    "on_input": ("cell.seq = (cell.seq + 1) & 255", "cell.seq = (cell.seq + 1) & 127"),
}


@pytest.mark.parametrize("handler", WRONG)
def test_a_formula_of_something_else_differs(handler):
    other = next(one for one in twins(WRONG[handler]) if one.step.name == handler)
    assert "in the formula" in other.calls(4_000, 1)


def test_what_is_compiled_of_a_formula_is_what_the_solver_makes_of_it():
    terms, draw = Terms(), random.Random("parity")
    a, b = terms.unknown("a", -900, 900), terms.unknown("b", 1, 30)
    made = [
        terms.div(a, b), terms.mod(a, b), terms.shr(a, b), terms.shl(a, b), terms.mul(a, b),
        terms.bits_xor(a, b), terms.bits_or(a, b), terms.bits_and(a, b), terms.less(a, b),
    ]  # fmt: skip
    formulas = Formulas()
    lowered = [formulas.of(one) for one in made]
    function = compiled(lowered, {})
    for _ in range(40):
        known = {"a": draw.randint(-900, 900), "b": draw.randint(1, 30)}
        values = [(z3.BitVec("a", 11), z3.BitVecVal(known["a"], 11)),
                  (z3.BitVec("b", 5), z3.BitVecVal(known["b"], 5))]  # fmt: skip
        for one, found in zip(lowered, function(known, 0), strict=True):
            solved = z3.simplify(z3.substitute(one, *values))
            is_truth = z3.is_bool(solved)
            assert (z3.is_true(solved) if is_truth else solved.as_long()) == found, (one, known)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("set_timer(out, TICK, now)", "set_timer(out, TICK, now); set_timer(out, 1, now)",
         "action 1 is in the formula alone"),
        ("set_timer(out, TICK, now)", "now = now", "1 actions, not 0"),
        ("set_timer(out, TICK, now)", "set_timer(out, 1, now)", "action 0 is "),
    ],
)  # fmt: skip
def test_actions_of_one_side_alone_are_told(old, new, says):
    start = twins((old, new))[0]
    assert start.step.name == "on_start"
    assert says in start.calls(50, 1)
