"""What a cell's proofs assume and claim, of one cell whose values are known.

A cell that keeps all is changed in one or two values; those of its invariants that are broken then
are named. Numbers are told by how far they are ahead of the oldest in use.
"""

from types import SimpleNamespace

import pytest

from innervate.dialect.arith import HALF16, MASK16
from innervate.dialect.outbox import REPORT, SEND
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.protocol.constants import (
    BEACON,
    INFINITY,
    NONE,
    ONE,
    PERIODIC,
    REPORT_FORGET,
    RULE_FEASIBLE,
    TRIGGERED,
)
from innervate.networks.skin.prove import feasible, pc, strict
from innervate.networks.skin.prove.neighbours import (
    ROOM,
    Cell,
    Ghost,
    base_of,
    invariants,
    true_ghosts,
)
from innervate.prove.records import Record
from innervate.prove.steps import Stage

NUMBERS = {"sq", "sq_own", "fd_sq", "sent_sq"}
# Parent 0 said (5, 2), which is its feasible distance; port 1 said (5, 3); nobody else did.
SOUND = {
    "parent": 0, "dist": [2, 3, INFINITY, INFINITY], "sq": [5, 5, 0, 0], "pf": [0, 0, 0, 0],
    "heard": [1, 1, 0, 0], "child": [0, 0, 0, 0], "sq_own": 5, "sq_known": 1, "fd_known": 1,
    "fd_sq": 5, "fd_dist": 3, "wait": 0, "hold": 0, "soon": 0,
}  # fmt: skip
LOST = {"parent": NONE, "dist": [INFINITY] * 4}
GHOSTS = {0: (1, 5, 2, 0), 1: (1, 5, 3, 0), 2: (0, 0, 0, 0), 3: (0, 0, 0, 0)}


def ghost_of(t, known, sq, dist, old):
    """A neighbour of whom all is known."""
    number = t.wrapped(base_of(t), t.number(sq), MASK16)
    return Ghost(t.truth_of(known), number, t.number(dist), t.truth_of(old))


def put(stage, store, record, values):
    """Known values in place of any."""
    t = stage.terms
    for name, value in values.items():
        for index, one in enumerate(value) if isinstance(value, list) else ((None, value),):
            known = t.number(one)
            known = t.wrapped(base_of(t), known, MASK16) if name in NUMBERS else known
            store[record, name, index] = known


def cell_of(cell=(), ghosts=(), updates=PERIODIC, frame=()):
    """A cell with the values of SOUND but for these."""
    made = Cell({}, RULE_FEASIBLE)
    stage = made.stage
    put(stage, stage.store, made.cell, {**SOUND, **dict(cell)})
    put(stage, stage.store, made.frame, dict(frame))
    put(stage, stage.store, made.params, {"updates": updates, "max_depth": 64})
    made.ghosts = [ghost_of(stage.terms, *{**GHOSTS, **dict(ghosts)}[p]) for p in range(4)]
    return made


def view_of(*changes, **more):
    made = cell_of(*changes, **more)
    return made.view(made.stage.store)


def is_so(term):
    """A truth that is decided by what is known."""
    assert term.op == "const", term
    return bool(term.low)


def broken(goals):
    return [goal.name.split()[0] for goal in goals if not is_so(goal.holds)]


