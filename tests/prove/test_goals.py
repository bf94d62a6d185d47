"""What every step has to keep: each goal holds up to its edge, and is refuted one beyond it."""

import ast
from types import SimpleNamespace

import pytest

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, SEND
from innervate.prove import execute
from innervate.prove.check import check
from innervate.prove.errors import ProveError
from innervate.prove.steps import RANGES, ROOM, SENT, Goal, Stage, own_goals, room, sent
from tests.prove.programs import ACTIONS

STATE = (("a", 0, -5, 200, "x", "one"), ("list", 4, 0, 9, "x", "four"))
FRAME = (("kind", 0, 0, 7, "kind", ""), ("to", 2, 1, 30, "x", ""))
ROOM_MOST, TIMERS, PORTS, MOST = 3, 2, 4, (1 << 31) - 1
SOURCE = (
    ACTIONS
    + """
def draw(state, count):
    pass

def looks(s, n, m, out):
    return s.list[n]

def puts(s, n, m, out):
    s.list[n] = 3

def stores(s, n, m, out):
    s.a = n

def stores_all(s, n, m, out):
    for i in range(4):
        s.list[i] = n

def adds(s, n, m, out):
    return n + 1

def subtracts(s, n, m, out):
    return n - 1

def divides(s, n, m, out):
    return 8 // n

def rests(s, n, m, out):
    return 8 % n

def shifts(s, n, m, out):
    return m >> n

def loops(s, n, m, out):
    for i in range(n):
        pass

def loops_from(s, n, m, out):
    for i in range(5, n):
        pass

def repeats(s, n, m, out):
    while n > 0:
        n = n - 1

def draws(s, n, m, out):
    return draw(s, n)

def sends(s, n, m, out):
    send(out, n, 0, 0)

def sends_it(s, n, m, out):
    place = send(out, 1, 0, 0)
    place_frame = out.frame[place]
    place_frame.kind = 2
    place_frame.to[1] = n

def hands_up(s, n, m, out):
    place_frame = out.frame[deliver(out, 1)]
    place_frame.to[0] = n

def sets(s, n, m, out):
    set_timer(out, n, 5)

def sets_at(s, n, m, out):
    set_timer(out, 1, n)

def fills(s, n, m, out):
    for i in range(n):
        report(out, 1, 2, 3)

def one_of_two(s, n, m, out):
    if n > 1:
        report(out, 1, 2, 3)
        report(out, 1, 2, 3)
    else:
        report(out, 1, 2, 3)
        report(out, 1, 2, 3)
    report(out, 1, 2, 3)

def inner(s, n):
    return s.list[n]

def in_an_if(s, n, m, out):
    if n < m:
        return s.list[n]
    return 0

def in_a_call(s, n, m, out):
    if n < m:
        return inner(s, n)
    return 0

def behind_and(s, n, m, out):
    return n < m and s.list[n] == 3

def behind_or(s, n, m, out):
    return n >= m or s.list[n] == 3

def in_a_choice(s, n, m, out):
    return s.list[n] if n < m else 0

def in_the_other(s, n, m, out):
    return 0 if n >= m else s.list[n]

def sends_some(s, n, m, out):
    if n < 4:
        send(out, n, 0, 0)

def fill(out):
    report(out, 1, 2, 3)
    report(out, 1, 2, 3)

def by_calls(s, n, m, out):
    if n > 1:
        fill(out)
    else:
        fill(out)
    report(out, 1, 2, 3)

def undeclared(s, n, m, out):
    s.b = 1

def behind_returns(s, n, m, out):
    if m > 2:
        if n > 3:
            return 0
    elif n > 3:
        return 0
    return s.list[n]

def behind_one_return(s, n, m, out):
    if m > 2:
        n = 0
    else:
        if n > 3:
            return 0
    return s.list[n]

def behind_the_other(s, n, m, out):
    if m > 2:
        if n > 3:
            return 0
    else:
        n = 0
    return s.list[n]

def behind_break(s, n, m, out):
    for i in range(8):
        if i == m:
            break
        s.list[i] = 1
"""
)
NODES = {node.name: node for node in ast.parse(SOURCE).body}
BUILT_IN = {name: execute.OUTBOX for name in ("send", "deliver", "set_timer", "report")}
KNOWN = {
    name: SimpleNamespace(name=name, node=node, path="m.py", constants={},
                          module=(BUILT_IN | {"draw": execute.RANDOM}).get(name, "m"),
                          calls={one: one for one in NODES})
    for name, node in NODES.items()
}  # fmt: skip


