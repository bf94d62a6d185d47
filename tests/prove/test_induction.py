"""Loops by induction, and functions whose answers may be any: what they leave out is seen to."""

import ast
from types import SimpleNamespace

import pytest

from innervate.prove import execute
from innervate.prove.answers import Answers
from innervate.prove.check import check
from innervate.prove.errors import ProveError
from innervate.prove.induction import Induction
from innervate.prove.records import Outbox
from innervate.prove.steps import Goal, Stage, Step

FIELDS = (
    ("a", 0, 0, 500, "x", "one"),
    ("b", 0, 0, 9, "x", "other"),
    ("list", 4, 0, 9, "x", "four"),
)
SOURCE = """
def rises(s, n):
    more = 0
    for i in range(40):
        if s.list[i & 3] > n:
            s.a = s.a + 2
            more = more + 1
    return more

def also(s, n):
    for i in range(40):
        s.a = s.a + 1
        s.b = 3

def ends(s, n):
    for i in range(40):
        if s.a == n:
            break

def unknown(s, n):
    for i in range(n):
        s.a = s.a + 1

def has(s, n):
    for k in range(4):
        if s.list[k] == n:
            return 1
    return 0

def asks(s, n):
    first = has(s, n)
    s.b = 1
    return first + has(s, n)

def changed(s, n):
    first = has(s, n)
    s.list[0] = 3
    return first + has(s, n)

def writes(s, n):
    s.b = n
    return 1

def hides(s, n):
    return writes(s, n)

def hasnt(s, n):
    for k in range(4):
        if s.list[k] == n:
            return 0
    return 1

def asks_two(s, n):
    return has(s, n) + hasnt(s, n)

def asks_others(s, n):
    return has(s, n) + has(s, n + 1)

def wraps(s, n):
    return has(s, n)

def changed_within(s, n):
    first = wraps(s, n)
    s.list[0] = 3
    return first + wraps(s, n)

def as_it_is(s, n):
    return n

def far(s, n):
    near = as_it_is(s, n)
    return as_it_is(s, n + 20)

def between(s, n, m):
    return n - m

def how_far(s, n):
    return between(s, n, s.b)

def report(out, code, a, b):
    pass

def tells(s, n):
    report(s, 1, n, n)
    return 1

def hears(s, n):
    return tells(s, n)

def silent(s, n):
    if n > 3:
        return 1

def waits(s, n):
    return silent(s, n)

def draw(s, count):
    pass

def chances(s, n):
    return draw(s, 3)

def hopes(s, n):
    return chances(s, n)

def from_one(s, n):
    for i in range(1, 40):
        s.a = s.a + 1

def acts(s, n):
    for i in range(40):
        report(s, 1, 2, 3)

def behind(s, n):
    for i in range(40):
        s.a = s.a + 1
    return s.list[s.b]
"""
NODES = {node.name: node for node in ast.parse(SOURCE).body}
KNOWN = {
    name: SimpleNamespace(name=name, node=node, path="m.py", constants={},
                          module={"report": execute.OUTBOX, "draw": execute.RANDOM}.get(name, "m"),
                          calls={one: one for one in NODES})
    for name, node in NODES.items()
}  # fmt: skip


def run(name, machine_of, n=9):
    stage = Stage(KNOWN, FIELDS, 4)
    s, machine = stage.record("s", FIELDS), machine_of(stage)
    stage.store[s, "a", None] = stage.number(0)
    before = dict(stage.store)
    given = [s, stage.terms.unknown("n", 0, n)]
    after, result = machine.run(name, given, dict(before))
    return Step(name, machine, stage.records, before, after, [*machine.facts], result=result)


def looped(name, most=80, least=0, more=40):
    """A loop of 40 passes, of which `a` and `more` may be anything in these ranges at the head."""

    def machine_of(stage):
        made = Induction(KNOWN, stage.terms, Outbox(FIELDS, 4))
        made.looped = name

        def vary(state):
            state.store[stage.records["s"], "a", None] = stage.terms.unknown("a then", least, most)
            if "more" in state.names:
                state.names["more"] = stage.terms.unknown("more then", 0, more)

        made.vary = vary
        return made

    return run(name, machine_of)


