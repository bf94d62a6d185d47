"""From a mesh scenario to the plan of its run."""

from math import ceil
from typing import Any

from innervate.networks.mesh.protocol.constants import ALL, MONITOR, MTU, WHOLE_GRAPH
from innervate.networks.mesh.protocol.round import SLACK
from innervate.networks.mesh.scenario import clusters, distribution
from innervate.networks.mesh.scenario import events as mesh_events
from innervate.networks.mesh.scenario import fence as mesh_fence
from innervate.networks.mesh.scenario import robots as mesh_robots
from innervate.networks.mesh.scenario import traffic as mesh_traffic
from innervate.networks.mesh.scenario.access import access, suited
from innervate.networks.mesh.scenario.model import MeshScenario
from innervate.networks.mesh.scenario.network import Network, linked, placed
from innervate.networks.mesh.scenario.nodes import Nodes, nodes_of
from innervate.networks.mesh.scenario.params import of_mode, parameters
from innervate.networks.mesh.scenario.plan import MeshPlan
from innervate.networks.mesh.scenario.profiles import Profile, profile_of
from innervate.scenario.robots import starts
from innervate.topology.placement import neighbours
from innervate.trace.streams import stream

START_US = 100_000  # nodes are switched on within this time, the gateway right after it
# Nothing of a round is on the air then: without a standby, a gateway that comes back leads.
COLLECTS_OLD = 4


def plan(scenario: Any) -> MeshPlan:
    """The plan of a mesh scenario: same scenario and seed, same plan, on any machine.

    Raises:
        ScenarioError: it cannot be run as written.
    """
    model, network, cluster = _site(scenario)
    nodes, fence = network.nodes, model.fence
    count = len(nodes.names)
    duration_us = max(1, round(model.duration_s * 1e6))
    profile = suited(model, profile_of(model.radio.profile, count), count)
    ranks = _ranks(model, network)
    gateway = ranks.index(0)
    monitor = MONITOR if model.monitor == "gateway" else nodes.number(("monitor",), model.monitor)
    roles = {"gateway": gateway, "monitor": gateway if monitor == MONITOR else monitor}
    params = _parameters(model, network, profile, monitor)
    if model.protocol.failover == "auto":
        near = neighbours(count, network.good)
        mode = distribution.less_of_both(network.radio, params, near, gateway)
        params |= of_mode(mode, profile)
    walks = mesh_robots.walks(model, nodes, network.points, duration_us)
    if fence is not None:
        visited = [(x, y) for walk in walks for _, x, y in walk.points]
        params |= mesh_fence.parameters(scenario.source, fence, visited, len(walks))
    flows = mesh_traffic.pairs(model, nodes, gateway, monitor)
    robots = {walk.node for walk in walks}
    spared = {*roles.values(), *robots, *_ends(model, flows)}
    mtu = params["mtu"]
    mac, mac_params = access(model, network, profile, mtu, walks)
    return MeshPlan(
        scenario=scenario,
        kind="mesh",
        seed=scenario.seed,
        duration_us=duration_us,
        nodes=count,
        capacity=params["width"],
        names=nodes.names,
        params=params,
        ranks=ranks,
        robots=[int(node in robots) for node in range(count)],
        absent=mesh_events.absent(model, nodes, roles),
        starts_us=_starts(model, ranks),
        mac=mac,
        mac_params=mac_params,
        radio=network.radio,
        positions_cm=network.points,
        good=network.good,
        walks=walks,
        sample_us=round(1e6 / fence.sample_hz) if fence else 20_000,
        origin_cm=mesh_fence.origin_of(mesh_fence.rings_cm(fence)) if fence else (0, 0),
        offers=mesh_traffic.offers(model, nodes, flows, profile.settled, duration_us, mtu),
        faults=mesh_events.faults(model, nodes, network.good, spared, roles, profile.rssi50_cdb),
        cluster=cluster,
    )


