"""Runs with a dead port answer what is asked about it, and draw the same number alike."""

from types import SimpleNamespace

import pytest

from innervate.networks.skin.prove.forgetting import Asked
from innervate.prove.records import Array, Record, State
from innervate.prove.terms import Terms


def asked(terms):
    return Asked({}, terms, "is_usable", 0, "on_timer 1")


def test_a_draw_is_less_than_what_it_is_of_where_it_is_made_at_all():
    terms = Terms()
    made, many = asked(terms), terms.unknown("many", -3, 4)
    called, state = SimpleNamespace(under=terms.true), State({}, {}, terms.true)
    drawn = made.draw(many, state, called)
    assert (drawn.low, drawn.high) == (0, 3)
    assert made.draws == [(drawn, many, terms.at_most(terms.number(1), many))]
    assert made.facts == [
        terms.implies(terms.at_most(terms.number(1), many), terms.less(drawn, many))
    ]
    assert asked(terms).draw(many, state, called) is drawn  # of the other run
    assert made.draw(many, state, called) is not drawn


@pytest.mark.parametrize(("low", "others"), [(-1, (1, 2, 3)), (0, (1, 2, 3)), (2, (2, 3))])
def test_what_some_port_says_is_what_another_than_the_dead_one_says(low, others):
    terms = Terms()
    made, index = asked(terms), terms.unknown("index", low, 3)
    cell = Record("cell", ())
    said = {(cell, "dist", k): terms.unknown(f"dist {k}", 0, 9) for k in range(4)}
    path, under = (terms.as_truth(terms.unknown(name, 0, 1)) for name in ("path", "under"))
    state, called = State({}, said, path), SimpleNamespace(under=under)
    found = made.element(Array(cell, "dist", 4), index, None, state, called)
    expected = said[cell, "dist", others[0]]
    for k in others:
        here = terms.same(index, terms.number(k))
        expected = terms.pick(here, said[cell, "dist", k], expected)
    assert found is expected
    (demand,) = made.demands
    assert demand.guard is terms.all(under, path)
    assert demand.holds is terms.negated(terms.same(index, terms.number(0)))
    assert demand.where == "is_usable"