def played(name, n, m=(0, 9)):
    """A step with whatever numbers of these ranges."""
    stage = Stage(KNOWN, FRAME, ROOM_MOST)
    numbers = [stage.terms.unknown(one, *ends) for one, ends in (("n", n), ("m", m))]
    return stage.play(name, name, [stage.record("s", STATE), *numbers, stage.out], [])


def refuted(name, n, m=(0, 9)):
    step = played(name, n, m)
    step.goals = own_goals(step, ("s",), TIMERS, PORTS)
    return {bad.goal.partition(" (")[0] for bad in check(step, reach=False).refuted}


INDEX, FITS, BY = "no index leaves its array", "every number fits 32 bits", "shifts are by 0 .. 31"
DIVISOR, ENDS = "what is divided by is at least 1", "a loop ends"
EDGES = [  # what holds, and on which ranges of `n` it does not
    ("looks", INDEX, (0, 3), [(0, 4), (-1, 3)]), ("puts", INDEX, (0, 3), [(0, 4), (-1, 3)]),
    ("stores", f"{RANGES}: s.a", (-5, 200), [(-5, 201), (-6, 200)]),
    ("stores_all", f"{RANGES}: s.list[2]", (0, 9), [(0, 10), (-1, 9)]),
    ("adds", FITS, (0, MOST - 1), [(0, MOST)]),
    ("subtracts", FITS, (-MOST, 0), [(-MOST - 1, 0)]),
    ("divides", DIVISOR, (1, 4), [(0, 4), (-3, 4)]), ("rests", DIVISOR, (1, 4), [(0, 4)]),
    ("shifts", BY, (0, 31), [(0, 32), (-1, 31)]),
    ("loops", ENDS, (0, 40), [(0, 41)]), ("loops_from", ENDS, (0, 45), [(0, 46)]),
    ("repeats", ENDS, (0, 40), [(0, 41)]),
    ("draws", "what is drawn from is not empty", (1, 4), [(0, 4), (-1, 4)]),
    ("sends", SENT, (0, 3), [(0, 4), (-1, 3)]), ("sends_it", SENT, (1, 30), [(1, 31), (0, 30)]),
    ("hands_up", SENT, (1, 30), [(1, 31)]), ("sets", SENT, (0, 1), [(0, 2), (-1, 1)]),
    ("sets_at", SENT, (0, MASK30), [(0, MASK30 + 1), (-1, 9)]),
    ("fills", ROOM, (0, 3), [(0, 4)]),
]  # fmt: skip


@pytest.mark.parametrize(("name", "goal", "holds", "beyond"), EDGES)
def test_a_goal_holds_up_to_its_edge_and_not_beyond(name, goal, holds, beyond):
    assert refuted(name, holds) == set()
    for ends in beyond:
        assert any(one.startswith(goal) for one in refuted(name, ends)), ends


@pytest.mark.parametrize("count", [1, 2, 5])
def test_a_draw_may_be_0_and_is_below_what_it_is_from(count):
    ((drawn, many, _),) = played("draws", (count, count)).machine.draws
    assert (drawn.low, drawn.high, many.low) == (0, count - 1, count)


def test_what_is_not_sent_may_be_anything():
    assert refuted("sends_some", (0, 9)) == set()


def test_a_clock_shows_any_time():
    clock = Stage(KNOWN, FRAME, ROOM_MOST).clock()
    assert (clock.low, clock.high) == (0, MASK30)


def test_a_branch_is_taken_by_whichever_machine_comes_there():
    step, other = played("in_an_if", (0, 9)), played("in_an_if", (0, 9)).machine
    alone = step.all_ways()
    other.ways[("elsewhere", 1, True)] = []
    step.others = (other,)
    assert {way: len(guards) for way, guards in step.all_ways().items()} == {
        ("elsewhere", 1, True): 0, **{way: 2 * len(guards) for way, guards in alone.items()}
    }  # fmt: skip