def claim(step, times):
    """That `a` is so many times `more` at every head, which is then so behind the last."""
    t, passes, s = step.terms, step.machine.passes, step.records["s"]

    def holds(state, done):
        more = state.names["more"]
        so_much = t.same(state.store[s, "a", None], t.mul(t.number(times), more))
        return t.all(so_much, t.at_most(t.as_number(more), done))

    more = t.add(passes.at, t.number(1))
    step.facts.append(holds(passes.head, passes.at))
    step.goals = [
        Goal("first", holds(passes.entered, t.number(0))),
        Goal("each", t.implies(passes.is_pass, holds(passes.passed, more))),
        Goal("fits", passes.fits(t)),
        Goal("last", t.implies(t.negated(passes.is_pass),
                               t.same(step.now("s", "a"), t.mul(t.number(2), step.result)))),
    ]  # fmt: skip
    return [bad.goal for bad in check(step).refuted]


def test_what_holds_before_and_behind_each_pass_holds_behind_all():
    assert claim(looped("rises"), 2) == []


def test_what_a_pass_does_not_keep_is_refuted():
    assert claim(looped("rises"), 3) == ["each", "last"]


@pytest.mark.parametrize("ends", [{"most": 70}, {"least": 1}, {"more": 39}])
def test_values_beyond_what_is_taken_for_any_are_refuted(ends):
    assert claim(looped("rises", **ends), 2) == ["fits"]


def test_what_follows_a_loop_is_come_to_behind_its_last_pass():
    step = looped("behind")
    (demand,) = [one for one in step.machine.demands if "index" in one.what]
    assert demand.guard is step.terms.negated(step.machine.passes.is_pass)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("also", "a pass changes"),
        ("ends", "ends the loop"),
        ("unknown", "how many passes"),
        ("from_one", "how many passes"),
        ("acts", "a pass acts"),
    ],
)
def test_a_loop_that_cannot_be_taken_so_is_an_error(name, words):
    with pytest.raises(ProveError, match=words):
        looped(name)


def asked(name, of):
    return run(name, lambda stage: Answers(KNOWN, stage.terms, stage.out, of))


@pytest.mark.parametrize(("name", "alike"), [("asks", True), ("changed", False)])
def test_the_same_question_has_the_same_answer_while_nothing_that_is_read_changes(name, alike):
    step = asked(name, ["has"])
    t = step.terms
    step.goals = [Goal("alike", t.negated(t.same(step.result, t.number(1))))]
    assert (check(step).refuted == []) == alike


@pytest.mark.parametrize(("name", "of"), [
    ("asks_two", ["has", "hasnt"]), ("asks_others", ["has"]), ("changed_within", ["wraps"]),
])  # fmt: skip
def test_another_question_may_have_another_answer(name, of):
    step = asked(name, of)
    t = step.terms
    step.goals = [Goal("alike", t.negated(t.same(step.result, t.number(1))))]
    assert len(check(step).refuted) == 1


def test_an_answers_range_is_that_of_its_question():
    step = asked("far", ["as_it_is"])
    assert (step.result.low, step.result.high) == (20, 29)


def test_two_of_one_range_that_are_asked_about_need_not_be_the_same_number():
    step = asked("how_far", ["between"])
    t = step.terms
    step.goals = [Goal("none", t.same(step.result, t.number(0))),
                  Goal("at most 9", t.within(step.result, -9, 9))]  # fmt: skip
    assert [bad.goal for bad in check(step).refuted] == ["none"]


def test_an_answer_may_be_any_and_no_other():
    step = asked("asks", ["has"])
    t = step.terms
    step.goals = [Goal("0 to 2", t.within(step.result, 0, 2)),
                  Goal("never", t.same(step.result, t.number(0)))]  # fmt: skip
    assert [bad.goal for bad in check(step).refuted] == ["never"]


def test_who_does_more_than_to_look_something_up_is_an_error():
    for name, of in (("hides", "writes"), ("hopes", "chances"), ("hears", "tells"),
                     ("waits", "silent")):  # fmt: skip
        with pytest.raises(ProveError, match=f"{of} does more"):
            asked(name, [of])
