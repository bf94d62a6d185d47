"""Babel in every order of events, and in long random ones; wrong Babels, which are found out."""

import random

import pytest

import innervate
from innervate.dialect.copies import changed_copy
from innervate.folders import invariants_of
from innervate.network import networks
from innervate.networks.babel import invariants
from innervate.networks.babel.protocol import fields, node
from innervate.topology import free_graph
from innervate.verify.declared import Budget, Net

TRIANGLE = "n0-n1 n1-n2 n2-n0"
DIAMOND = "n0-n1 n1-n2 n2-n3 n3-n0 n1-n3"
EVENTS = 150
IN_FLIGHT = 4


def net(cables, protocol=node):
    """Nodes and cables, with what must hold of them."""
    made = Net(protocol, fields, free_graph([pair.split("-") for pair in cables.split()]),
               {**fields.DEFAULTS, **fields.EXPLORED})  # fmt: skip
    made.own = invariants_of(networks()["babel"], "node_")
    made.of_all = invariants_of(networks()["babel"], "network_")
    return made


def wander(cables, seed, protocol=node, all_looked_at=True):
    """What a random walk of events breaks; "" if nothing. Without all only loops are looked at."""
    made, draw = net(cables, protocol), random.Random(seed)
    if not all_looked_at:
        made.own, made.of_all = {}, {"a loop": invariants.network_has_no_loop}
    state = made.begin(Budget(loss=30, restart=0, input=0)).state
    for _ in range(EVENTS):
        steps = list(made.steps(state))
        some = [step for step in steps if max(map(len, step.state.ways)) <= IN_FLIGHT]
        step = draw.choice(some or steps)
        broken = step.broken or made.broken_of_all(step.state)
        if broken:
            return broken
        state = step.state
    return ""


@pytest.mark.parametrize("graph", ["pair", "ring"])
def test_nothing_breaks_in_whatever_order_things_happen(graph):
    (case,) = innervate.explore("babel", graph=graph, budget="loss=1,restart=0", states=800)
    assert not case.is_broken, case.lines


@pytest.mark.slow
@pytest.mark.parametrize("graph", ["pair", "line", "ring"])
def test_nothing_breaks_in_many_orders(graph):
    (case,) = innervate.explore("babel", graph=graph, budget="loss=2,restart=1", states=20_000)
    assert not case.is_broken, case.lines


@pytest.mark.parametrize(("cables", "seed"), [(TRIANGLE, 1), (DIAMOND, 1), (DIAMOND, 2)])
def test_nothing_breaks_on_a_long_way(cables, seed):
    assert wander(cables, seed) == ""


@pytest.mark.slow
def test_nothing_breaks_on_many_long_ways():
    found = {wander(cables, seed) for cables in (TRIANGLE, DIAMOND) for seed in range(100)}
    assert found == {""}


# Mistakes: what stands there, and instead of it.
ANY_IS_FEASIBLE = ("seq == node.fd_seq and metric < node.fd_metric", "seq == node.fd_seq")
LINKS_DO_NOT_MATTER = (
    "if node.known[p] == 0 or node.metric[p] == INFINITY or node.cost[p] == INFINITY:\n"
    "        return INFINITY\n    return min(node.metric[p] + node.cost[p], INFINITY)",
    "if node.known[p] == 0:\n        return INFINITY\n    return min(node.metric[p] + 1, INFINITY)",
)


def wrong(mistake):
    """A copy of the protocol with a mistake."""
    return changed_copy([mistake], "innervate.networks.babel.protocol.node")[0]


@pytest.mark.parametrize("mistake", [ANY_IS_FEASIBLE, LINKS_DO_NOT_MATTER])
def test_a_mistake_is_found(mistake):
    protocol = wrong(mistake)
    found = next(filter(None, (wander(TRIANGLE, seed, protocol) for seed in range(10))))
    assert found == "A route is selected that is retracted, without a link, or not feasible"


def test_a_route_that_is_not_feasible_closes_a_loop():
    assert wander(DIAMOND, 1, wrong(ANY_IS_FEASIBLE), all_looked_at=False) == "a loop"
