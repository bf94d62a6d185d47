"""Values of expressions and of loops, each by hand, and what is refused with its place."""

import ast
from types import SimpleNamespace as Of

import pytest

from innervate.dialect.outbox import DELIVER, SEND
from innervate.prove import execute
from innervate.prove.check import check
from innervate.prove.errors import ProveError
from innervate.prove.records import Partly, Record, either, name_of, unknowns
from innervate.prove.solve import Formulas, Question
from innervate.prove.steps import Stage, own_goals
from innervate.prove.terms import Terms

FRAME = (("kind", 0, 0, 7, "kind", ""),)
STATE = (("a", 0, -100, 100, "x", "one"), ("list", 4, 0, 99, "x", "four"))
SOURCE = """
def send(out, port):
    pass

def deliver(out, kind):
    pass

def report(out, code, a, b):
    pass

def draw(s, n, m, out):
    return n + 20

def looks(s, n, m, out):
    return s.list[n]

def puts(s, n, m, out):
    s.list[n] = m

def more(s, n, m, out):
    s.a += n
    m -= 1
    s.list[1] += m
    return m

def shifts(s, n, m, out):
    return m >> n

def known(s, n, m, out):
    return (1 if 2 > 1 else 0) * 10 + (3 if 1 > 2 else 4)

def far(s, n, m, out):
    for i in range(45):
        s.a = s.a + 1
    return i

def from_below(s, n, m, out):
    count = 0
    for i in range(n - 2, 3):
        count = count * 10 + i + 2
    return count

def at_once(s, n, m, out):
    for i in range(4):
        return n
    return 9

def soon(s, n, m, out):
    while n >= 0:
        return n
    return 9

def backwards(s, n, m, out):
    for i in range(m):
        s.list[m - 1 - i] = 1

def own_draw(s, n, m, out):
    return draw(s, n, m, out)

def reads_either(s, n, m, out):
    one = s.parts[0] if n > 2 else s.parts[1]
    return one.y * 10 + one.z[m]

def sends_either(s, n, m, out):
    if n > 2:
        place = send(out, 1)
    else:
        place = deliver(out, 2)
    out.frame[place].kind = 3

def reports(s, n, m, out):
    report(out, 4, 5, 6)

def deletes(s, n, m, out):
    del n

def lists(s, n, m, out):
    return [n]

def undeclared(s, n, m, out):
    return s.b

def which(s, n, m, out):
    return s.parts[n].y

def elsewhere(s, n, m, out):
    return nobody(n)

def length(s, n, m, out):
    return len(n)
"""
NODES = {node.name: node for node in ast.parse(SOURCE).body}
OUTBOX = ("send", "deliver", "report")
KNOWN = {
    name: Of(name=name, node=node, path="m.py", constants={},
             module=execute.OUTBOX if name in OUTBOX else "m",
             calls={**{one: one for one in NODES}, "nobody": "nobody"})
    for name, node in NODES.items()
}  # fmt: skip


def played(name, n=(0, 9), m=(0, 9)):
    """A step on a record with two parts, whose fields are y and z, and two numbers."""
    stage = Stage(KNOWN, FRAME, 3)
    s = stage.record("s", STATE)
    s.parts["parts"] = tuple(
        Record(f"part{i}", (("y", 0, 0, 9, "", ""), ("z", 2, 0, 9, "", ""))) for i in range(2)
    )
    for part in s.parts["parts"]:
        stage.store.update(unknowns(stage.terms, part))
    told = stage.record(
        "told", tuple((one, 0, *ends, "", "") for one, ends in (("n", n), ("m", m)))
    )
    numbers = [stage.store[told, one, None] for one in "nm"]
    return stage.play(name, name, [s, *numbers, stage.out], [])


BEFORE = {"s.a": 10, **{f"s.list[{i}]": 11 * (i + 1) for i in range(4)},
          "part0.y": 1, "part0.z[0]": 2, "part0.z[1]": 3,
          "part1.y": 4, "part1.z[0]": 5, "part1.z[1]": 6}  # fmt: skip


def where(step, **given):
    """A question that has found these values of what the step was played on."""
    t, wanted = step.terms, BEFORE | given
    places = {name_of(key): term for key, term in step.before.items()}
    question = Question(Formulas(), step.facts)
    assert question.values(*(t.same(places[name], t.number(value))
                             for name, value in wanted.items())) is not None  # fmt: skip
    return question


def comes_to(name, n, m=0, n_ends=(0, 9), m_ends=(0, 9)):
    """What a function returns, and the record afterwards."""
    step = played(name, n_ends, m_ends)
    question, s = where(step, **{"told.n": n, "told.m": m}), step.records["s"]
    result = None if step.result is None else question.value(step.terms.as_number(step.result))
    places = [(s, "a", None), *((s, "list", i) for i in range(4))]
    return result, [question.value(step.after[place]) for place in places]


WIDE = (-5, 9)


@pytest.mark.parametrize(("n", "found"), [(0, 11), (1, 22), (2, 33), (3, 44)])
@pytest.mark.parametrize("ends", [(0, 3), WIDE])
def test_what_stands_at_an_index_is_read_and_written_there(n, found, ends):
    left = [11, 22, 33, 44]
    assert comes_to("looks", n, n_ends=ends) == (found, [10, *left])
    left[n] = 7
    assert comes_to("puts", n, 7, n_ends=ends) == (None, [10, *left])


