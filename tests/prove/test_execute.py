"""All paths of a function at once: merged, unrolled, followed, and what they must keep."""

import ast
import os
import signal
import threading
from types import SimpleNamespace

import pytest

from innervate.dialect.plain import Outbox as PlainOutbox
from innervate.dialect.plain import make
from innervate.kernel.stop import Stop
from innervate.prove.check import _is_refuted, check, reached, unreached
from innervate.prove.errors import ProveError, UnsureError
from innervate.prove.express import greatest, least
from innervate.prove.solve import Formulas, Question
from innervate.prove.steps import Goal, Stage, own_goals

FIELDS = (("a", 0, -5, 200, "x", "one"), ("list", 4, 0, 9, "x", "four"))
SOURCE = """
def least(s, n):
    found = 99
    at = -1
    for i in range(n):
        if s.list[i] == 7:
            continue
        if s.list[i] == 8:
            break
        if s.list[i] < found:
            found = s.list[i]
            at = i
    return at

def early(s, n):
    if n > 3:
        if s.a < 0:
            return -1
        s.a = s.a + 1
    elif n == 2:
        return 7 if s.a > 5 else 8
    while s.a < n:
        s.a = s.a + 2
    return s.a

def outside(s, n):
    return s.list[n]

def never(s, n):
    if n > 50:
        return 1
    return 0

def changes(s, n):
    return n > 2 and early(s, n) == 3

def works(s, n):
    s.list[0] = min(s.list[1], n, 2)
    s.list[2] = max(n - 3, s.list[3] - 6, 0)
    s.list[1] = abs(n - 2)
    s.list[3] = (1 < n <= 3) + (False or n == 4) + (True and n != 2)
    if n == 0 and s.list[3] > 0 and later(s, n):
        s.list[3] = 9
    return -s.a + ~n * 2 - (3 if n > 2 else s.a & n)

def later(s, n):
    s.list[0] = 7
    return n == 0

def nested(s, n):
    total = 0
    for i in range(4):
        if i == n:
            break
        for j in range(3):
            if j == 1:
                continue
            if j > n + s.a:
                break
            total = total + j + 1
        if total > 5:
            continue
        total = total + 10
    return total

def strange(s, n):
    return n is s
"""


def function(name):
    nodes = {node.name: node for node in ast.parse(SOURCE).body}
    return SimpleNamespace(name=name, node=nodes[name], module="m", path="m.py", constants={},
                           calls={known: known for known in nodes})  # fmt: skip


def stage_of():
    names = [node.name for node in ast.parse(SOURCE).body]
    stage = Stage({name: function(name) for name in names}, FIELDS, 4)
    return stage, stage.record("s", FIELDS)


def plainly(name, values, n):
    known = {}
    exec(SOURCE, known)
    state = make("S", FIELDS)()
    state.a, state.list = values[0], list(values[1:])
    return known[name](state, n), [state.a, *state.list]


@pytest.mark.parametrize("name", ["least", "early", "changes", "works", "nested"])
@pytest.mark.parametrize("n", range(5))
def test_a_function_does_what_it_does_in_python(name, n):
    stage, s = stage_of()
    number = stage.terms.unknown("n", 0, 4)
    step = stage.play(name, name, [s, number], [])
    question = Question(Formulas(), [])
    terms = stage.terms
    for values in ((3, 5, 7, 2, 8), (-5, 9, 9, 9, 1), (6, 7, 8, 0, 0), (0, 1, 2, 3, 4)):
        is_it = [terms.same(number, terms.number(n))]
        for (key, _low, _high), value in zip(s.places(), values, strict=True):
            is_it.append(terms.same(step.before[key], terms.number(value)))
        assert question.values(*is_it) is not None
        result, left = plainly(name, values, n)
        assert question.value(terms.as_number(step.result)) == result
        assert [question.value(step.after[key]) for key, _, _ in s.places()] == left


def test_the_least_and_the_greatest_of_some_lie_in_a_range_of_their_own():
    terms = stage_of()[0].terms
    a, b = terms.unknown("a", -3, 9), terms.unknown("b", 2, 5)
    for made, ends in ((least(terms, a, b), (-3, 5)), (greatest(terms, a, b), (2, 9))):
        assert (made.low, made.high) == ends


def test_what_is_not_of_the_dialect_is_an_error():
    stage, s = stage_of()
    with pytest.raises(ProveError, match=r"strange \(m.py:\d+\): no such comparison"):
        stage.play("strange", "strange", [s, stage.number(3)], [])


