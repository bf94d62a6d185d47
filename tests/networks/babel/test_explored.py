"""Babel in every order of events, and in long random ones; wrong Babels, which are found out."""

import random

import pytest

import innervate
from innervate.dialect.copies import changed_copy
from innervate.folders import invariants_of
from innervate.network import networks
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


def wander(cables, seed, protocol=node, restart=0):
    """What a random walk of events breaks; "" if nothing."""
    made, draw = net(cables, protocol), random.Random(seed)
    state = made.begin(Budget(loss=30, restart=restart, input=0)).state
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


# A mistake, and what it breaks.
LESS = "seq == node.fd_seq and metric < node.fd_metric"
MISTAKES = {
    "any route is feasible": (LESS, "seq == node.fd_seq", "feasib"),
    "a route is kept when its link is down": (
        "if node.known[p] == 0 or node.metric[p] == INFINITY or node.cost[p] == INFINITY:\n"
        "        return INFINITY\n    return min(node.metric[p] + node.cost[p], INFINITY)",
        "if node.known[p] == 0:\n"
        "        return INFINITY\n    return min(node.metric[p] + 1, INFINITY)",
        "without a link",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_found(name):
    old, new, broken = MISTAKES[name]
    (wrong,) = changed_copy([(old, new)], "innervate.networks.babel.protocol.node")
    found = (wander(DIAMOND, seed, wrong) for seed in range(60))
    assert broken in next(filter(None, found))
