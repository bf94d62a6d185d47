"""References and states of paths that come together."""

import pytest

from innervate.prove.records import Either, Partly, Record, State, each_of, either, merged, name_of
from innervate.prove.terms import Terms

CALL = object()  # that states are of


@pytest.fixture
def terms():
    return Terms()


def truth(terms, name):
    return terms.as_truth(terms.unknown(name, 0, 1))


def test_what_a_reference_stands_for_and_where(terms):
    p, q, under = (truth(terms, name) for name in ("p", "q", "under"))
    found = list(each_of(terms, Either(p, "a", Either(q, "b", "c")), under))
    no = terms.negated
    assert found == [(terms.all(under, p), "a"), (terms.all(under, no(p), q), "b"),
                     (terms.all(under, no(p), no(q)), "c")]  # fmt: skip
    assert list(each_of(terms, "a", under)) == [(under, "a")]


def test_one_of_two_where_a_truth_holds(terms):
    p, x, y = truth(terms, "p"), terms.unknown("x", 0, 9), terms.unknown("y", 0, 9)
    assert either(terms, p, x, y) is terms.pick(p, x, y)
    assert either(terms, p, None, None) is None
    assert either(terms, p, None, "b") == Partly(terms.negated(p), "b")  # no value there
    assert either(terms, p, "a", None) == Partly(p, "a")
    assert either(terms, p, "a", "a") == "a"
    assert either(terms, p, "a", "b") == Either(p, "a", "b")


def test_what_has_a_value_on_some_paths_has_it_where_one_of_them_goes(terms):
    p, q = truth(terms, "p"), truth(terms, "q")
    partly = either(terms, p, "a", None)
    assert either(terms, q, partly, "b") == Partly(
        terms.any(terms.negated(q), p), Either(q, "a", "b")
    )
    assert either(terms, p, partly, "b") == Either(p, "a", "b")
    assert either(terms, terms.negated(p), None, partly) == partly
    assert either(terms, q, None, partly) == Partly(terms.all(terms.negated(q), p), "a")


def test_states_that_come_together_have_what_either_has(terms):
    p, x, y = truth(terms, "p"), terms.unknown("x", 0, 9), terms.unknown("y", 0, 9)
    one = State({"i": x, "mine": x}, {"both": x, "same": x, "mine": x}, p, CALL)
    other = State({"i": y, "its": y}, {"both": y, "same": x, "its": y}, terms.negated(p), CALL)
    found = merged(terms, p, one, other, terms.true)
    assert (found.path, found.call) == (terms.true, CALL)
    partly = {"mine": Partly(p, x), "its": Partly(terms.negated(p), y)}
    assert found.names == {"i": terms.pick(p, x, y), **partly}
    assert found.store == {"both": terms.pick(p, x, y), "same": x, "mine": x, "its": y}


def test_a_fork_goes_on_by_itself(terms):
    state = State({"i": 1}, {"a": 2}, terms.true, CALL)
    fork = state.fork(terms.false)
    fork.names["i"], fork.store["a"] = 3, 4
    assert (state.names, state.store, state.path) == ({"i": 1}, {"a": 2}, terms.true)
    assert (fork.path, fork.call) == (terms.false, CALL)


def test_places_have_names():
    cell = Record("cell")
    assert name_of((cell, "dist", 2)) == "cell.dist[2]"
    assert name_of((cell, "parent", None)) == "cell.parent"
