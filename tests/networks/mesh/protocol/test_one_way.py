"""Responses of who hears the gateway, or a node nearer to it, and is not heard there (0080)."""

import pytest

from innervate.networks.mesh.protocol.constants import RESPONSE
from innervate.networks.mesh.protocol.paths import is_heard
from tests.networks.mesh.bench import Bench

BESIDE = [(0, 1), (0, 2), (1, 2), (0, 4)]  # 2 is as near to the gateway as 1
BEHIND = [(0, 1), (1, 3), (3, 2), (2, 0), (0, 4)]  # 3 is behind 1, and behind 2


def one_way(links, lost=lambda frame, to: frame.link_src == 1 and to == 0, **more):
    """Node 1 hears the gateway, which never hears it, and acknowledges what 4 sends."""
    bench = Bench(5, links, **more)
    bench.lost = lost
    for ms in range(100, 3_000, 4):
        bench.run(1_000 * ms)
        bench.send(4, 0, flags=0)
    bench.run(9_000_000)
    return bench


def responded(bench, who):
    """Whether the gateway knows what the node heard in this round."""
    return any(is_heard(bench.gates[0], bench.params, other, who) for other in range(5))


@pytest.mark.parametrize("links", [BESIDE, BEHIND])
def test_a_response_that_no_uplink_hears_goes_another_way(links):
    assert responded(one_way(links), 1)


@pytest.mark.parametrize("links", [BESIDE, BEHIND])
def test_by_the_documents_own_rules_it_is_lost(links):
    assert not responded(one_way(links, retry=0), 1)


def paths_of_1(lost):
    """Paths of the frames that bring the response of node 1 to a neighbour, as they are sent."""
    paths = []

    def noted(frame, to):
        if frame.kind == RESPONSE and frame.origin == 1:
            paths.append(list(frame.path[: frame.path_len]))
        return lost(frame, to)

    one_way(BEHIND, noted)
    return paths


def test_its_path_names_all_who_had_it():
    assert [1, 3, 2] in paths_of_1(lambda frame, to: frame.link_src == 1 and to == 0)


def test_where_nothing_is_heard_of_the_gateway_it_goes_nowhere_else():
    """Who begins a round and dies would have all responses walk about."""
    paths = paths_of_1(lambda frame, to: (frame.link_src == 0 and frame.kind != 1) or to == 0)
    assert paths
    assert [1, 3] not in paths
