"""Runs with a dead port answer what is asked about it, and draw the same number alike."""

import ast
from types import SimpleNamespace

import pytest

from innervate.networks.skin.protocol.constants import RULE_FEASIBLE
from innervate.networks.skin.prove import reductions
from innervate.networks.skin.prove.forgetting import Asked
from innervate.prove.execute import Machine
from innervate.prove.records import Array, Record, State
from innervate.prove.terms import Terms

SOURCE = """
def is_usable(cell, params, port):
    return params > port

def is_parent(cell, params, port):
    return params > port
"""


def asked(terms, port=0):
    return Asked({}, terms, "is_usable", port, "on_timer 1")


def function(name):
    nodes = {node.name: node for node in ast.parse(SOURCE).body}
    return SimpleNamespace(name=name, node=nodes[name], module="m", path="m.py", constants={},
                           calls={})  # fmt: skip


def test_a_draw_is_less_than_what_it_is_of_where_it_is_made_at_all():
    terms = Terms()
    made, many = asked(terms), terms.unknown("many", -3, 4)
    state = State({}, {}, terms.true, SimpleNamespace(under=terms.true))
    drawn = made.draw(many, state)
    assert (drawn.low, drawn.high) == (0, 3)
    assert made.draws == [(drawn, many, terms.at_most(terms.number(1), many))]
    assert made.facts == [
        terms.implies(terms.at_most(terms.number(1), many), terms.less(drawn, many))
    ]
    assert asked(terms).draw(many, state) is drawn  # of the other run
    assert made.draw(many, state) is not drawn


@pytest.mark.parametrize(("name", "port", "is_answered"), [
    ("is_usable", 1, True), ("is_usable", 2, False), ("is_parent", 1, False),
])  # fmt: skip
def test_of_the_dead_port_alone_the_question_is_answered_with_no(name, port, is_answered):
    terms = Terms()
    made, params = asked(terms, port=1), terms.unknown("params", 0, 3)
    under = terms.as_truth(terms.unknown("under", 0, 1))
    given = [terms.number(1), params, terms.number(port)]
    _, value = made.call(function(name), given, {}, under)
    asks = terms.less(terms.number(port), params)
    assert value is (terms.false if is_answered else asks)
    assert [(one.guard, one.holds, one.where) for one in made.demands] == (
        [(under, terms.negated(asks), "is_usable")] if is_answered else []
    )


@pytest.mark.parametrize(("dead", "low", "others"), [
    (0, -1, (1, 2, 3)), (0, 0, (1, 2, 3)), (0, 2, (2, 3)), (1, -1, (0, 2, 3)), (1, 1, (2, 3)),
])  # fmt: skip
def test_what_some_port_says_is_what_another_than_the_dead_one_says(dead, low, others):
    terms = Terms()
    made, index = asked(terms, dead), terms.unknown("index", low, 3)
    cell = Record("cell", ())
    said = {(cell, "dist", k): terms.unknown(f"dist {k}", 0, 9) for k in range(4)}
    path, under = (terms.as_truth(terms.unknown(name, 0, 1)) for name in ("path", "under"))
    state = State({}, said, path, SimpleNamespace(under=under))
    found = made.element(Array(cell, "dist", 4), index, None, state)
    expected = said[cell, "dist", others[0]]
    for k in others:
        here = terms.same(index, terms.number(k))
        expected = terms.pick(here, said[cell, "dist", k], expected)
    assert found is expected
    (demand,) = made.demands
    assert demand.guard is terms.all(under, path)
    assert demand.holds is terms.negated(terms.same(index, terms.number(dead)))
    assert demand.where == "is_usable"


@pytest.mark.parametrize(("name", "low", "high"), [("dist", 2, 2), ("pf", 0, 3)])
def test_a_known_index_or_what_no_port_says_is_looked_up_as_ever(name, low, high):
    terms = Terms()
    made, index = asked(terms), terms.unknown("index", low, high)
    cell = Record("cell", ((name, 4, 0, 9, "x", ""),))
    said = {(cell, name, k): terms.unknown(f"{name} {k}", 0, 9) for k in range(4)}
    called = SimpleNamespace(under=terms.true, function=function("is_usable"))
    state, node = State({}, said, terms.true, called), called.function.node
    found = made.element(Array(cell, name, 4), index, node, state)
    plain = Machine({}, terms, made.out).element(Array(cell, name, 4), index, node, state)
    assert found is plain
    assert all(one.what != "a dead port is not looked at" for one in made.demands)


def test_loads_decide_nothing_when_a_cell_hears_nor_when_its_period_ends():
    assert [made().name for made in reductions.steps(RULE_FEASIBLE)] == [
        "a beacon between ticks, periodic", "the timer for news that are none",
        "a beacon with other loads", "a period with other loads",
    ]  # fmt: skip
