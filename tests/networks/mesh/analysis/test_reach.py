"""Whom nodes would hand a packet for the gateway, and which links carry, from hand-made tables."""

from types import SimpleNamespace

import numpy as np
import pytest

from innervate.analysis.ways import NOWHERE
from innervate.networks.mesh.analysis import reach
from innervate.networks.mesh.protocol.constants import (
    ALTERNATE,
    LIST,
    SEARCH,
    TABLE_FREE,
    TABLES,
)  # fmt: skip
from innervate.networks.mesh.scenario.plan import ONE
from innervate.sim.field.states import ALIVE, DEAD

FREE = 255
COUNT, WIDTH = 5, 5
PARAMS = {
    "min_rssi": -85, "faint": -84, "mode": TABLES, "width": WIDTH, "failover": ALTERNATE,
    "discovery": LIST, "transmissions": 1, "e2e_tries": 0, "reliable": 1, "hop_acks": 0,
}  # fmt: skip
STRONG, WEAK = 4 * -85, 4 * -85 - 1  # the neighbours' table has quarters of a dBm


def node(**fields):
    """A node that knows nobody; of three neighbours it can have."""
    nothing = {
        "known": 1, "gateway": 0, "depth": 2, "parent": FREE, "bank": 0, "leading": 0,
        "neighbour": [FREE] * 3, "suspect": [0] * 3, "rssi": [-200] * 3,
        "round_depth": [FREE] * 3, "round_rssi": [-50] * 3,
        "next": [FREE] * 2 * WIDTH, "alt": [FREE] * 2 * WIDTH,
    }  # fmt: skip
    return SimpleNamespace(**nothing | fields)


def plan_of(count=COUNT, collisions=True, **params):
    return SimpleNamespace(
        nodes=count, params=PARAMS | params, radio=SimpleNamespace(collisions=collisions)
    )


def choices(one, number=4, **params):
    """What node `number` would do; the others know nothing. (named, neighbours, goes back)."""
    nodes = [node(gateway=FREE, known=0) for _ in range(COUNT)]
    nodes[number] = one
    found = reach.choices(SimpleNamespace(nodes=nodes), plan_of(**params))
    assert [found.gateway[i] for i in range(COUNT) if i != number] == [NOWHERE] * (COUNT - 1)
    assert found.gateway[number] == (one.gateway if one.known and one.gateway < COUNT else NOWHERE)
    named = [int(to) for to in found.named[number] if to != NOWHERE]
    assert found.named[number].tolist()[: len(named)] == named  # no gaps
    return named, np.flatnonzero(found.neighbours[number]).tolist(), found.goes_back


def table(**entries):
    """A table of next hops: to node 0 by bank: first=..., second=..."""
    made = [FREE] * 2 * WIDTH
    made[0], made[WIDTH] = entries.get("first", FREE), entries.get("second", FREE)
    return made


@pytest.mark.parametrize(("rssi", "named"), [(-200, [0]), (STRONG, [0]), (WEAK, [])])
def test_a_gateway_that_is_heard_well_is_the_first_choice(rssi, named):
    assert choices(node(neighbour=[1, 0, 2], rssi=[-100, rssi, -100]))[0] == named
    # How well others are heard does not matter.
    assert choices(node(neighbour=[1, 0, 2], rssi=[WEAK, -100, WEAK]))[0] == [0]


@pytest.mark.parametrize(("suspect", "named"), [(0, [0]), (1, []), (2, [0]), (3, [])])
def test_who_does_not_answer_is_passed_by(suspect, named):
    one = node(neighbour=[0, 1, FREE], suspect=[suspect, 0, 0])
    assert choices(one)[0] == named
    assert choices(node(neighbour=[1, FREE, FREE], suspect=[suspect & 1, 0, 0],
                        next=table(first=1)))[0] == [1] * (suspect & 1 == 0)  # fmt: skip


@pytest.mark.parametrize(("bank", "named"), [(0, [1, 2]), (1, [3, 1])])
def test_then_come_next_hop_and_alternate_of_the_table_in_force(bank, named):
    one = node(bank=bank, next=table(first=1, second=3), alt=table(first=2, second=1))
    assert choices(one)[0] == named
    assert choices(one, failover=SEARCH)[0] == named
    assert choices(one, failover=ALTERNATE - 1)[0] == named[:1]
    assert choices(one, mode=TABLE_FREE)[0] == []
    assert choices(one, mode=TABLE_FREE - 1)[0] == []


