"""What a gateway's first round puts on the air to hand out tables, or to flood the whole graph.

Estimates, as if every frame arrived at the first try, and a table named a quarter of the pairs of
a node's neighbours as next hop and alternate. `failover = "auto"` takes what is less by them;
decision 0056 holds them against runs.
"""

from math import ceil
from types import SimpleNamespace
from typing import Any, NamedTuple

from innervate.networks.mesh.protocol import constants as c
from innervate.networks.mesh.protocol import table
from innervate.networks.mesh.scenario.nodes import NODES_MAX
from innervate.networks.mesh.scenario.plan import MeshRadio
from innervate.topology.placement import distances

GRAPH_NODES_MAX = {64: 85, c.MTU: 145}  # by the bytes of a radio's frame
AROUND_BYTES = int(c.HEADER_BYTES + c.CRC_BYTES + table.PART_HEAD)  # of a fragment
ANSWER_BYTES = int(c.HEADER_BYTES + c.CRC_BYTES) + 5  # which fragments are here


class Round(NamedTuple):
    """Airtime of all nodes together, us."""

    tables_us: float
    graph_us: float


def first_round(
    radio: MeshRadio, params: dict[str, Any], near: list[list[int]], gateway: int
) -> Round:
    """What tables take, and what the graph does; `near`: per node whom its good links lead to."""

    def frame_us(size: int) -> float:
        return radio.turnaround_us + (radio.phy_bytes + size) * radio.byte_ns / 1000

    def hop_us(size: int) -> float:
        return frame_us(size) + frame_us(int(c.ACK_BYTES))

    nodes, mtu = len(near), params["mtu"]
    tables_us = answers_us = 0.0
    for hops, around in zip(distances(near, gateway), near, strict=True):
        if hops > 0:
            group_bytes = table.GROUP_BYTES * min(max(1, len(around) ** 2 // 4), nodes)
            sizes = _frames(nodes + group_bytes, AROUND_BYTES + min(hops, int(c.PATH_MAX)), mtu)
            tables_us += hops * sum(map(hop_us, sizes))
            answers_us += hops * hop_us(ANSWER_BYTES + hops)
    graph_bytes = table.graph_bytes(SimpleNamespace(nodes=nodes))
    graph_us = sum(map(frame_us, _frames(graph_bytes, AROUND_BYTES + 1, mtu)))
    return Round(tables_us + answers_us, nodes * params["copies"] * graph_us + answers_us)


def less_of_both(
    radio: MeshRadio, params: dict[str, Any], near: list[list[int]], gateway: int
) -> int:
    """The mode that takes less of the channel: TABLES, or WHOLE_GRAPH if all nodes fit into it."""
    if len(near) > graph_nodes_max(params["mtu"]):
        return int(c.TABLES)
    tables_us, graph_us = first_round(radio, params, near, gateway)
    return int(c.WHOLE_GRAPH if graph_us < tables_us else c.TABLES)


def _frames(size: int, around: int, mtu: int) -> list[int]:
    """Lengths of the frames that carry so many bytes, with so many around those of each."""
    count = ceil(size / (mtu - around))
    return [size // count + around] * count


def graph_nodes_max(mtu: int) -> int:
    """How many nodes a flooded graph holds: by the document on radios [mesh 8.1], else by room."""

    def parts(nodes: int) -> int:
        return int(table.part_count(SimpleNamespace(mtu=mtu, nodes=nodes, mode=c.WHOLE_GRAPH)))

    by_room = (nodes for nodes in range(NODES_MAX, 0, -1) if parts(nodes) <= c.PARTS_MAX)
    return GRAPH_NODES_MAX.get(mtu) or next(by_room)
