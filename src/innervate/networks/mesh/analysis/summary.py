"""The summary of a mesh run: what a person wants to know of it, as plain numbers and words."""

from typing import Any

import numpy as np

from innervate.analysis.percentiles import usual
from innervate.analysis.summary_common import measured
from innervate.networks.mesh.analysis import messages
from innervate.networks.mesh.analysis import network as network
from innervate.networks.mesh.analysis import summary_keys as keys
from innervate.networks.mesh.analysis.alarms import alarms, judged, robot_hours
from innervate.networks.mesh.analysis.headline import headline, traffic
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.analysis.reach import of_simulation
from innervate.networks.mesh.protocol.constants import ALARM, ALL, DATA, FLOOD, MONITOR, PARITY
from innervate.networks.mesh.scenario.plan import MeshPlan
from innervate.sim.tables import get
from innervate.topology.placement import UNREACHABLE

NONE = 255  # no next hop, no alternate


def summarize(result: Any) -> keys.MeshSummary:
    """The summary of a run whose rows were kept; what never happened is None."""
    plan, counts = result.plan, result.counts
    found, kinds = messages.messages(result), network.acked_kinds(result.sent)
    led, ground = network.gateways(result), Ground(plan)
    crossings, false = judged(result)
    again, met = messages.duplicates(result), looped(result)
    faults = messages.took_effect(plan, result.ended_us)
    sent = traffic(found, crossings, again, met, faults, false)
    return {
        "kind": plan.kind,
        "name": plan.scenario.name,
        **measured(result, counts["handled"] + counts["arrived"]),
        "headline": headline(of_simulation(result.world, plan), sent).as_summary(),
        "nodes": plan.nodes,
        "links": len(plan.good),
        "discovery": network.discovery(result, kinds),
        "delivery_ratio": messages.delivery_ratio(found),
        "latency_ms": usual(messages.latencies_us(found), 1e-3),
        "alarms": alarms(crossings, false, robot_hours(result)),
        "duplicates": again,
        "looped": met,
        "control_bytes": network.control_bytes(result, kinds),
        "messages": _counts(found),
        "connected": connected(found, ground),
        "after_deaths": _after_deaths(found, ground, result.ended_us),
        "flows": flows(found, plan),
        "stretch": stretch(found, ground),
        "alternates": alternates(result),
        "gateways": led,
        "takeover_s": network.takeover_s(result, led),
        "airtime": network.airtime(result, kinds),
        "give_ups": messages.give_ups(result),
        "suspects": network.suspects(result),
        **_of_cluster(plan),
    }


def _of_cluster(plan: MeshPlan) -> keys.OfCluster:
    if plan.cluster is None:
        return {}
    number, sizes, names = plan.cluster.number, plan.cluster.sizes, list(plan.names)
    found = keys.InClusters(number=number, of=len(sizes), nodes=sum(sizes), members=names)
    return {"cluster": found}


def _counts(found: messages.Messages) -> keys.Counts:
    """Messages to one node by what became of them; broadcasts apart."""
    single = found.only(~found.broadcast)
    counts = np.bincount(single.state, minlength=len(messages.STATE_NAMES)).tolist()
    return {
        "offered": len(single.state),
        "delivered": counts[messages.DELIVERED],
        "in_flight": counts[messages.IN_FLIGHT],
        "lost": counts[messages.LOST],
        "refused": counts[messages.REFUSED],
        "sender_off": counts[-1],
        "counted": len(messages.counted(found).state),
        "broadcasts": int(np.count_nonzero(found.broadcast)),
        "partial": int(np.count_nonzero(found.partial)),
    }


def _is_connected(found: messages.Messages, ground: Ground) -> Any:
    """Per message, whether good links joined its sender to its recipient when it was offered."""
    plan = ground.plan
    monitor = plan.params["monitor"]
    monitor = plan.ranks.index(0) if monitor == MONITOR else monitor
    ends = zip(
        found.node.tolist(), found.dest.tolist(), found.receiver.tolist(),
        found.offered_us.tolist(), strict=True,
    )  # fmt: skip
    return np.array(
        [
            ground.hops(node, _recipient(dest, receiver, monitor), at) != UNREACHABLE
            for node, dest, receiver, at in ends
        ],
        np.bool_,
    )