FEASIBLE = [
    ({}, {}, ""), ({"fd_known": 0}, {}, "I1"), ({"sq_known": 0}, {}, "I1"), ({"hold": 1}, {}, "I1"),
    (LOST, {}, ""), (LOST | {"fd_known": 0, "sq_known": 0, "hold": 9}, {}, ""),
    ({"wait": 1}, {}, "I2"), (LOST | {"wait": 1}, {}, "I2"),
    (LOST | {"wait": 1, "fd_known": 0}, {}, ""),
    ({"soon": 1}, {}, "I3"), ({"dist": [1, 3, INFINITY, INFINITY]}, {}, "I4"),
    ({"sq": [6, 5, 0, 0]}, {}, "I4"), ({"sq": [4, 5, 0, 0]}, {}, ""),
    ({"dist": [2, 2, INFINITY, INFINITY]}, {}, "I4"), ({"sq": [5, 6, 0, 0]}, {}, "I4"),
    ({"dist": [9, 9, INFINITY, INFINITY]}, {}, ""), ({"fd_dist": 2}, {}, "I5"),
    ({"fd_sq": 6}, {}, "I5"), ({"fd_sq": 4}, {}, ""), ({}, {0: (1, 5, 3, 0)}, "I4 I5"),
    ({}, {0: (1, 4, 0, 0)}, "I4 I5"), ({}, {0: (0, 5, 2, 1)}, ""), ({}, {0: (0, 0, 0, 0)}, "I6"),
    ({}, {1: (0, 0, 0, 0)}, "I6"), ({}, {1: (0, 0, 0, 1)}, ""),
    ({"dist": [2, 3, 7, INFINITY]}, {}, "I6"), ({"dist": [2, 3, 7, INFINITY], "pf": [0, 0, ONE, 0]},
                                                {}, ""),
    ({"pf": [ONE, 0, 0, 0]}, {}, "I7"), ({"pf": [ONE - 1, 0, 0, 0]}, {}, ""),
    (LOST | {"pf": [ONE, 0, 0, 0]}, {}, ""),
    ({"dist": [INFINITY, 3, INFINITY, INFINITY]}, {0: (0, 0, 0, 0)}, "I6"),
    # What is heard counts though its port is broken.
    ({"pf": [0, ONE, 0, 0], "dist": [2, 2, INFINITY, INFINITY]}, {}, "I4"),
    ({"pf": [0, ONE, 0, 0], "heard": [1, 0, 0, 0], "dist": [2, 2, INFINITY, INFINITY]}, {}, ""),
]  # fmt: skip


@pytest.mark.parametrize(("cell", "ghosts", "names"), FEASIBLE)
def test_what_breaks_an_invariant_of_feasible(cell, ghosts, names):
    assert broken(invariants(view_of(cell, ghosts))) == names.split()


@pytest.mark.parametrize(("cell", "names"), [
    ({}, ""), ({"soon": 1}, ""), ({"sq_own": 4}, "I3"), ({"sq": [4, 5, 0, 0]}, "I3"),
    ({"fd_dist": 4}, "I3"), ({"fd_sq": 4}, "I3"),
    ({"fd_sq": 4, "dist": [INFINITY - 1, 3, INFINITY, INFINITY]}, ""),
    ({"fd_sq": 4, "dist": [INFINITY, 3, INFINITY, INFINITY]}, ""),
    ({"fd_sq": 4, "dist": [INFINITY - 2, 3, INFINITY, INFINITY]}, "I3"), (LOST | {"sq_own": 9}, ""),
])  # fmt: skip
def test_what_a_cell_with_triggered_updates_would_announce_is_not_nearer(cell, names):
    """What is announced is a hop farther than the parent; as far as can be is no way at all."""
    assert broken(invariants(view_of(cell, updates=TRIGGERED))) == names.split()


STRICT = [
    ({}, {}, ""), ({"sq_known": 0}, {}, "S1"), ({"wait": 1}, {}, "S2"), (LOST | {"wait": 1}, {},
                                                                        "S2"),
    (LOST | {"wait": 1, "sq_known": 0}, {}, ""), ({"sq_own": 6}, {}, "S3 S5"),
    ({"sq_own": 4}, {}, ""), ({"sq": [4, 5, 0, 0]}, {}, "S3"), ({"sq": [6, 5, 0, 0]}, {}, "S4"),
    ({"sq": [4, 5, 0, 0], "dist": [INFINITY, 3, INFINITY, INFINITY]}, {}, ""),
    ({"sq": [5, 6, 0, 0]}, {}, "S4"), ({"sq": [5, 4, 0, 0]}, {}, ""),
    ({}, {0: (1, 4, 2, 0)}, "S4 S5"), ({}, {0: (1, 6, 2, 0)}, ""), ({}, {0: (0, 0, 0, 0)}, "S6"),
    ({}, {1: (0, 0, 0, 0)}, "S6"), ({}, {1: (0, 0, 0, 1)}, ""), ({"pf": [ONE, 0, 0, 0]}, {}, "S7"),
]  # fmt: skip


@pytest.mark.parametrize(("cell", "ghosts", "names"), STRICT)
def test_what_breaks_an_invariant_of_strict(cell, ghosts, names):
    assert broken(strict.invariants(view_of(cell, ghosts))) == names.split()


def test_with_triggered_updates_a_cells_number_is_its_parents():
    for cell, names in (({}, []), ({"sq_own": 4}, ["S8"]), (LOST | {"sq_own": 4}, [])):
        assert broken(strict.invariants(view_of(cell, updates=TRIGGERED))) == names


