"""What the keys of a mesh scenario must fulfil together, as far as no network is needed for it."""

from collections.abc import Iterator

from innervate.networks.mesh.scenario import fence as mesh_fence
from innervate.networks.mesh.scenario.model import MeshEventTable, MeshScenario
from innervate.networks.mesh.scenario.nodes import (
    NODES_MAX,
    RESERVED,
    most_of,
    there_are,
    too_many,
)
from innervate.scenario import robots
from innervate.scenario.actions.field import TABLE, TARGETS
from innervate.scenario.events import Finding, in_time, own_keys, refuse
from innervate.scenario.source import Source, shown

POWERS = ("mean_degree", "reach_m", "tx_dbm")
CLUSTERS_MAX = 64


def check(source: Source, model: MeshScenario) -> None:
    """Raise ScenarioError at the first thing that does not fit together."""
    refuse(source, _findings(source, model))


def _findings(source: Source, model: MeshScenario) -> Iterator[Finding]:
    yield from _origin(model)
    yield from _nodes(model)
    yield from _clusters(model)
    yield from _links(model)
    yield from _radio(model)
    yield from _protocol(model)
    for index in range(len(model.flow)):
        yield from _flow(model, index)
    if model.fence is not None:
        mesh_fence.check(source, model.fence)
    for index, robot in enumerate(model.robot):
        yield from robots.findings(robot, index)
    for index, event in enumerate(model.event):
        yield from _event(model, index, event)


def _origin(model: MeshScenario) -> Iterator[Finding]:
    """Nodes come from one of four places."""
    given = [
        name
        for name, there in (
            ("nodes", model.nodes is not None),
            ("node", bool(model.node)),
            ("import", model.import_ is not None),
        )
        if there
    ]
    if not given and not model.link:
        yield (), "there is no network; add nodes = 30, [[node]]s or an [import]"
    if len(given) > 1:
        yield (given[1],), f"a mesh is made of one of them: {' or '.join(given)}; leave one out"
    table = model.import_
    if table is not None:
        if model.link:
            message = "[[link]] goes with nodes or [[node]]; an [import] has links of its own"
            yield ("link", 0), message
        if (table.file is None) == (table.topohub is None):
            message = '[import] needs one of the two: file = "freifunk/leipzig" or topohub = "..."'
            yield ("import",), message
        if not table.largest_component and (table.around is not None or table.nodes is not None):
            message = (
                "import.around and nodes take what holds together; leave largest_component out"
            )
            yield ("import", "largest_component"), message


def _nodes(model: MeshScenario) -> Iterator[Finding]:
    most = most_of(model)
    if model.nodes is not None and model.nodes > most:
        yield ("nodes",), too_many(model.nodes, most)
    if model.nodes is not None and model.nodes < 1:
        yield ("nodes",), f"nodes must be 1 to {most}, not {model.nodes}"
    if len(model.node) > most:
        yield ("node",), too_many(len(model.node), most)
    if model.import_ is not None and (model.import_.nodes or 0) > most:
        yield ("import", "nodes"), too_many(model.import_.nodes or 0, most)
    for index, node in enumerate(model.node):
        key = ("node", index)
        if node.name in RESERVED:
            message = f'node.{index}.name = "{node.name}" means something else; choose another name'
            yield (*key, "name"), message
        if (node.x_m is None) != (node.y_m is None):
            yield key, f"node.{index} has half a place; give it both x_m and y_m"
        if node.x_m is None and not model.link:
            yield key, f"node.{index} has no place; give it x_m and y_m, or add [[link]]s"
    if model.node and len({node.x_m is None for node in model.node}) > 1:
        index = next(i for i, node in enumerate(model.node) if node.x_m is None)
        message = f"node.{index} has no place, others have; give all of them x_m and y_m, or none"
        yield ("node", index), message
    if (model.node or model.nodes is None) and model.placement != type(model.placement)():
        yield ("placement",), "[placement] goes with nodes = ...; leave it out"
    if model.placement.layout == "random" and model.placement.columns is not None:
        yield ("placement", "columns"), 'placement.columns goes with layout = "grid"'


def _clusters(model: MeshScenario) -> Iterator[Finding]:
    table = model.clusters
    if table is None:
        return
    given = table.gateways
    count = given if isinstance(given, int) else len(given)
    if not 1 <= count <= CLUSTERS_MAX:
        message = f"clusters.gateways must be 1 to {CLUSTERS_MAX} of them, not {count}"
        yield ("clusters", "gateways"), message
    if table.run > count:
        message = f"clusters.run = {table.run}, but {there_are(count, 'cluster')}; make it smaller"
        yield ("clusters", "run"), message
    if model.gateway is not None:
        yield ("gateway",), "clusters.gateways says who leads; leave gateway out"


