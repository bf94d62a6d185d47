"""What must hold of babel, rpl and flooding: each invariant kept, and broken by each of its parts.

A state that keeps all is changed in one or two fields; the last of each group stands just on the
edge, on its other side.
"""

from types import SimpleNamespace as State

import pytest

from innervate.networks.babel import invariants as babel
from innervate.networks.flooding import invariants as flooding
from innervate.networks.rpl import invariants as rpl
from innervate.networks.rpl.protocol.constants import INFINITE

FAR = babel.INFINITY
ROUTE = {"parent": 0, "known": [1], "metric": [96], "cost": [96], "seq": [7], "said": 192,
         "fd_known": 1, "fd_seq": 7, "fd_metric": 192, "neighbour": [1]}  # fmt: skip
RANKED = {"number": 3, "parent": 0, "rank": 600, "nbr_rank": [599], "version": 5,
          "nbr_version": [5], "lowest": 500, "under": 0, "waiting": 0}  # fmt: skip
ROOT = {"number": 0, "parent": -1, "rank": 256}
RPL = State(root=0, step=256, increase=100)
PLACES = {"waits": [0] * 7 + [1], "hops": [9] * 7 + [2], "start": [3] * 8,
          "origin": [4] * 8, "packet": [8] * 8, "number": 1,
          "open": [0, 0, 0, 1], "open_tries": [9, 9, 9, 3]}  # fmt: skip
BROKEN = {
    babel.node_selects_feasible_routes: [
        (ROUTE, {}, True),
        (ROUTE, {"metric": [192]}, False),
        (ROUTE, {"metric": [193], "seq": [8]}, True),
        (ROUTE, {"seq": [6]}, False),
        (ROUTE, {"metric": [500], "fd_known": 0}, True),
        (ROUTE, {"known": [0]}, False),
        (ROUTE, {"metric": [FAR], "seq": [8]}, False),
        (ROUTE, {"cost": [FAR]}, False),
        (ROUTE, {"known": [0], "parent": -1}, True),
    ],
    babel.node_advertises_nothing_nearer: [
        (ROUTE, {}, True),
        (ROUTE, {"fd_known": 0}, False),
        (ROUTE, {"fd_known": 0, "said": FAR}, True),
    ],
    rpl.node_is_above_its_parent: [
        (RANKED, {}, True),
        (RANKED, {"rank": 599}, False),
        (RANKED, {"rank": 1, "parent": -1}, True),
    ],
    rpl.node_with_a_parent_is_of_its_version: [
        (RANKED, {}, True),
        (RANKED, {"version": 6}, False),
        (RANKED, {"version": 6, "parent": -1}, True),
    ],
    rpl.node_without_a_parent_is_at_infinity: [
        (RANKED, {}, True),
        (RANKED, {"parent": -1}, False),
        (RANKED, {"rank": INFINITE}, False),
        (RANKED, {"rank": INFINITE, "parent": -1}, True),
        (ROOT, {}, True),
        (ROOT, {"parent": 0}, False),
        (ROOT, {"rank": 257}, False),
    ],
    rpl.node_moves_down_no_further_than_allowed: [
        (RANKED, {}, True),
        (RANKED, {"rank": 601}, False),
        (RANKED, {"rank": INFINITE}, True),
        (RANKED, {"rank": 60_000, "lowest": INFINITE}, True),
    ],
    rpl.node_has_one_frame_under_way: [
        (RANKED, {}, True),
        (RANKED, {"waiting": 1}, False),
        (RANKED, {"waiting": 1, "under": 1}, True),
    ],
    flooding.node_passes_on_what_may_still_go: [
        (PLACES, {}, True),
        (PLACES, {"hops": [9] * 7 + [3]}, False),
        (PLACES, {"hops": [9] * 7 + [4]}, False),
    ],
    flooding.node_keeps_a_packet_once: [
        (PLACES, {}, True),
        (PLACES, {"waits": [1] + [0] * 6 + [1]}, False),
        (PLACES, {"waits": [0] * 6 + [1, 1]}, False),
        (PLACES, {"waits": [1] + [0] * 6 + [1], "origin": [5] + [4] * 7}, True),
        (PLACES, {"waits": [1] + [0] * 6 + [1], "packet": [9] + [8] * 7}, True),
    ],
    flooding.node_passes_on_no_packet_of_its_own: [
        (PLACES, {}, True),
        (PLACES, {"number": 4}, False),
        (PLACES, {"number": 4, "waits": [0] * 8}, True),
    ],
    flooding.node_sends_again_as_often_as_asked: [
        (PLACES, {}, True),
        (PLACES, {"open_tries": [9, 9, 9, 4]}, False),
        (PLACES, {"open_tries": [9, 9, 9, 4], "open": [0] * 4}, True),
    ],
}  # fmt: skip
PARAMS = {babel: State(), rpl: RPL, flooding: State(retries=3)}


@pytest.mark.parametrize("holds", BROKEN, ids=lambda one: one.__name__)
def test_an_invariant_sees_each_way_to_break_it(holds):
    (params,) = (PARAMS[room] for room in PARAMS if room.__name__ == holds.__module__)
    for state, change, kept in BROKEN[holds]:
        assert bool(holds(State(**{**state, **change}), params, 0)) == kept, change


def test_all_invariants_of_nodes_are_broken_here():
    there = {getattr(room, name) for room in PARAMS for name in dir(room) if name[:5] == "node_"}
    assert there == set(BROKEN)


def test_rpl_allows_any_way_down_where_no_limit_is_set():
    free = State(root=0, step=256, increase=0)
    assert rpl.node_moves_down_no_further_than_allowed(State(**RANKED | {"rank": 9999}), free, 0)


def chain(*parents):
    """Nodes whose port 0 leads to these; -1 = no route. Distances fall towards the first."""
    return [
        State(**ROUTE | {"parent": 0 if far >= 0 else -1, "neighbour": [far], "fd_metric": 9 + i})
        for i, far in enumerate(parents)
    ]


@pytest.mark.parametrize(
    ("parents", "kept"),
    [((-1, 0, 1), True), ((-1, 0, 1, 2, 3), True), ((1, 0), False), ((-1, 2, 3, 1), False)],
)
def test_babel_sees_a_loop_of_next_hops_of_any_length(parents, kept):
    nodes = chain(*parents)
    assert bool(babel.network_has_no_loop(nodes, len(nodes), None)) == kept


def test_babel_sees_a_next_hop_that_is_no_nearer():
    def falls(**change):
        nodes = chain(-1, 0, 1)
        for name, value in change.items():
            setattr(nodes[1], name, value)
        return bool(babel.network_feasibility_distances_fall(nodes, 3, None))

    assert falls()
    assert not falls(fd_metric=9)  # no better than that of its next hop, node 0
    assert not falls(fd_metric=11)  # ... and than that of node 2, which comes through it
    assert not falls(fd_seq=8)
    assert not falls(fd_seq=6)
    assert falls(fd_metric=11, fd_known=0)  # one that is forgotten is compared with nothing
    assert falls(fd_metric=9, fd_known=0)
    assert falls(fd_metric=9, parent=-1)