FAR = HALF16
WINDOWED = [
    ({}, {}, True, True), ({"fd_sq": FAR}, {}, False, True), ({"fd_sq": FAR - 1}, {}, True, True),
    ({"fd_sq": FAR, "fd_known": 0}, {}, True, True), ({"sq_own": FAR}, {}, True, False),
    ({"sq_own": FAR, "sq_known": 0}, {}, True, True), ({"sq": [5, FAR, 0, 0]}, {}, False, False),
    ({"sq": [5, 5, FAR, 0]}, {}, True, True), ({}, {1: (1, FAR, 3, 0)}, False, False),
    ({}, {1: (0, FAR, 3, 1)}, True, True),
]  # fmt: skip


@pytest.mark.parametrize(("cell", "ghosts", "feasibly", "strictly"), WINDOWED)
def test_all_numbers_that_may_be_compared_lie_in_the_window(cell, ghosts, feasibly, strictly):
    view = view_of(cell, ghosts)
    assert (is_so(view.windowed()), is_so(strict.windowed(view))) == (feasibly, strictly)


def test_who_has_a_feasible_distance_has_waited_for_all_that_is_older():
    assert is_so(true_ghosts(view_of()))
    assert is_so(true_ghosts(view_of({}, {3: (0, 0, 0, 1)})))
    assert not is_so(true_ghosts(view_of({}, {3: (1, 5, 9, 1)})))


SAID = [  # what a beacon says on a port, and whether its sender may ever have sent it
    (0, (5, 2), {}, True, True), (0, (5, 9), {}, True, True), (0, (5, 1), {}, False, True),
    (0, (6, 9), {}, False, False), (0, (4, 1), {}, True, False), (1, (4, 1), {}, True, True),
    (2, (5, 9), {}, False, False), (2, (5, INFINITY), {}, True, True),
    (2, (FAR, INFINITY), {}, True, True), (2, (5, 9), {2: (0, 0, 0, 1)}, True, True),
    (2, (FAR, 9), {2: (0, 0, 0, 1)}, False, False),
]  # fmt: skip


@pytest.mark.parametrize(("port", "route", "ghosts", "feasibly", "strictly"), SAID)
def test_what_a_beacon_may_say(port, route, ghosts, feasibly, strictly):
    made = cell_of({}, ghosts, frame={"sq": route[0], "dist": route[1]})
    made.port = made.t.number(port)
    assert is_so(feasible.said_by(made)) == feasibly
    assert is_so(strict.said_by(made)) == strictly


MOVES = [  # (known, number, hops, old) before and after
    ("_rises", (1, 5, 0, 0), (1, 6, 0, 0), True), ("_rises", (1, 5, 0, 0), (1, 5, 0, 0), True),
    ("_rises", (1, 5, 0, 0), (1, 4, 0, 0), False), ("_rises", (1, 5, 0, 0), (0, 6, 0, 0), False),
    ("_rises", (0, 0, 0, 0), (1, 3, 0, 0), True), ("_rises", (0, 0, 0, 0), (1, 3, 0, 1), False),
    ("_rises", (0, 0, 0, 1), (1, 3, 0, 1), False), ("_rises", (0, 0, 0, 1), (1, 3, 0, 0), False),
    ("_rises", (1, 5, 0, 0), (1, 6, 0, 1), False),
    ("forgets", (1, 5, 0, 0), (0, 0, 0, 1), True), ("forgets", (1, 5, 0, 0), (0, 0, 0, 0), False),
    ("forgets", (1, 5, 0, 0), (1, 5, 0, 1), False),
]  # fmt: skip


@pytest.mark.parametrize(("move", "old", "new", "may"), MOVES)
def test_how_a_neighbour_may_move(move, old, new, may):
    view = view_of()
    before, after = (ghost_of(view.t, *one) for one in (old, new))
    assert is_so(getattr(strict, move)(view, before, after, 0)) == may


@pytest.mark.parametrize(("port", "new", "may"), [
    (2, (1, 3, 0, 0), True), (2, (1, 3, 0, 1), False), (2, (0, 3, 0, 0), False),
    (1, (1, 3, 0, 0), False), (0, (1, 3, 0, 0), False),
])  # fmt: skip
def test_who_forgot_has_a_route_again_when_nothing_is_left_of_it(port, new, may):
    view = view_of()
    old, after = ghost_of(view.t, 0, 0, 0, 1), ghost_of(view.t, *new)
    assert is_so(strict.again(view, old, after, port)) == may