@pytest.mark.parametrize(("failover", "mode", "takes"), [
    (ALTERNATE - 1, TABLES, [1, 2]), (ALTERNATE, TABLES, []), (SEARCH, TABLES, [1, 2]),
    (ALTERNATE - 1, TABLE_FREE, []), (SEARCH, TABLE_FREE, []),
])  # fmt: skip
def test_anybody_takes_the_place_of_a_next_hop_with_the_documents_failover_and_with_search(
    failover, mode, takes
):
    one = node(neighbour=[1, 2, FREE])
    assert choices(one, failover=failover, mode=mode)[1] == takes


@pytest.mark.parametrize("entry", [FREE, 4, COUNT, 9])
def test_a_table_that_names_nobody_or_oneself_names_nobody(entry):
    assert choices(node(next=table(first=entry), alt=table(first=2)))[0] == [2]


@pytest.mark.parametrize("gateway", [0, 1, WIDTH - 1, WIDTH, COUNT + 40])
def test_the_table_is_looked_at_where_the_gateway_stands(gateway):
    entries = [3, 2, FREE, 1, FREE] * 2
    one = node(gateway=gateway, next=entries)
    named = choices(one, number=2 if gateway == 4 else 4)[0]
    assert named == {0: [3], 1: [2]}.get(gateway, [])


def test_who_follows_no_gateway_names_nobody_but_who_is_nearer():
    one = node(known=0, next=table(first=1), neighbour=[0, 3, FREE], round_depth=[FREE, 1, FREE])
    assert choices(one)[0] == [3]


UPLINKS = {
    "neighbour": [1, 2, 3], "round_depth": [1, 0, 1], "round_rssi": [-60, -70, -50],
}  # fmt: skip


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({}, [2, 3, 1]),  # by depth, then by strength
        ({"round_rssi": [-60, -85, -50]}, [2, 3, 1]),
        ({"round_rssi": [-60, -86, -50]}, [3, 1, 2]),  # too weak: behind all others
        ({"round_rssi": [-90, -87, -86]}, [2, 3, 1]),
        ({"round_depth": [1, 0, 2]}, [2, 1]),  # no nearer than we are
        ({"depth": 1}, [2]),
        ({"round_depth": [1, FREE, 1], "depth": FREE}, [3, 1]),  # not heard in this round
        ({"neighbour": [1, FREE, 3]}, [3, 1]),
        ({"suspect": [0, 1, 2]}, [3, 1]),
        ({"parent": 1}, [2, 3, 1]),
    ],
)
def test_last_come_neighbours_that_are_nearer_the_best_first(change, named):
    assert choices(node(**UPLINKS | change))[0] == named
    ahead = node(**UPLINKS | change | {"next": table(first=4), "alt": table(first=0)})
    assert choices(ahead)[0] == [0, *named]


@pytest.mark.parametrize(
    ("parent", "named"), [(1, [1, 2, 3]), (3, [3, 2, 1]), (FREE, [2, 3, 1]), (0, [2, 3, 1])]
)
def test_but_where_the_first_is_followed_the_parent_is_ahead_of_them(parent, named):
    one = node(parent=parent, **UPLINKS)
    assert choices(one, faint=-85)[0] == named
    deep = node(parent=parent, **UPLINKS | {"depth": 1})
    assert choices(deep, faint=-85)[0] == [2]  # a parent no nearer is none


@pytest.mark.parametrize(
    ("params", "others", "goes_back"),
    [
        ({"failover": SEARCH}, True, True),
        ({"failover": ALTERNATE}, False, False),
        ({"failover": ALTERNATE - 1}, True, False),
        ({"failover": SEARCH, "mode": TABLES + 1}, True, True),
        ({"failover": ALTERNATE - 1, "mode": TABLES + 1}, False, False),
        ({"failover": SEARCH, "mode": TABLE_FREE}, False, False),
        ({"failover": ALTERNATE - 1, "mode": TABLE_FREE}, False, False),
    ],
)
def test_who_tries_every_neighbour_and_who_gives_packets_back(params, others, goes_back):
    one = node(neighbour=[3, FREE, 1])
    assert choices(one, **params)[1:] == ([1, 3] if others else [], goes_back)