def _recipient(dest: int, receiver: int, monitor: int) -> int:
    if dest != MONITOR:
        return dest
    return monitor if receiver == messages.NEVER else receiver


def connected(found: messages.Messages, ground: Ground) -> keys.Connected:
    """Messages whose sender and recipient were joined by good links of nodes that were on."""
    decided = messages.counted(found)
    joined = decided.only(_is_connected(decided, ground))
    came = int(np.count_nonzero(joined.state == messages.DELIVERED))
    return {
        "sent": len(joined.state),
        "delivered": came,
        "delivery_ratio": messages.ratio(came, len(joined.state)),
    }


def _after_deaths(
    found: messages.Messages, ground: Ground, ended_us: int
) -> keys.AfterDeaths | None:
    """The first message of every connected sender after the last death; None without deaths."""
    died = messages.deaths_us(ground.plan, ended_us)
    if not died:
        return None
    first = connected(messages.first_after(found, died[-1]), ground)
    later = connected(found.only(found.offered_us >= died[-1]), ground)
    return {"first": first, "all": later}


def flows(found: messages.Messages, plan: Any) -> list[keys.Flow]:
    """Per [[flow]] of the scenario: how many messages, delivered, how fast."""
    rows: list[keys.Flow] = []
    for flow in sorted({offer.flow for offer in plan.offers}):
        mine = found.only(found.flow == flow)
        rows.append({
            "flow": flow,
            **_counts(mine),
            "delivery_ratio": messages.delivery_ratio(mine),
            "latency_ms": usual(messages.latencies_us(mine), 1e-3),
        })  # fmt: skip
    return rows


def looped(result: Any) -> int:
    """Packets that visited a node twice on their way, whether they came or not.

    A node has a packet again if it passes it on with another length of its path. A retry of its
    origin comes by later, or with the other parity.
    """
    sent = result.sent
    routed = np.isin(sent["kind"], (DATA, ALARM)) & (sent["flags"] & FLOOD == 0)
    sent = sent[routed & (sent["link_dst"] != ALL)]
    parity = sent["flags"] & PARITY
    fields = [sent[name] for name in ("origin", "seq", "kind", "node")] + [parity]
    within_us = result.plan.params["e2e_us"]
    order, again = messages.repeats(sent["time"], fields, within_us)
    again &= np.diff(sent["path_len"][order].astype(np.int64)) != 0
    met = sent[order[1:][again]]
    told = result.delivered[result.delivered["looped"] == 1]
    return len({
        (int(row["origin"]), int(row["kind"]), int(row["seq"]))
        for rows in (met, told)
        for row in rows
    })  # fmt: skip


def stretch(found: messages.Messages, ground: Ground) -> keys.Stretch:
    """Hops taken over hops of the shortest path there was, of the messages delivered."""
    came = found.only((found.state == messages.DELIVERED) & ~found.broadcast & (found.hops > 0))
    shares = []
    for node, receiver, at, hops in zip(
        came.node.tolist(), came.receiver.tolist(), came.offered_us.tolist(), came.hops.tolist(),
        strict=True,
    ):  # fmt: skip
        least = ground.hops(node, receiver, at)
        if least > 0:
            shares.append(hops / least)
    mean = float(np.mean(shares)) if shares else None
    hops = float(came.hops.mean()) if len(came.hops) else None
    return {"mean": mean, "p99": usual(shares)["p99"], "hops_mean": hops}


def alternates(result: Any) -> float | None:
    """Share of the destinations in tables that have an alternate next hop, at the end."""
    plan, world = result.plan, result.world
    width = plan.params["width"]
    ways = spare = 0
    for node in range(plan.nodes):
        if get(world.nodes, node, "version") == 0:
            continue
        bank = int(get(world.nodes, node, "bank")) * width
        near, alt = (
            np.asarray(get(world.nodes, node, name))[bank : bank + plan.nodes]
            for name in ("next", "alt")
        )
        ways += int(np.count_nonzero(near != NONE))
        spare += int(np.count_nonzero((near != NONE) & (alt != NONE)))
    return messages.ratio(spare, ways)
