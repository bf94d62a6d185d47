"""A robot leaves the fence while nodes are dead of whom nobody knows."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from innervate.networks.mesh.analysis.alarms import all_crossings
from innervate.networks.mesh.analysis.fence import position_cm
from innervate.networks.mesh.analysis.messages import NEVER, duplicates
from innervate.networks.mesh.analysis.paths import UNREACHABLE, distances
from innervate.networks.mesh.papers.testbed import (
    GATEWAY,
    LITERAL,
    MeshTestbed,
    Options,
    dying,
    kill,
)
from innervate.networks.mesh.protocol.constants import ALARM, FLOOD
from innervate.networks.mesh.scenario.profiles import GOOD_CDB
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers.experiment import Measured, Point
from innervate.sim.status import ON_FRAME
from innervate.topology.placement import distance_cm, path_loss_cdb
from innervate.trace.streams import stream

NODES = 30
ROBOT = NODES - 1
LOW_M, HIGH_M = 15, 85  # the fence, in a square of 100 m
INSIDE_M, OUTSIDE_M = 6, 6
CROSSED_S = 8.0  # tables are there; the crossing is within a second of it
KNOWN_US = 100_000  # the dead die so long before: nobody sent anything to them since
AFTER_S = 3.0


class Scheme(NamedTuple):
    """How alarms go to the monitor."""

    name: str
    flood: str
    protocol: Options = ()


GRAPH: Options = (("failover", "graph"),)
BOTH = Scheme("routed and flooded", "crossings")
ROUTED = Scheme("routed alone", "never")
GRAPH_BOTH = Scheme("graph, routed and flooded", "crossings", GRAPH)
GRAPH_ROUTED = Scheme("graph, routed alone", "never", GRAPH)
DOCUMENT = Scheme("the document's rule", "never", LITERAL)


def walk(seed: int) -> tuple[list[list[float]], float]:
    """(a way straight out through one of the four sides, when the robot sets out)."""
    draw = stream(seed, "papers/walk")
    side = draw.draw(4)
    along = (LOW_M * 100 + draw.draw((HIGH_M - LOW_M) * 100)) / 100
    start_s = CROSSED_S - INSIDE_M + draw.draw(1_000_000) / 1e6
    low, out = side % 2 == 0, side // 2
    edge, way = (LOW_M, -1) if low else (HIGH_M, 1)
    ends = [edge - way * INSIDE_M, edge + way * OUTSIDE_M]
    return [[end, along] if out else [along, end] for end in ends], start_s


def make_testbed(scheme: Scheme, seed: int) -> MeshTestbed:
    """The network of one crossing."""
    way, start_s = walk(seed)
    square = [[LOW_M, LOW_M], [HIGH_M, LOW_M], [HIGH_M, HIGH_M], [LOW_M, HIGH_M]]
    robot = {"node": ROBOT, "waypoints": way, "speed_mps": 1.0, "start_s": start_s}
    more = (("fence", {"polygon": square, "flood": scheme.flood}), ("robot", [robot]))
    duration_s = CROSSED_S + 1 + AFTER_S
    return MeshTestbed(nodes=NODES, protocol=scheme.protocol, duration_s=duration_s, more=more)


def measure(scheme: Scheme, dead: int, seed: int) -> dict[str, Any]:
    """One crossing; the monitor is the gateway."""
    plan = make_testbed(scheme, seed).plan(seed)
    out_us = round((walk(seed)[1] + INSIDE_M) * 1e6)
    gone = dying(plan, dead, (GATEWAY, ROBOT))
    kill(plan, gone, out_us - KNOWN_US)
    result = simulate(plan, trail=True)
    (crossing,) = all_crossings(result)
    came = crossing.accepted_us != NEVER
    flooded = _flooded(result, crossing.raised_us)
    return {
        "joined": _joined(plan, gone, out_us),
        "came": came,
        "ms": (crossing.accepted_us - crossing.raised_us) / 1e3 if came else None,
        "flood_ms": None if flooded is None else flooded / 1e3,
        "by_flood": crossing.flooded,
        "hops": crossing.hops if came else None,
        "overrun_m": crossing.overrun_m,
        "duplicates": duplicates(result),
    }


def _flooded(result: Any, since_us: int) -> int | None:
    """How long after the alarm the monitor heard its first flooded copy, us."""
    trail, sent = result.trail, result.sent
    heard = (trail["node"] == GATEWAY) & (trail["handler"] == ON_FRAME) & (trail["port"] == ALARM)
    flood = (sent["kind"] == ALARM) & (sent["flags"] & FLOOD != 0) & (sent["origin"] == ROBOT)
    ends = sent["end"][flood & (sent["time"] >= since_us)]
    both = np.intersect1d(trail["time"][heard], ends)
    return int(both[0]) - since_us if len(both) and since_us != NEVER else None


def _joined(plan: Any, gone: list[int], at_us: int) -> bool:
    """True if good links of live nodes join the robot and the monitor where it crosses."""
    radio, count = plan.radio, plan.nodes
    (way,) = plan.walks
    x, y = position_cm(way, at_us)
    here = (round(x), round(y))
    near: list[list[int]] = [[] for _ in range(count)]
    links = [link for link in plan.good if way.node not in link]
    for node, place in enumerate(plan.positions_cm):
        if node != way.node:
            loss = path_loss_cdb(distance_cm(here, place), radio.exponent_c)
            there, back = way.node * count + node, node * count + way.node
            least = min(radio.base_cdb[there], radio.base_cdb[back])
            if least >= radio.rssi50_cdb + GOOD_CDB + loss:
                links.append((node, way.node))
    for a, b in links:
        if a not in gone and b not in gone:
            near[a].append(b)
            near[b].append(a)
    return bool(distances(near, GATEWAY)[way.node] != UNREACHABLE)


def point(scheme: Scheme, dead: int, quick: bool) -> Point:
    """Crossings; a 99th percentile wants 300, and a few robots are cut off."""
    words = " ".join(f"{name}={value}" for name, value in scheme.protocol)
    what = f"crossings: {scheme.name} {words} {dead} dead"
    return Point.each(what, 0.08, range(1, 21 if quick else 401), measure, scheme, dead)


def told(got: Measured, scheme: Scheme, dead: int) -> dict[str, Any]:
    """What the crossings gave whose robot was connected to the monitor, an array a name.

    What never happened is infinite.
    """
    found = got[point(scheme, dead, got.quick)]
    joined = np.array(found["joined"])
    return {
        name: np.nan_to_num(np.array(values, float), nan=np.inf)[joined]
        for name, values in found.items()
    }
