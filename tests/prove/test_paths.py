"""Which path a thing is done on: one of two records, draws, what no path comes to."""

import ast
from types import SimpleNamespace as Of

import pytest

from innervate.prove import execute
from innervate.prove.answers import Answers
from innervate.prove.check import check, reached
from innervate.prove.records import Outbox, Record, unknowns
from innervate.prove.solve import Formulas, Question
from innervate.prove.steps import RANGES, Stage, own_goals
from innervate.prove.terms import Terms

SOURCE = """
def draw(s, count):
    pass

def picks(s, n, m):
    one = s.parts[0] if n > 2 else s.parts[1]
    one.y = 5

def behind_known(s, n, m):
    return n < 2 and s.parts[n].y == 1

def behind_nothing(s, n, m):
    if n > m:
        if n > m:
            return 0
        return s.parts[m].y
    return 1

def says_true(s, n, m):
    return True

def draws_some(s, n, m):
    if n > 2:
        return draw(s, 4)
    return 9

def both(s, n, m):
    s.parts[0].y = n
    s.parts[1].y = m
"""
NODES = {node.name: node for node in ast.parse(SOURCE).body}
KNOWN = {
    name: Of(name=name, node=node, path="m.py", constants={}, calls={one: one for one in NODES},
             module=execute.RANDOM if name == "draw" else "m")
    for name, node in NODES.items()
}  # fmt: skip


def played(name, n=(0, 9), m=(0, 9)):
    """A step on a record with two parts of one name."""
    stage = Stage(KNOWN, (), 3)
    whole = stage.record("s")
    parts = tuple(Record("part", (("y", 0, 0, 9, "", ""),)) for _ in range(2))
    whole.parts["parts"] = parts
    for place, part in enumerate(parts):
        made = unknowns(stage.terms, part)
        stage.store.update({key: stage.terms.unknown(f"y{place}", 0, 9) for key in made})
    numbers = [stage.terms.unknown(one, *ends) for one, ends in (("n", n), ("m", m))]
    return stage.play(name, name, [whole, *numbers], []), parts


def values(step, **given):
    """A question that has found a state with these values."""
    t = step.terms
    question = Question(Formulas(), step.facts)
    wanted = [t.same(t.unknown(name, 0, 9), t.number(value)) for name, value in given.items()]
    assert question.values(*wanted) is not None
    return question


@pytest.mark.parametrize(("n", "now"), [(2, [3, 5]), (3, [5, 4])])
def test_of_two_records_that_is_written_which_is_meant(n, now):
    step, parts = played("picks")
    question = values(step, n=n, y0=3, y1=4)
    assert [question.value(step.after[part, "y", None]) for part in parts] == now


@pytest.mark.parametrize(("n", "m"), [((5, 5), (0, 9)), ((2, 2), (0, 9))])
def test_what_is_never_asked_need_not_be_there(n, m):
    step, _ = played("behind_known", n, m)
    assert step.result is step.terms.false


def test_what_no_path_comes_to_is_not_run():
    step, _ = played("behind_nothing")
    question = values(step, n=3, m=2)
    assert question.value(step.terms.as_number(step.result)) == 0


def test_a_truth_that_is_written_out_is_one():
    step, _ = played("says_true")
    assert step.result is step.terms.true


@pytest.mark.parametrize(("n", "is_drawn"), [(2, False), (3, True)])
def test_a_draw_is_made_where_its_path_goes_and_is_below_its_most(n, is_drawn):
    step, _ = played("draws_some")
    ((drawn, many, where),) = step.machine.draws
    assert (drawn.low, drawn.high, many.value) == (0, 3, 4)
    assert values(step, n=n).holds(where) == is_drawn


@pytest.mark.parametrize(("n", "m", "is_refuted"), [
    ((0, 9), (0, 9), False), ((0, 10), (0, 9), True), ((0, 9), (0, 10), True),
    ((0, 10), (-1, 9), True), ((-1, 9), (0, 10), True), ((-1, 9), (-1, 9), False),
])  # fmt: skip
def test_records_of_one_name_stay_in_range_each(n, m, is_refuted):
    """Whatever their ranges say, none of the numbers is below 0."""
    step, _ = played("both", n, m)
    t = step.terms
    step.facts += [t.less(t.number(-1), t.unknown(*one)) for one in (("n", *n), ("m", *m))]
    step.goals = own_goals(step, ("s",), 0, 0)
    found = {bad.goal for bad in check(step, reach=False).refuted}
    assert found == ({f"{RANGES}: part.y"} if is_refuted else set())


def test_ways_that_are_known_are_not_asked_for_again():
    step, _ = played("behind_nothing")
    question = Question(Formulas(), step.facts)
    every, missed = reached(step, question)
    (never,) = missed
    assert len(every) == 3
    for known in every:
        assert reached(step, question, [known]) == (every - {known}, missed)
    assert reached(step, question, [never]) == (every, set())


def test_questions_on_two_records_are_two_questions():
    terms = Terms()
    one, other = Record("a"), Record("a")
    made = Answers({}, terms, Outbox((), 0), ())
    n = terms.unknown("n", 0, 9)
    assert made.is_same([one, n], [one, n]) is terms.true
    assert made.is_same([one, n], [other, n]) is terms.false
    assert made.is_same([one, n], [one, terms.number(3)]) is terms.same(n, terms.number(3))
    assert made.is_same([n], [one]) is terms.false