@pytest.mark.parametrize("ends", [(4, 6), (-3, -1), (4, 4), (-1, -1)])
def test_an_index_that_is_never_inside_is_refuted_and_ends_nothing(ends):
    step = played("looks", ends)
    step.goals = own_goals(step, ("s",), 0, 0)
    (bad,) = check(step, reach=False).refuted
    assert bad.goal == "no index leaves its array: looks (m.py:15)"


def test_what_is_added_to_a_place_is_what_it_was_and_that():
    assert comes_to("more", 5, 3) == (2, [15, 11, 24, 33, 44])


@pytest.mark.parametrize("n", [0, 1, 2, 15, 30, 31])
@pytest.mark.parametrize("ends", [(0, 31), (0, 40), (-1, 31)])
def test_a_shift_is_by_as_much_as_is_said_however_much_it_could_be(n, ends):
    m = (1 << 31) - 1
    assert comes_to("shifts", n, m, ends, (0, m))[0] == m // 2**n


def test_of_a_choice_that_is_known_one_way_is_taken():
    assert comes_to("known", 0)[0] == 14


def test_a_loop_whose_end_is_known_is_run_to_it_however_far_it_is():
    assert comes_to("far", 0) == (44, [55, 11, 22, 33, 44])
    step = played("far")
    step.goals = [goal for goal in own_goals(step, ("s",), 0, 0) if "ends" in goal.name]
    assert step.goals == []


@pytest.mark.parametrize(("n", "count"), [(0, 1234), (1, 1234), (2, 234), (4, 4), (5, 0)])
def test_a_loop_begins_where_it_is_said_below_nothing_too(n, count):
    assert comes_to("from_below", n)[0] == count


@pytest.mark.parametrize("name", ["at_once", "soon"])
def test_a_loop_that_every_path_leaves_at_once_is_run_once(name):
    assert comes_to(name, 3)[0] == 3


@pytest.mark.parametrize(("most", "is_refuted"), [(4, False), (5, True)])
def test_a_pass_is_made_only_where_the_loop_goes_on(most, is_refuted):
    step = played("backwards", m=(0, most))
    step.goals = own_goals(step, ("s",), 0, 0)
    assert bool(check(step, reach=False).refuted) == is_refuted


def test_a_function_of_the_protocol_may_be_called_as_what_draws():
    step = played("own_draw")
    assert comes_to("own_draw", 3)[0] == 23
    assert step.machine.draws == []


@pytest.mark.parametrize(("n", "m", "found"), [(3, 0, 12), (3, 1, 13), (2, 0, 45), (2, 1, 46)])
def test_of_two_records_that_is_read_which_is_meant(n, m, found):
    assert comes_to("reads_either", n, m, m_ends=(0, 1))[0] == found


@pytest.mark.parametrize(("n", "kinds"), [(3, [3, 1]), (2, [1, 3])])
def test_of_two_frames_that_is_written_which_is_meant(n, kinds):
    step = played("sends_either")
    sent, delivered = step.machine.out.actions
    assert [one.kind for one in (sent, delivered)] == [SEND, DELIVER]
    t, question = step.terms, Question(Formulas(), step.facts)
    blank = [t.same(t.unknown(f"out{i}.kind", 0, 7), t.number(1)) for i in range(2)]
    number = step.before[step.records["told"], "n", None]
    assert question.values(*blank, t.same(number, t.number(n))) is not None
    found = [question.value(step.after[one.frame, "kind", None]) for one in (sent, delivered)]
    assert found == kinds
    assert [question.holds(one.guard) for one in (sent, delivered)] == [n > 2, n <= 2]


def test_what_an_action_is_not_told_is_0():
    step = played("sends_either")
    told = [(one.a.value, one.b.value, one.c.value) for one in step.machine.out.actions]
    assert told == [(1, 0, 0), (2, 0, 0)]
    (one,) = played("reports").machine.out.actions
    assert (one.a.value, one.b.value, one.c.value) == (4, 5, 6)


@pytest.mark.parametrize(("name", "why"), [
    ("deletes", r"deletes \(m.py:\d+\): the dialect has no such statement"),
    ("lists", r"lists \(m.py:\d+\): \[n\] is not of the dialect"),
    ("undeclared", r"undeclared \(m.py:\d+\): s.b is not declared"),
    ("which", r"which \(m.py:\d+\): which record is not known"),
    ("elsewhere", r"elsewhere \(m.py:\d+\): nobody is not of the protocol"),
    ("length", r"length \(m.py:\d+\): len is not of the dialect"),
])  # fmt: skip
def test_what_cannot_be_said_is_refused_with_its_place(name, why):
    with pytest.raises(ProveError, match=why):
        played(name)


def test_of_two_that_may_be_meant_it_is_told_where_there_is_one():
    t = Terms()
    if_, one, other = t.less(t.unknown("n", 0, 9), t.number(3)), Record("a"), Record("b")
    assert either(t, if_, one, None) == Partly(if_, one)  # a value there alone
    assert either(t, if_, None, other) == Partly(t.negated(if_), other)
    assert either(t, if_, one, one) is one
    found = either(t, if_, one, other)
    assert (found.if_, found.a, found.b) == (if_, one, other)
    assert either(t, if_, t.number(1), one).a is t.number(1)