def _site(scenario: Any) -> tuple[MeshScenario, Network, clusters.Cluster | None]:
    """Where nodes stand, and of several meshes the one that runs: what is its, and which it is."""
    model: MeshScenario = scenario.model
    nodes = nodes_of(model, scenario.source)
    network = _network(model, nodes, profile_of(model.radio.profile, len(nodes.names)))
    if model.clusters is None:
        return model, network, None
    return clusters.cut(model, network)


def _ends(model: MeshScenario, flows: list[list[tuple[int, int]]]) -> set[int]:
    """Who sends or receives messages that not all send."""
    found: set[int] = set()
    for flow, ends in zip(model.flow, flows, strict=True):
        found.update(a for a, _ in ends if flow.from_ != "all")
        found.update(b for _, b in ends if b not in (MONITOR, ALL))
    return found


def _network(model: MeshScenario, nodes: Nodes, profile: Profile) -> Network:
    begin = starts(model.robot, nodes)
    if not nodes.links:
        return placed(model, nodes, profile, begin)
    found = linked(model, nodes, profile)
    for node, start in begin.items() if found.points else ():
        found.points[node] = start
    return found


def _ranks(model: MeshScenario, network: Network) -> list[int]:
    """Per node 0 gateway, 1.. standby, -1 neither.

    Left out, the gateway is node 0; of a network that was measured, the best connected node.
    """
    nodes = network.nodes
    if model.gateway is not None:
        gateway = nodes.number(("gateway",), model.gateway)
    elif model.import_ is not None:
        degrees = [len(near) for near in neighbours(len(nodes.names), network.good)]
        gateway = degrees.index(max(degrees))
    else:
        gateway = 0
    found = [-1] * len(nodes.names)
    found[gateway] = 0
    for rank, given in enumerate(model.standby, 1):
        key = ("standby", rank - 1)
        node = nodes.number(key, given)
        if found[node] >= 0:
            what = "the gateway" if found[node] == 0 else "a standby already"
            message = f"standby.{rank - 1}: {nodes.names[node]} is {what}; name another node"
            raise nodes.source.error(key, message)
        found[node] = rank
    return found


def _starts(model: MeshScenario, ranks: list[int]) -> list[int]:
    draw = stream(model.seed, "starts")
    drawn = [draw.draw(START_US) for _ in ranks]
    return [START_US if rank == 0 else at for rank, at in zip(ranks, drawn, strict=True)]


def _parameters(
    model: MeshScenario, network: Network, profile: Profile, monitor: int
) -> dict[str, Any]:
    source, count = network.nodes.source, len(network.nodes.names)
    weakest = network.weakest_cdb
    try:
        params = parameters(
            profile,
            model.protocol,
            count,
            degree=max(len(near) for near in neighbours(count, network.good)),
            monitor=monitor,
            min_rssi_dbm=None if weakest is None else round(weakest / 100),
        )
    except ValueError as error:
        key, _, message = str(error).partition(":")
        raise source.error(("protocol", key), message) from None
    params["standby"] = int(len(model.standby) > 0)
    if not model.standby and model.protocol.dead_s is None:
        old = SLACK + ceil(COLLECTS_OLD * params["collect_us"] / params["tick_us"])
        params["dead"] = min(params["dead"], old)
    if params["mtu"] not in distribution.GRAPH_NODES_MAX and model.radio.profile != "ip":
        raise source.error(
            ("protocol", "mtu"),
            f"protocol.mtu = {params['mtu']}, but a frame on the air has 64 or {MTU} bytes; longer "
            'ones need cables: radio.profile = "ip"',
        )
    most = distribution.graph_nodes_max(params["mtu"])
    if params["mode"] == WHOLE_GRAPH and count > most:
        raise source.error(
            ("protocol", "failover"),
            f'failover = "graph" floods the whole graph in 15 frames, which hold {most} nodes at '
            f'an MTU of {params["mtu"]}, not {count}; use "search", or protocol.tables = false',
        )
    return params