def test_of_goals_that_do_not_hold_the_first_is_told_if_one_is_enough():
    step = played("adds", (0, 9))
    step.goals = [Goal("holds", step.terms.true), Goal("not", step.terms.false),
                  Goal("nor this", step.terms.false)]  # fmt: skip
    for singly in (False, True):
        step.singly = singly
        assert [bad.goal for bad in check(step, first_only=True).refuted] == ["not"]
        assert [bad.goal for bad in check(step).refuted] == ["not", "nor this"]
    assert 0 < check(step).wall_s < 60


def test_a_counterexample_keeps_to_all_wishes_that_it_can_keep_to():
    """One that the goal forbids is passed over, as is one that another forbids."""
    step = played("adds", (0, 9))
    t = step.terms
    n, m, a = t.unknown("n", 0, 9), t.unknown("m", 0, 9), step.was("s", "a")
    step.goals = [Goal("small", t.less(n, t.number(5)))]
    wishes = [t.same(one, t.number(value)) for one, value in
              ((n, 2), (m, 4), (a, 77), (m, 3), (n, 7))]  # fmt: skip
    for singly in (False, True):
        step.singly = singly
        (bad,) = check(step, simple=wishes, reach=False).refuted
        assert [bad.values[name] for name in ("n", "m", "s.a")] == [7, 4, 77]


@pytest.mark.parametrize("name", ["one_of_two", "by_calls"])
def test_what_fills_an_outbox_on_two_ways_needs_room_for_one(name):
    assert refuted(name, (0, 3)) == set()


def test_a_field_that_is_not_declared_is_told():
    words = r"undeclared \(m.py:\d+\): s.b is no field that is declared"
    with pytest.raises(ProveError, match=words):
        played("undeclared", (0, 3))


GUARDED = ("in_an_if", "in_a_call", "behind_and", "behind_or", "in_a_choice", "in_the_other",
           "behind_break")  # fmt: skip


@pytest.mark.parametrize("name", GUARDED)
def test_what_is_not_come_to_need_not_hold(name):
    assert refuted(name, (0, 9), m=(0, 4)) == set()
    (bad,) = refuted(name, (0, 9), m=(0, 5))
    assert bad.startswith(INDEX)


@pytest.mark.parametrize("name", ["behind_returns", "behind_one_return", "behind_the_other"])
def test_what_has_returned_goes_on_nowhere(name):
    assert refuted(name, (0, 9)) == set()


def test_every_field_that_leaves_its_range_is_told():
    found = refuted("stores_all", (0, 10))
    assert found == {f"{RANGES}: s.list[{i}]" for i in range(4)}


def test_frames_without_ports_may_go_anywhere():
    step = played("sends", (0, 9))
    step.goals = own_goals(step, ("s",), TIMERS, 0)
    assert check(step, reach=False).refuted == []


def test_any_draw_is_below_what_it_is_of():
    step = played("draws", (1, 4))
    t = step.terms
    n = t.unknown("n", 1, 4)
    step.goals = [Goal("below", t.all(t.less(step.result, n), t.at_most(t.number(0), step.result))),
                  Goal("never the last", t.less(step.result, t.number(3)))]  # fmt: skip
    assert [bad.goal for bad in check(step, reach=False).refuted] == ["never the last"]


def test_frames_of_a_kind_that_are_sent():
    step = played("sends_it", (1, 30))
    t = step.terms
    ((guard, port, frame),) = sent(step)
    assert guard is t.true
    assert port.value == 1
    assert frame is step.machine.out.actions[0].frame
    assert [len(list(sent(step, kind))) for kind in (1, 2)] == [0, 1]
    assert list(sent(played("hands_up", (1, 30)))) == []
    kinds = [one.kind for name in ("sends_it", "hands_up")
             for one in played(name, (1, 30)).machine.out.actions]  # fmt: skip
    assert kinds == [SEND, DELIVER]


def test_a_known_count_of_actions_decides_the_room_by_itself():
    step = played("fills", (3, 3))
    assert room(step) is step.terms.true
    assert room(played("fills", (4, 4))) is not step.terms.true
