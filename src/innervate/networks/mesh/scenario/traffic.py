"""The messages of a mesh: from [[flow]] tables to what is handed to whom, and when."""

from types import SimpleNamespace

import msgspec

from innervate.networks.mesh.protocol.constants import ALL, END_TO_END, MONITOR, PRIORITY
from innervate.networks.mesh.protocol.messages import payload_limit
from innervate.networks.mesh.scenario.model import FlowTable, MeshScenario
from innervate.networks.mesh.scenario.nodes import RESERVED, Nodes, count_of
from innervate.networks.mesh.scenario.plan import Offer
from innervate.networks.radio.scenario.traffic import exponential
from innervate.trace.streams import Stream, stream

OFFERS_MAX = 500_000

Pair = tuple[int, int]


def pairs(model: MeshScenario, nodes: Nodes, gateway: int, monitor: int) -> list[list[Pair]]:
    """Per flow, who sends to whom; recipients may be 254 (the monitor) and 255 (all).

    Raises:
        ScenarioError: a node that is not there, or too few to draw from.
    """
    return [
        _pairs(model, nodes, i, local, gateway, monitor) if local is not None else []
        for i, local in enumerate(_local(nodes, flow, gateway) for flow in model.flow)
    ]


def _local(nodes: Nodes, flow: FlowTable, gateway: int) -> FlowTable | None:
    """A flow as it is in this cluster: a node elsewhere is behind the gateway.

    None if it has no part here, or between the gateway and another cluster alone.
    """
    from_here, to_here = nodes.is_here(flow.from_), nodes.is_here(flow.to)
    if from_here and to_here:
        return flow
    here = flow.from_ if from_here else flow.to
    if not (from_here or to_here) or here in ("gateway", nodes.names[gateway]):
        return None
    if from_here:
        return msgspec.structs.replace(flow, to="gateway")
    return None if here in RESERVED else msgspec.structs.replace(flow, from_="gateway", pairs=1)


def _pairs(
    model: MeshScenario, nodes: Nodes, index: int, flow: FlowTable, gateway: int, monitor: int
) -> list[Pair]:
    draw = stream(model.seed, f"flow/{index}")
    key = ("flow", index)
    everyone = range(len(nodes.names))
    real = -1  # who receives in the end
    if flow.to == "all":
        dest = ALL
    elif flow.to == "monitor":
        dest, real = MONITOR, gateway if monitor == MONITOR else monitor
    elif flow.to == "gateway":
        dest = real = gateway
    elif flow.to == "random":
        dest = -1
    else:
        dest = real = nodes.number((*key, "to"), flow.to)
    if flow.from_ in ("all", "random"):
        sources = [node for node in everyone if node != real]
        if flow.from_ == "random":
            sources = _drawn(nodes, index, flow, sources, draw)
    else:
        sources = [gateway if flow.from_ == "gateway" else
                   nodes.number((*key, "from"), flow.from_)] * flow.pairs  # fmt: skip
    found = []
    for source in sources:
        other = dest
        if dest < 0:
            if len(everyone) < 2:
                raise nodes.source.error(key, f"flow.{index} has nobody to send to; add nodes")
            other = draw.draw(len(everyone) - 1)
            other += other >= source
        if source == real:
            name = nodes.names[source]
            raise nodes.source.error(
                key, f"flow.{index} goes from {name} to {name}; name two nodes"
            )
        found.append((source, other))
    return found


def _drawn(nodes: Nodes, index: int, flow: FlowTable, free: list[int], draw: Stream) -> list[int]:
    """So many senders, drawn from those that are free."""
    if flow.pairs > len(free):
        left = f"only {count_of(len(free), 'node')}" if free else "no node"
        message = f"flow.{index}.pairs = {flow.pairs}, but {left} can be drawn"
        raise nodes.source.error(("flow", index, "pairs"), message)
    return [free.pop(draw.draw(len(free))) for _ in range(flow.pairs)]


def offers(
    model: MeshScenario,
    nodes: Nodes,
    flows: list[list[Pair]],
    settled_s: float,
    duration_us: int,
    mtu: int,
) -> list[Offer]:
    """Every message of flows, of which pairs() found who sends, in order of time.

    Flows that do not say when start at `settled_s`; nothing is offered after the run.

    Raises:
        ScenarioError: longer than a frame, or more than can be kept.
    """
    found: list[tuple[int, int, int, Offer]] = []
    for index, flow in enumerate(model.flow):
        most = payload_max(mtu)
        if flow.bytes > most:
            message = f"flow.{index}.bytes = {flow.bytes}, but at an MTU of {mtu} it is at most"
            raise nodes.source.error(("flow", index, "bytes"), f"{message} {most}")
        for place, (node, dest) in enumerate(flows[index]):
            draw = stream(model.seed, f"flow/{index}/{place}")
            flags = _flags(model, flow, dest)
            times = _times(flow, settled_s, duration_us, draw)
            if len(found) + len(times) > OFFERS_MAX:
                fewer = "lower flow.{}.rate_hz" if flow.rate_hz else "raise flow.{}.every_s"
                raise nodes.source.error(
                    ("flow", index),
                    f"more than {OFFERS_MAX:,} messages would be offered; shorten duration_s "
                    f"or {fewer.format(index)}",
                )
            found += [(at, index, place, Offer(at, node, dest, flags, flow.bytes, index))
                      for at in times]  # fmt: skip
    return [offer for *_, offer in sorted(found, key=lambda item: item[:3])]


def payload_max(mtu: int) -> int:
    """The longest message, in bytes, that goes in one frame."""
    return int(payload_limit(SimpleNamespace(mtu=mtu)))


def _flags(model: MeshScenario, flow: FlowTable, dest: int) -> int:
    reliable = model.protocol.reliable if flow.reliable is None else flow.reliable
    flags = END_TO_END if reliable and dest != ALL else 0
    return flags | (PRIORITY if flow.priority else 0)


def _times(flow: FlowTable, settled_s: float, duration_us: int, draw: Stream) -> list[int]:
    """When one sender's messages are offered, us, ascending."""
    at = round((settled_s if flow.start_s is None else flow.start_s) * 1e6)
    stop = duration_us if flow.stop_s is None else min(duration_us, round(flow.stop_s * 1e6))
    jitter_us = round(flow.jitter_s * 1e6)
    periodic = flow.every_s is not None or flow.rate_hz is not None
    most = flow.count or (OFFERS_MAX + 1 if periodic else 1)
    # The least of all numbers is a rate, too: its wait is longer than any run.
    mean_us = max(1, round(min(1e6 / flow.rate_hz, 1e18))) if flow.rate_hz is not None else 0
    every_us = round((1.0 if flow.every_s is None else flow.every_s) * 1e6)
    found: list[int] = []
    at += exponential(draw, mean_us) if mean_us else 0
    for _ in range(most):
        if at >= stop:
            break
        late = draw.uniform(0, jitter_us) if jitter_us else 0
        if at + late < stop:
            found.append(at + late)
        at += max(1, exponential(draw, mean_us)) if mean_us else every_us
    return sorted(found)
