"""Responses of who hears the gateway, or a node nearer to it, and is not heard there (0080)."""

import pytest

from innervate.networks.mesh.protocol.constants import RESPONSE
from innervate.networks.mesh.protocol.paths import is_heard
from tests.networks.mesh.bench import Bench

SETTLED = 9_000_000


def one_way(links, count=4, **more):
    """Node 1 hears the gateway, which never hears it."""
    bench = Bench(count, links, **more)
    bench.lost = lambda frame, to: frame.link_src == 1 and to == 0
    bench.run(SETTLED)
    return bench


def responded(bench, who):
    """Whether the gateway knows what the node heard in this round."""
    return any(is_heard(bench.gates[0], bench.params, other, who) for other in range(4))


BESIDE = [(0, 1), (0, 2), (1, 2)]  # 2 is as near to the gateway as 1
BEHIND = [(0, 1), (1, 3), (3, 2), (2, 0)]  # 3 is behind 1, and behind 2


@pytest.mark.parametrize("links", [BESIDE, BEHIND])
def test_a_response_that_no_uplink_hears_goes_another_way(links):
    assert responded(one_way(links), 1)


@pytest.mark.parametrize("links", [BESIDE, BEHIND])
def test_by_the_documents_own_rules_it_is_lost(links):
    assert not responded(one_way(links, retry=0), 1)


def test_its_path_names_all_who_had_it():
    bench, paths = Bench(4, BEHIND), []

    def lost(frame, to):
        if frame.kind == RESPONSE and frame.origin == 1 and to == 0:
            paths.append(list(frame.path[: frame.path_len]))
        return frame.link_src == 1 and to == 0

    bench.lost = lost
    bench.run(SETTLED)
    assert [1, 3, 2] in paths