def test_both_ways_of_a_choice_are_noted():
    stage, s = stage_of()
    step = stage.play("early", "early", [s, stage.terms.unknown("n", 0, 4)], [])
    line = next(number for number, text in enumerate(SOURCE.splitlines(), 1) if "7 if" in text)
    assert {(taken, len(guards)) for (_, at, taken), guards in step.all_ways().items()
            if at == line} == {(True, 1), (False, 1)}  # fmt: skip


def test_an_index_that_may_leave_its_array_is_refuted():
    stage, s = stage_of()
    step = stage.play("outside", "outside", [s, stage.terms.unknown("n", 0, 4)], [])
    step.goals = own_goals(step, ("s",), 0, 0)
    assert [bad.goal for bad in check(step).refuted] == [
        "no index leaves its array: outside (m.py:27)"
    ]


def test_a_branch_that_nothing_takes_is_found():
    stage, s = stage_of()
    number = stage.terms.unknown("n", 0, 60)
    known = [stage.terms.less(number, stage.terms.number(9))]
    step = stage.play("never", "never", [s, number], known)
    _, missed = reached(step, Question(Formulas(), step.facts))
    assert missed == {("never", 30, True)}
    assert list(unreached([check(step)])) == [("never", 30, True)]


def test_a_step_from_nowhere_proves_nothing():
    stage, s = stage_of()
    step = stage.play("never", "never", [s, stage.number(1)], [stage.terms.false])
    step.goals = [Goal("anything", stage.terms.false)]
    with pytest.raises(ProveError, match="no state is as assumed"):
        check(step)


def test_plain_outboxes_and_those_of_formulas_have_the_same_room():
    assert PlainOutbox(make("F", FIELDS), 4).limit == [stage_of()[0].out.limit]


def test_who_may_not_think_long_enough_says_so():
    stage, _ = stage_of()
    a, b = (stage.terms.unknown(name, 2, 60_000) for name in "ab")
    product = stage.terms.same(stage.terms.mul(a, b), stage.number(2_147_117_569))
    with pytest.raises(ProveError, match="the solver could not say: not within 50 of its steps"):
        Question(Formulas(), [], steps_max=50).values(product)


def test_ctrl_c_is_for_who_waits_for_it_and_the_solver_takes_it_from_nobody():
    stage, _ = stage_of()
    a, b = (stage.terms.unknown(name, 2, 60_000) for name in "ab")
    product = stage.terms.same(stage.terms.mul(a, b), stage.number(2_147_483_647))  # a prime
    timer = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))
    with Stop() as stop:
        timer.start()
        assert Question(Formulas(), []).values(product) is None
        timer.join()
    assert stop.asked


@pytest.mark.parametrize("holding", [True, False])
def test_what_is_too_much_at_once_is_asked_goal_by_goal(holding):
    """Four primes are no products: each takes 0.2 million steps, all together 0.6."""
    stage, s = stage_of()
    step = stage.play("never", "never", [s, stage.number(1)], [])
    primes = [1_046_527, 1_048_573, 1_046_533, 1_048_571 if holding else 1_037 * 1_009]
    for k, prime in enumerate(primes):
        a, b = (stage.terms.unknown(f"{name}{k}", 2, 2_000) for name in "ab")
        is_product = stage.terms.same(stage.terms.mul(a, b), stage.number(prime))
        step.goals.append(Goal(f"{prime} is prime", stage.terms.negated(is_product)))
    wrong = [stage.terms.negated(goal.holds) for goal in step.goals]
    if holding:
        with pytest.raises(UnsureError):
            Question(Formulas(), [], steps_max=400_000).values(stage.terms.any(*wrong))
    assert _is_refuted(step, Question(Formulas(), [], steps_max=400_000)) != holding
    said = f"^{primes[0]} is prime: the solver could not say"
    with pytest.raises(UnsureError, match=said):
        _is_refuted(step, Question(Formulas(), [], steps_max=1_000))


def test_what_cannot_be_said_is_told_with_its_step(monkeypatch):
    stage, s = stage_of()
    step = stage.play("never", "never", [s, stage.number(1)], [])
    a, b = (stage.terms.unknown(name, 2, 2_000) for name in "ab")
    is_product = stage.terms.same(stage.terms.mul(a, b), stage.number(1_046_527))
    step.goals = [Goal("it is prime", stage.terms.negated(is_product))]
    monkeypatch.setattr(Question.__init__, "__defaults__", (1_000,))
    with pytest.raises(UnsureError, match=r"^never: it is prime: the solver could not say"):
        check(step, reach=False)
