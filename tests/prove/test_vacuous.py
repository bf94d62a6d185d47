"""A proof of nothing is an error, of every kind of lemma."""

from dataclasses import replace
from functools import cache

import pytest

from innervate.network import networks
from innervate.networks.skin.protocol.constants import RULE_FEASIBLE, RULE_STRICT
from innervate.networks.skin.prove.neighbours import ANY_RULE
from innervate.networks.skin.prove.theories import resting
from innervate.prove.errors import ProveError
from innervate.prove.theory import prove, source

LEMMAS = ("mesh, delivery", "mesh, passing on", "mesh, hops", "radio, the queue of a station",
          "radio, turns", "what is only stored, news, loads", "what dead ports said",
          "what is not read", "ports are alike", "what the rule refuses",
          "beacons that repeat the last", "what the rule does not read")  # fmt: skip


@cache
def theories():
    nets = [networks()[name] for name in ("mesh", "radio")]
    found = [one for net in nets for one in net.prove.theories(net)]
    return {one.name: one for one in (*found, *resting(ANY_RULE), *resting(RULE_FEASIBLE))}


def assuming(theory, more):
    """The same theory, its first step alone, which also assumes something."""

    def step():
        made = theory.steps[0]()
        made.facts = [*made.facts, *more(made.terms)]
        return made

    return replace(theory, steps=(step,))


def contradiction(terms):
    return [terms.same(terms.unknown("anything", 0, 9), terms.number(k)) for k in (1, 2)]


@pytest.mark.parametrize("name", LEMMAS)
def test_what_contradicts_itself_proves_nothing(name):
    with pytest.raises(ProveError, match="no state is as assumed, so all would hold"):
        prove(assuming(theories()[name], contradiction), first_only=True)


def test_an_assumption_that_closes_a_branch_is_told():
    """A cache that knows no packet of this origin never has the one that comes."""

    def unknown_origin(terms):
        origins = [terms.unknown(f"node.done_origin[{k}]", 0, 255) for k in range(64)]
        mine = terms.unknown("frame.origin", 0, 255)
        return [terms.negated(terms.same(one, mine)) for one in origins]

    theory = theories()["mesh, passing on"]
    whole, part = (prove(assuming(theory, more)) for more in (lambda _: [], unknown_origin))
    assert whole.unreached == []
    assert "record_packet" in {way[0] for way in part.unreached}
    assert not part.is_as_expected


@pytest.mark.slow
@pytest.mark.parametrize("rule", [ANY_RULE, RULE_FEASIBLE, RULE_STRICT])
def test_no_branch_is_left_out_of_what_reductions_rest_on(rule):
    for theory in resting(rule):
        outcome = prove(theory)
        assert not outcome.is_refuted
        assert outcome.unreached == [], theory.name


def test_steps_that_a_mistake_does_not_touch_are_left_out():
    theory = resting(RULE_FEASIBLE, ("cell.hold = cell.hold + 1", "cell.hold = cell.hold + 2"))[0]
    tried = prove(theory, first_only=True)
    assert [one.name for one in tried.checked] == ["a cell's period ends"]
    assert tried.is_refuted
    shipped = resting(RULE_FEASIBLE)[0]
    start = replace(shipped, steps=shipped.steps[:1])
    assert len(prove(start, first_only=True).checked) == 1


def test_who_is_changed_and_who_was_asked_is_known():
    entry = "innervate.networks.skin.protocol.cell"
    known = source(entry, ("cell.hold = cell.hold + 1", "cell.hold = cell.hold + 2"))
    assert known.changed == {"hold_feasible"}
    assert known.get("nobody") is None
    assert known["adopt"].name == "adopt"
    assert known.asked == {"nobody", "adopt"}
    assert source(entry, None).changed == frozenset()
