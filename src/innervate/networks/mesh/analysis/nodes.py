"""Node by node: who hears whom, what each knows at the end of a run, what it sent."""

from typing import Any, NamedTuple

import numpy as np

from innervate.networks.mesh.analysis.network import CONTROL, acked_kinds, airtime_us
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.protocol.constants import DATA, REPORT_SUSPECT
from innervate.sim.tables import get

UNKNOWN = 255


class Node(NamedTuple):
    """A node at the end of a run."""

    node: int  # its number
    on: bool  # it is switched on
    neighbours: int  # good links to nodes that are on
    # hops to the gateway in the newest round, 0 the gateway; None before the first
    depth: int | None
    gateway: int | None  # whom it follows; None nobody
    version: int  # of its table, 0 none
    control_bytes: int  # of discovery and tables that it sent, acks included
    forwarded: int  # transmissions of other nodes' messages
    share: float  # of the run that it was on the air
    suspected: int  # how often its neighbours gave up on it


def nodes(result: Any) -> list[Node]:
    """All nodes, in order of number."""
    plan, sent, world = result.plan, result.sent, result.world
    kinds, count = acked_kinds(sent), plan.nodes
    control = np.bincount(sent["node"], sent["bytes"] * np.isin(kinds, CONTROL), count)
    passing = (sent["kind"] == DATA) & (sent["node"] != sent["origin"])
    forwarded = np.bincount(sent["node"][passing], minlength=count)
    shares = np.bincount(sent["node"], airtime_us(sent), count) / result.ended_us
    doubted = result.rows["a"][result.rows["code"] == REPORT_SUSPECT]
    suspected = np.bincount(doubted, minlength=count)
    ground = Ground(plan)
    on, near = ground.on_at(result.ended_us), ground.near_at(result.ended_us)
    return [
        Node(
            node=node,
            on=on[node],
            neighbours=len(near[node]),
            depth=_hops(_known(get(world.nodes, node, "depth"))),
            gateway=_known(get(world.nodes, node, "gateway")),
            version=int(get(world.nodes, node, "version")),
            control_bytes=int(control[node]),
            forwarded=int(forwarded[node]),
            share=float(shares[node]),
            suspected=int(suspected[node]),
        )
        for node in range(count)
    ]


def _known(value: Any) -> int | None:
    return None if int(value) == UNKNOWN else int(value)


def _hops(advertised: int | None) -> int | None:
    """A gateway advertises 1: whoever hears it is one hop away."""
    return None if advertised is None else advertised - 1
