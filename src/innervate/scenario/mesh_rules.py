"""What the keys of a mesh scenario must fulfil together, as far as no network is needed for it."""

from __future__ import annotations

from innervate.scenario import mesh_fence
from innervate.scenario.mesh_events import LINK_ACTIONS
from innervate.scenario.mesh_model import MeshEventTable, MeshScenario
from innervate.scenario.mesh_nodes import NODES_MAX, RESERVED, too_many
from innervate.scenario.source import Source, shown
from innervate.scenario.times import check_end

POWERS = ("mean_degree", "reach_m", "tx_dbm")


def check(source: Source, model: MeshScenario) -> None:
    """Raise ScenarioError at the first thing that does not fit together."""
    _origin(source, model)
    _nodes(source, model)
    _links(source, model)
    _radio(source, model)
    _protocol(source, model)
    for index in range(len(model.flow)):
        _flow(source, model, index)
    if model.fence is not None:
        mesh_fence.check(source, model.fence)
    for index in range(len(model.robot)):
        _robot(source, model, index)
    for index, event in enumerate(model.event):
        _event(source, model, index, event)


def _origin(source: Source, model: MeshScenario) -> None:
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
        raise source.error((), "there is no network; add nodes = 30, [[node]]s or an [import]")
    if len(given) > 1:
        message = f"a mesh is made of one of them: {' or '.join(given)}; leave one out"
        raise source.error((given[1],), message)
    table = model.import_
    if table is not None:
        if model.link:
            message = "[[link]] goes with nodes or [[node]]; an [import] has links of its own"
            raise source.error(("link", 0), message)
        if (table.file is None) == (table.topohub is None):
            message = '[import] needs one of the two: file = "freifunk/leipzig" or topohub = "..."'
            raise source.error(("import",), message)


def _nodes(source: Source, model: MeshScenario) -> None:
    if model.nodes is not None and model.nodes > NODES_MAX:
        raise source.error(("nodes",), too_many(model.nodes))
    if model.nodes is not None and model.nodes < 1:
        raise source.error(("nodes",), f"nodes must be 1 to {NODES_MAX}, not {model.nodes}")
    if len(model.node) > NODES_MAX:
        raise source.error(("node",), too_many(len(model.node)))
    for index, node in enumerate(model.node):
        key = ("node", index)
        if node.name in RESERVED:
            message = f'node.{index}.name = "{node.name}" means something else; choose another name'
            raise source.error((*key, "name"), message)
        if (node.x_m is None) != (node.y_m is None):
            raise source.error(key, f"node.{index} has half a place; give it both x_m and y_m")
        if node.x_m is None and not model.link:
            message = f"node.{index} has no place; give it x_m and y_m, or add [[link]]s"
            raise source.error(key, message)
    if model.node and len({node.x_m is None for node in model.node}) > 1:
        index = next(i for i, node in enumerate(model.node) if node.x_m is None)
        message = f"node.{index} has no place, others have; give all of them x_m and y_m, or none"
        raise source.error(("node", index), message)
    if (model.node or model.nodes is None) and model.placement != type(model.placement)():
        raise source.error(("placement",), "[placement] goes with nodes = ...; leave it out")
    if model.placement.layout == "random" and model.placement.columns is not None:
        message = 'placement.columns goes with layout = "grid"'
        raise source.error(("placement", "columns"), message)


def _links(source: Source, model: MeshScenario) -> None:
    for index, link in enumerate(model.link):
        both = link.quality if isinstance(link.quality, tuple) else (link.quality,)
        for share in both:
            if not 0 <= share <= 1:
                message = f"link.{index}.quality must be 0 to 1, not {share:g}"
                raise source.error(("link", index, "quality"), message)
        for side, end in (("a", link.a), ("b", link.b)):
            if end in RESERVED or end == "":
                message = f"link.{index}.{side} must be a node by number or name, not {shown(end)}"
                raise source.error(("link", index, side), message)


def _radio(source: Source, model: MeshScenario) -> None:
    given = [name for name in POWERS if getattr(model.radio, name) is not None]
    if len(given) > 1:
        message = f"radio.{given[0]} and radio.{given[1]} both set the power; leave one out"
        raise source.error(("radio", given[1]), message)
    if model.import_ is not None or model.link:
        given += [n for n in ("shadowing_db", "direction_db")
                  if getattr(model.radio, n) is not None]  # fmt: skip
        if given:
            message = f"radio.{given[0]} has no effect on links that are given; leave it out"
            raise source.error(("radio", given[0]), message)
    if model.radio.mean_degree is not None:
        count = model.nodes if model.nodes is not None else len(model.node)
        if model.radio.mean_degree > count - 1:
            message = f"radio.mean_degree = {model.radio.mean_degree:g}, but there are {count - 1}"
            raise source.error(("radio", "mean_degree"), f"{message} others; make it smaller")
        if model.placement.layout != "random" and not model.node:
            message = "radio.mean_degree cannot choose between links that are equally long"
            raise source.error(("radio", "mean_degree"), f"{message}; use radio.reach_m")