def _links(model: MeshScenario) -> Iterator[Finding]:
    for index, link in enumerate(model.link):
        both = link.quality if isinstance(link.quality, tuple) else (link.quality,)
        for share in both:
            if not 0 <= share <= 1:
                message = f"link.{index}.quality must be 0 to 1, not {share:g}"
                yield ("link", index, "quality"), message
        for side, end in (("a", link.a), ("b", link.b)):
            if end in RESERVED or end == "":
                message = f"link.{index}.{side} must be a node by number or name, not {shown(end)}"
                yield ("link", index, side), message


def _radio(model: MeshScenario) -> Iterator[Finding]:
    given = [name for name in POWERS if getattr(model.radio, name) is not None]
    if len(given) > 1:
        message = f"radio.{given[0]} and radio.{given[1]} both set the power; leave one out"
        yield ("radio", given[1]), message
    if model.import_ is not None or model.link:
        given += [n for n in ("shadowing_db", "direction_db")
                  if getattr(model.radio, n) is not None]  # fmt: skip
        if given:
            message = f"radio.{given[0]} has no effect on links that are given; leave it out"
            yield ("radio", given[0]), message
    if model.radio.mean_degree is not None:
        count = model.nodes if model.nodes is not None else len(model.node)
        if model.radio.mean_degree > count - 1:
            yield (
                ("radio", "mean_degree"),
                f"radio.mean_degree = {model.radio.mean_degree:g}, but "
                f"{there_are(count - 1, 'other')}; "
                f"{'make it smaller' if count > 1 else 'leave it out'}",
            )
        if model.placement.layout != "random" and not model.node:
            yield (
                ("radio", "mean_degree"),
                "radio.mean_degree cannot choose between links that are equally long; use "
                "radio.reach_m",
            )


def _protocol(model: MeshScenario) -> Iterator[Finding]:
    protocol = model.protocol
    if not protocol.tables and protocol.failover in ("graph", "auto"):
        message = (
            f'protocol.tables = false and failover = "{protocol.failover}" are two modes; '
            "leave one out"
        )
        yield ("protocol", "tables"), message
    if not protocol.tables and protocol.activation:
        message = "protocol.activation waits for tables, and there are none; leave one out"
        yield ("protocol", "activation"), message
    if protocol.on_demand and not protocol.reliable:
        message = (
            "protocol.on_demand finds a way by the end-to-end ack that comes back on it, and with "
            "reliable = false there are none; leave one out"
        )
        yield ("protocol", "on_demand"), message
    if protocol.avoid == "origin" and protocol.failover not in ("random", "rssi", "heard"):
        message = 'protocol.avoid = "origin" goes with failover = "random", "rssi" or "heard"'
        yield ("protocol", "avoid"), message


def _flow(model: MeshScenario, index: int) -> Iterator[Finding]:
    flow, key, name = model.flow[index], ("flow", index), f"flow.{index}"
    if flow.every_s is not None and flow.rate_hz is not None:
        message = f"{name}.every_s and rate_hz say the same thing twice; leave one out"
        yield (*key, "rate_hz"), message
    if flow.from_ == "monitor":
        message = f'{name}.from must be a node, "all", "random" or "gateway", not "monitor"'
        yield (*key, "from"), message
    if flow.pairs > 1 and "random" not in (flow.from_, flow.to):
        yield (*key, "pairs"), f'{name}.pairs goes with from = "random" or to = "random"'
    if flow.to == "all" and flow.reliable:
        message = f"{name} goes to all, and nobody acknowledges a broadcast; leave reliable out"
        yield (*key, "reliable"), message
    if flow.start_s is not None and flow.start_s >= model.duration_s:
        message = f"{name}.start_s = {flow.start_s:g} is after the end ({model.duration_s:g} s)"
        yield (*key, "start_s"), message
    if flow.stop_s is not None and flow.start_s is not None and flow.stop_s <= flow.start_s:
        message = f"{name}.stop_s = {flow.stop_s:g} is not after start_s = {flow.start_s:g}"
        yield (*key, "stop_s"), message


def _event(model: MeshScenario, index: int, event: MeshEventTable) -> Iterator[Finding]:
    key, name = ("event", index), f"event.{index}"
    yield from in_time(index, event.at_s, model.duration_s)
    given = [t for t in ("node", "link", "random") if getattr(event, t) is not None]
    wanted = TARGETS[event.action]
    words = 'link = ["n1", "n2"] or random = 1' if wanted == "link" else "node = 3 or random = 1"
    if len(given) != 1:
        message = f'{name} ("{event.action}") needs one target: {words}'
        yield (*key, given[1]) if given else key, message
    if given[0] not in (wanted, "random"):
        yield (*key, given[0]), f'{name}: "{event.action}" takes {words}, not {given[0]}'
    if event.random is not None and not 1 <= event.random <= NODES_MAX:
        yield (*key, "random"), f"{name}.random must be 1 to {NODES_MAX}, not {event.random}"
    yield from own_keys(index, event, TABLE)