def carried(links, noise=(0, 0, 0), power=1000, collisions=True, capture=16_306, **params):
    """Pairs of three nodes whose link carries; links are {(sender, receiver): chance}."""
    prob, cut = [0] * 9, [0] * 9
    for (a, b), chance in links.items():
        prob[3 * a + b], cut[3 * a + b] = round(abs(chance) * ONE), int(chance < 0)
    world = SimpleNamespace(
        prob=prob, cut=cut, power=[power] * 9, run=[SimpleNamespace(capture=capture)],
        radios=[SimpleNamespace(noise=level) for level in noise],
    )  # fmt: skip
    found = reach.carries(world, plan_of(3, collisions, **params))
    return {(int(a), int(b)) for a, b in zip(*np.nonzero(found), strict=True)}


@pytest.mark.parametrize(
    ("chance", "params", "does"),
    [
        (0.5, {}, True), (0.4999, {}, False), (1.0, {}, True), (0.0, {}, False),
        (0.2, {"transmissions": 3}, False), (0.21, {"transmissions": 3}, True),  # 0.794 ** 3
        (0.11, {"transmissions": 2, "e2e_tries": 2}, True),  # 0.891 ** 6
        (0.10, {"transmissions": 2, "e2e_tries": 2}, False),
        (0.29, {"transmissions": 2, "e2e_tries": 2, "reliable": 0}, False),  # 0.707 ** 2
        (0.30, {"transmissions": 2, "e2e_tries": 2, "reliable": 0}, True),
    ],
)  # fmt: skip
def test_a_link_carries_what_comes_through_in_every_second_case(chance, params, does):
    assert carried({(0, 1): chance}, **params) == ({(0, 1)} if does else set())
    # Where hops are acknowledged both ways count: the chance is that of both.
    acked = {(0, 1): chance, (1, 0): 1.0, (1, 2): 1.0}
    both = {(0, 1), (1, 0)} if does else set()
    assert carried(acked, hop_acks=1, **params) == both


def test_a_cut_link_carries_nothing_that_way():
    links = {(0, 1): -1.0, (1, 0): 1.0}
    assert carried(links) == {(1, 0)}
    assert carried(links, hop_acks=1) == set()


# 6 dB are a ratio of 3.98: a signal of 1000 survives 251.
@pytest.mark.parametrize(("noise", "pairs"), [(251, {(0, 1), (1, 0)}), (252, {(0, 1)})])
def test_a_signal_is_heard_above_the_noise_of_its_receiver(noise, pairs):
    links = {(0, 1): 1.0, (1, 0): 1.0}
    assert carried(links, (noise, 0, 0)) == pairs
    assert carried(links, (noise, 0, 0), collisions=False) == {(0, 1), (1, 0)}


def test_nobody_hears_itself():
    assert carried({(0, 0): 1.0, (1, 1): 1.0}) == set()


def test_who_is_on_and_leads_is_as_the_simulation_has_it():
    nodes = [node(leading=1), node(leading=1, gateway=1), node(leading=1), node(), node()]
    for one in (nodes[3], nodes[4]):
        one.neighbour = [0, 1, FREE]
    states = [ALIVE, DEAD, 0, ALIVE, DEAD]
    world = SimpleNamespace(
        nodes=nodes, radios=[SimpleNamespace(state=state, noise=0) for state in states],
        prob=[ONE] * 25, cut=[0] * 25, power=[1] * 25, run=[SimpleNamespace(capture=4096)],
    )  # fmt: skip
    found = reach.of_simulation(world, plan_of())
    assert found.on.tolist() == [True, False, False, True, False]
    assert found.off.tolist() == [False, True, False, False, True]
    assert found.leads.tolist() == [True, False, False, False, False]
    assert found.hop.tolist() == [NOWHERE, NOWHERE, NOWHERE, 0, NOWHERE]
    assert not found.without.any()