def _protocol(source: Source, model: MeshScenario) -> None:
    protocol = model.protocol
    if not protocol.tables and protocol.failover == "graph":
        message = 'protocol.tables = false and failover = "graph" are two modes; leave one out'
        raise source.error(("protocol", "tables"), message)
    if not protocol.tables and protocol.activation:
        message = "protocol.activation waits for tables, and there are none; leave one out"
        raise source.error(("protocol", "activation"), message)
    if protocol.avoid == "origin" and protocol.failover not in ("random", "rssi"):
        message = 'protocol.avoid = "origin" goes with failover = "random" or "rssi"'
        raise source.error(("protocol", "avoid"), message)


def _flow(source: Source, model: MeshScenario, index: int) -> None:
    flow, key, name = model.flow[index], ("flow", index), f"flow.{index}"
    if flow.every_s is not None and flow.rate_hz is not None:
        message = f"{name}.every_s and rate_hz say the same thing twice; leave one out"
        raise source.error((*key, "rate_hz"), message)
    if flow.from_ == "monitor":
        message = f'{name}.from must be a node, "all", "random" or "gateway", not "monitor"'
        raise source.error((*key, "from"), message)
    if flow.pairs > 1 and "random" not in (flow.from_, flow.to):
        message = f'{name}.pairs goes with from = "random" or to = "random"'
        raise source.error((*key, "pairs"), message)
    if flow.to == "all" and flow.reliable:
        message = f"{name} goes to all, and nobody acknowledges a broadcast; leave reliable out"
        raise source.error((*key, "reliable"), message)
    if flow.start_s is not None and flow.start_s >= model.duration_s:
        message = f"{name}.start_s = {flow.start_s:g} is after the end ({model.duration_s:g} s)"
        raise source.error((*key, "start_s"), message)
    if flow.stop_s is not None and flow.start_s is not None and flow.stop_s <= flow.start_s:
        message = f"{name}.stop_s = {flow.stop_s:g} is not after start_s = {flow.start_s:g}"
        raise source.error((*key, "stop_s"), message)


def _robot(source: Source, model: MeshScenario, index: int) -> None:
    robot, key = model.robot[index], ("robot", index)
    if robot.random and len(robot.waypoints) > 1:
        message = f"robot.{index} is random and has waypoints; keep the first, its start, or none"
        raise source.error((*key, "waypoints"), message)
    if robot.area is not None and not robot.random:
        message = f"robot.{index}.area goes with random = true"
        raise source.error((*key, "area"), message)


def _event(source: Source, model: MeshScenario, index: int, event: MeshEventTable) -> None:
    key, name = ("event", index), f"event.{index}"
    times = event.at_s if isinstance(event.at_s, tuple) else (event.at_s, event.at_s)
    if times[0] > times[1]:
        message = f"{name}.at_s must be [from, to], not [{times[0]:g}, {times[1]:g}]"
        raise source.error((*key, "at_s"), message)
    if not times[0] >= 0:
        message = f"{name}.at_s must be a number of seconds from 0, not {times[0]:g}"
        raise source.error((*key, "at_s"), message)
    check_end(source, index, times[1], model.duration_s)
    given = [t for t in ("node", "link", "random") if getattr(event, t) is not None]
    wanted = "link" if event.action in LINK_ACTIONS else "node"
    words = 'link = ["n1", "n2"] or random = 1' if wanted == "link" else "node = 3 or random = 1"
    if len(given) != 1:
        message = f'{name} ("{event.action}") needs one target: {words}'
        raise source.error((*key, given[1]) if given else key, message)
    if given[0] not in (wanted, "random"):
        message = f'{name}: "{event.action}" takes {words}, not {given[0]}'
        raise source.error((*key, given[0]), message)
    if event.random is not None and not 1 <= event.random <= NODES_MAX:
        message = f"{name}.random must be 1 to {NODES_MAX}, not {event.random}"
        raise source.error((*key, "random"), message)
    if event.noise_dbm is not None and event.action != "jam":
        message = f'{name}.noise_dbm goes with "jam", not "{event.action}"'
        raise source.error((*key, "noise_dbm"), message)
