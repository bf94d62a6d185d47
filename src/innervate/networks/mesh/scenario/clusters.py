"""More nodes than one mesh has addresses for: clusters, each a mesh with a channel of its own.

Each has a gateway, and the nodes that are nearest to it. Gateways have a network of their own that
hands on what is for a node elsewhere; it is not simulated. A run is that of one cluster: the others
are on other channels, and nothing of them is heard.
"""

from dataclasses import dataclass, replace
from typing import Any

import msgspec

from innervate.networks.mesh.scenario.model import ClustersTable, MeshScenario
from innervate.networks.mesh.scenario.network import Network
from innervate.networks.mesh.scenario.nodes import Nodes, there_are
from innervate.networks.mesh.scenario.plan import ONE, MeshRadio
from innervate.topology import clusters
from innervate.topology.placement import neighbours

UNIT = 100  # of a link that loses nothing: hundredths of transmissions until one is acknowledged


@dataclass(frozen=True, slots=True)
class Cluster:
    """Which part of a network a run is of."""

    number: int  # of this cluster, from 1 on
    sizes: tuple[int, ...]  # per cluster how many nodes it has
    gateways: tuple[str, ...]  # per cluster what its gateway is called

    @property
    def words(self) -> str:
        """Which one: "cluster 2 of 5"."""
        return f"cluster {self.number} of {len(self.sizes)}"


def cut(model: MeshScenario, network: Network) -> tuple[MeshScenario, Network, Cluster]:
    """A run's cluster: a scenario with [clusters] and its network as they are for those in it.

    Raises:
        ScenarioError: a gateway that is not there or is named twice, or too few of them.
    """
    assert model.clusters is not None
    nodes, which = network.nodes, model.clusters.run - 1
    robots = {nodes.number(("robot", i, "node"), one.node) for i, one in enumerate(model.robot)}
    near = neighbours(len(nodes.names), network.good)
    leaders = _gateways(model.clusters, nodes, near, robots)
    owner = clusters.shared(near, _costs(network), leaders, model.clusters.nodes_max)
    _join_strays(owner, network.radio)
    sizes = [owner.count(one) for one in range(len(leaders))]
    _check_sizes(nodes, leaders, sizes, model.clusters.nodes_max)
    members = [node for node, one in enumerate(owner) if one == which]
    found = Cluster(which + 1, tuple(sizes), tuple(nodes.names[node] for node in leaders))
    part = _part(network, members)
    return _local(model, part.nodes, found.gateways[which]), part, found


def _gateways(
    table: ClustersTable, nodes: Nodes, near: list[list[int]], robots: set[int]
) -> list[int]:
    """Who leads; where only their number is given, nodes that are amidst the others."""
    key = ("clusters", "gateways")
    if isinstance(table.gateways, int):
        able = [node for node in range(len(near)) if node not in robots]
        if table.gateways > len(able):
            there = there_are(len(able), "node")
            message = f"clusters.gateways = {table.gateways}, but {there}"
            raise nodes.source.error(key, message)
        return clusters.heads(near, table.gateways, able)
    found: list[int] = []
    for i, given in enumerate(table.gateways):
        node = nodes.number((*key, i), given)
        if node in found:
            message = f"clusters.gateways names {nodes.names[node]} twice; leave one out"
            raise nodes.source.error(key, message)
        found.append(node)
    return found


def _costs(network: Network) -> dict[tuple[int, int], int]:
    """Transmissions until one is acknowledged, of each good link [ETX]."""
    prob, count, found = network.radio.prob_q15, len(network.nodes.names), {}
    for a, b in network.good:
        both = max(1, prob[a * count + b] * prob[b * count + a])
        found[a, b] = found[b, a] = max(1, UNIT * ONE * ONE // both)
    return found


def _join_strays(owner: list[int], radio: MeshRadio) -> None:
    """Whom no good link reaches, a robot, is with the node that it hears best."""
    count = len(owner)
    for node in [node for node, one in enumerate(owner) if one < 0]:
        heard = radio.rssi_cdb[node::count]
        others = [other for other in range(count) if owner[other] >= 0]
        owner[node] = owner[max(others, key=lambda other: (heard[other], -other))]


def _check_sizes(nodes: Nodes, leaders: list[int], sizes: list[int], most: int) -> None:
    large = max(range(len(sizes)), key=lambda one: sizes[one])
    if sizes[large] > most:
        name = nodes.names[leaders[large]]
        raise nodes.source.error(
            ("clusters", "gateways"),
            f"the cluster of {name} would have {sizes[large]} nodes, and it may have {most}; add "
            "a gateway near it",
        )


def _part(network: Network, members: list[int]) -> Network:
    """A network of some nodes, as if the others were not there."""
    nodes, count = network.nodes, len(network.nodes.names)
    number = {old: new for new, old in enumerate(members)}

    def square(table: list[Any]) -> list[Any]:
        return [table[a * count + b] for a in members for b in members] if table else []

    radio = network.radio
    return Network(
        nodes=Nodes(
            nodes.source,
            [nodes.names[old] for old in members],
            [nodes.points[old] for old in members] if nodes.points else [],
            {(number[a], number[b]): both for (a, b), both in nodes.links.items()
             if a in number and b in number},
            nodes.names,
            nodes.left_out,
        ),
        points=[network.points[old] for old in members] if network.points else [],
        radio=replace(
            radio,
            rssi_cdb=square(radio.rssi_cdb),
            prob_q15=square(radio.prob_q15),
            base_cdb=square(radio.base_cdb),
        ),
        good=[(number[a], number[b]) for a, b in network.good if a in number and b in number],
        weakest_cdb=network.weakest_cdb,
    )  # fmt: skip


def _local(model: MeshScenario, nodes: Nodes, gateway: str) -> MeshScenario:
    """The scenario for the cluster's nodes: what is elsewhere is behind its gateway."""
    return msgspec.structs.replace(
        model,
        gateway=gateway,
        standby=[one for one in model.standby if nodes.is_here(one)],
        monitor=model.monitor if nodes.is_here(model.monitor) else "gateway",
    )