def left(cell, actions=()):
    """A step that left SOUND like this, with these actions: (kind, a, values of a frame)."""
    made = cell_of(cell)
    stage, before = made.stage, dict(made.stage.store)
    put(stage, before, made.cell, SOUND)
    after, out = dict(stage.store), []
    for kind, a, values in actions:
        frame, t = Record("sent"), stage.terms
        put(stage, after, frame, values)
        out.append(SimpleNamespace(kind=kind, guard=t.true, a=t.number(a), frame=frame))
    machine = SimpleNamespace(out=SimpleNamespace(actions=out))
    return made, SimpleNamespace(terms=stage.terms, before=before, after=after, machine=machine)


def beacon(sq, dist, parent=0, port=1):
    return SEND, port, {"kind": BEACON, "sq": sq, "dist": dist, "parent": parent}


@pytest.mark.parametrize(("said", "cell", "may"), [
    (beacon(5, 3), {}, True), (beacon(5, 4), {}, True), (beacon(4, 1), {}, True),
    (beacon(5, 2), {}, False), (beacon(6, 9), {}, False), (beacon(5, INFINITY), {}, True),
    (beacon(5, 3), {"fd_known": 0}, False), (beacon(4, 0), {}, False),
    (beacon(FAR, 9), {"fd_sq": FAR}, False),
])  # fmt: skip
def test_no_beacon_is_nearer_than_its_senders_feasible_distance(said, cell, may):
    made, step = left(cell, [said])
    assert [is_so(one) for one in feasible._beacons(made.view(step.after), step)] == [may]


@pytest.mark.parametrize(("port", "parent", "may"), [(0, 1, True), (1, 0, True), (0, 0, False),
                                                     (1, 1, False)])  # fmt: skip
def test_the_parent_alone_is_told_that_it_is(port, parent, may):
    made, step = left({}, [beacon(5, 3, parent, port)])
    assert [is_so(one) for one in feasible._told(made.view(step.after), step)] == [may]


def test_forgetting_is_what_is_reported_so():
    for actions, forgot in (([], False), ([(REPORT, REPORT_FORGET, {})], True),
                            ([(REPORT, REPORT_FORGET + 1, {})], False),
                            ([(SEND, REPORT_FORGET, {})], False)):  # fmt: skip
        assert is_so(feasible.forgotten(left({}, actions)[1])) == forgot


KEPT = [  # after a step from SOUND: what is broken of it
    ({}, False, ""), ({"fd_dist": 2}, False, ""), ({"fd_sq": 6}, False, ""),
    ({"fd_dist": 4}, False, "F"), ({"fd_sq": 4}, False, "F"), ({"fd_known": 0}, False, "F"),
    ({"fd_known": 0}, True, "F1"), ({"fd_dist": 4}, True, "F1"),
    ({"parent": 1, "dist": [2, 2, INFINITY, INFINITY]}, False, ""),
    ({"parent": 1}, False, "R1"), ({"parent": 1, "sq": [5, 6, 0, 0]}, False, ""),
    ({"parent": 1, "sq": [5, 6, 0, 0], "child": [0, 1, 0, 0]}, False, "R2"),
    ({"parent": 1, "sq": [5, 6, 0, 0], "dist": [2, 64, 0, 0]}, False, "R2"),
    ({"parent": 1, "sq": [5, 6, 0, 0], "dist": [2, 63, 0, 0]}, False, ""),
    ({"wait": 1}, False, "R3"), (LOST | {"wait": 1}, False, ""), (LOST, False, ""),
]  # fmt: skip


@pytest.mark.parametrize(("cell", "forgot", "names"), KEPT)
def test_what_a_step_does_to_the_feasible_distance_and_the_route(cell, forgot, names):
    made, step = left(cell, [(REPORT, REPORT_FORGET, {})] * forgot)
    assert broken(feasible._kept(made, step)) == names.split()


@pytest.mark.parametrize(("before", "after", "may"), [(5, 5, True), (5, 6, True), (5, 4, False),
                                                      (5, 5 + HALF16 - 1, True),
                                                      (5, 5 + HALF16, False), (MASK16, 0, True),
                                                      (0, MASK16, False)])  # fmt: skip
def test_the_pcs_number_rises_by_less_than_half_of_all(before, after, may):
    t = Stage({}, fields.FRAME, ROOM).terms
    step = SimpleNamespace(terms=t, before={("own", "sq", None): t.number(before)},
                           after={("own", "sq", None): t.number(after)})  # fmt: skip
    assert is_so(pc._rises(step, "own")) == may
