"""Who reaches a gateway: on random networks, packet by packet as one would on paper."""

import random

import numpy as np
import pytest

from innervate.analysis.ways import NOWHERE
from innervate.networks.mesh.analysis.reach import Choices, ways
from innervate.networks.mesh.protocol.constants import PATH_MAX

COUNT = 7
FAR = 99


def network(draw, goes_back):
    """(what nodes know, whether links carry, who is on, who is off, who leads)."""
    nodes = range(COUNT)
    gateway = [draw.choice([NOWHERE, 0, 0, 1]) for _ in nodes]
    named = [[draw.choice([NOWHERE, *nodes]) for _ in range(3)] for _ in nodes]
    near = [[i != j and draw.random() < 0.3 for j in nodes] for i in nodes]
    known = Choices(np.array(gateway), np.array(named), np.array(near), goes_back)
    carries = np.array([[i != j and draw.random() < 0.5 for j in nodes] for i in nodes])
    on = np.array([draw.random() < 0.8 for _ in nodes])
    leads = np.array([node < 2 and draw.random() < 0.7 for node in nodes])
    return known, carries, on, ~on, leads


def first_choices(known, live, leads, node):
    """(where the chain of first choices that carry leads to, how far, by whom): or NOWHERE."""
    path = [node]
    while not leads[path[-1]]:
        fits = handed(known, live, path[-1], others=False)
        if not fits or len(path) > COUNT + 1:
            return NOWHERE, NOWHERE, NOWHERE
        path.append(fits[0])
    return path[-1], len(path) - 1, (*path, NOWHERE)[1]


def handed(known, live, node, others=True):
    """Everybody whom a node can hand a packet to, in order."""
    order = known.named[node].tolist()
    if others:
        order += np.flatnonzero(known.neighbours[node]).tolist()
    return [to for to in order if to != NOWHERE and live(node, to)]


def search(known, live, node, gateway):
    """Hops to the gateway of a packet that is given back where it gets stuck; FAR = too many."""
    met, edge = {node}, [node]
    for hops in range(PATH_MAX + 1):
        if gateway in met:
            return hops
        edge = [to for one in edge for to in handed(known, live, one) if to not in met]
        met |= set(edge)
    return FAR


def searched(known, live, node):
    """To whom such a packet goes that arrives: who is a hop nearer; else NOWHERE."""
    gateway = known.gateway[node]
    hops = search(known, live, node, gateway)
    nearer = [to for to in sorted(handed(known, live, node))
              if search(known, live, to, gateway) == hops - 1]  # fmt: skip
    return NOWHERE if hops == FAR else nearer[0]


def walked(known, live, node):
    """To whom one goes that arrives, and goes on to whom it has not met; else NOWHERE."""
    path = [node]
    while path[-1] != known.gateway[node]:
        onward = [to for to in handed(known, live, path[-1]) if to not in path]
        if not onward:
            return NOWHERE
        path.append(onward[0])
    return path[1]


def expected(known, carries, on, off, leads):
    def live(a, b):
        return bool(carries[a, b] and on[a] and on[b])

    leading = [node for node in range(COUNT) if leads[node] and on[node]]
    both, edge = set(leading), list(leading)
    while edge:
        edge = list({b for a in edge for b in range(COUNT)
                     if live(a, b) and live(b, a) and b not in both})  # fmt: skip
        both |= set(edge)
    rows = []
    for node in range(COUNT):
        gateway, leader = known.gateway[node], node in leading
        root, depth, by = first_choices(known, live, [n in leading for n in range(COUNT)], node)
        there = leader or root == gateway != NOWHERE
        if not there and on[node] and gateway in leading:
            by = (searched if known.goes_back else walked)(known, live, node)
            there = by != NOWHERE
        cut_off = on[node] and bool(leading) and node not in both
        rows.append({
            "hop": NOWHERE if leader or not on[node] else by if there else known.named[node, 0],
            "depth": depth if there else NOWHERE,
            "on": on[node], "off": off[node], "leads": leader,
            "joined": on[node] and (leader or gateway != NOWHERE),
            "cut_off": cut_off, "astray": on[node] and not there and not cut_off,
        })  # fmt: skip
    return rows


@pytest.mark.parametrize("goes_back", [False, True])
def test_each_packet_gets_as_far_as_it_would_on_paper(goes_back):
    draw, seen = random.Random(7), set()
    for _ in range(300):
        given = network(draw, goes_back)
        found = ways(*given)
        for node, row in enumerate(expected(*given)):
            assert {name: getattr(found, name)[node] for name in row} == row, given
            seen.add((row["on"], row["leads"], row["depth"] >= 0, row["cut_off"], row["astray"]))
        assert (found.without == (found.cut_off | found.astray)).all()
        assert (found.served == (found.on & ~found.cut_off & ~found.leads)).all()
        assert (found.lacks == 1 * found.astray + 2 * found.cut_off).all()
    assert len(seen) >= 7


@pytest.mark.parametrize("goes_back", [False, True])
@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize(("hops", "arrives"), [(PATH_MAX, True), (PATH_MAX + 1, False)])
def test_a_packet_goes_over_so_many_hops_and_no_more(goes_back, named, hops, arrives):
    """In a row, node 0 the gateway; whom to hand it to is named, or a neighbour."""
    count = hops + 1
    onward = np.arange(count) - 1
    choices = Choices(
        np.zeros(count, np.int64),
        np.where(named, onward, NOWHERE)[:, None],
        np.eye(count, k=-1, dtype=bool) & (not named),
        goes_back,
    )
    on = np.ones(count, np.bool_)
    leads = onward == NOWHERE
    found = ways(choices, np.eye(count, k=-1, dtype=bool) | np.eye(count, k=1, dtype=bool),
                 on, ~on, leads)  # fmt: skip
    assert found.astray.tolist() == [False] * (PATH_MAX + 1) + [True] * (hops - PATH_MAX)
