"""The way an alarm took through a mesh, put together from what was on the air."""

from typing import Any, NamedTuple

import numpy as np

from innervate.networks.mesh.analysis.alarms import Crossing
from innervate.networks.mesh.analysis.messages import NEVER
from innervate.networks.mesh.protocol.constants import ALARM, ALL, FLOOD
from innervate.networks.mesh.scenario.plan import ONE


class Hop(NamedTuple):
    """A transmission of an alarm."""

    # start_us, end_us: when it was on the air
    start_us: int
    end_us: int
    node: int  # who sent it
    to: int  # for whom, 255 all
    flooded: bool  # a copy of the flood
    path_len: int  # how many nodes had transmitted the copy, this one included
    receivers: int  # how many decoded it


def copies(result: Any, crossing: Crossing) -> list[Hop]:
    """All transmissions of the alarm that the monitor accepted first, in order of time.

    Of an alarm that never came: of what its raiser sent from then on, for 2 s.
    """
    sent = result.sent[result.sent["kind"] == ALARM]
    if crossing.row != NEVER:
        given = result.delivered[crossing.row]
        mine = (sent["origin"] == given["origin"]) & (sent["seq"] == given["seq"])
        mine &= sent["time"] >= crossing.crossed_us
    elif crossing.raised_us != NEVER:
        mine = (sent["origin"] == crossing.raised_by) & (sent["time"] >= crossing.raised_us)
        mine &= sent["time"] < crossing.raised_us + 2_000_000
    else:
        mine = np.zeros(len(sent), np.bool_)
    names = ["time", "end", "node", "link_dst", "flags", "path_len", "receivers"]
    rows = np.sort(sent[mine], order="time")[names].tolist()
    return [Hop(start, end, node, to, bool(flags & FLOOD), length, heard)
            for start, end, node, to, flags, length, heard in rows]  # fmt: skip


def way(result: Any, crossing: Crossing, sent: list[Hop] | None = None) -> list[Hop]:
    """The hops of the copy that the monitor accepted first, from its origin on.

    A routed copy names its next hop. Of a flooded one it is not recorded who heard whom first; the
    copy before is taken to be the earliest one that was likely to be heard.
    """
    if crossing.row == NEVER:
        return []
    sent = copies(result, crossing) if sent is None else sent
    here = int(result.delivered[crossing.row]["node"])
    before = crossing.accepted_us
    found: list[Hop] = []
    for length in range(crossing.hops, 0, -1):
        fitting = [
            hop
            for hop in sent
            if hop.path_len == length
            and hop.flooded == crossing.flooded
            and hop.end_us <= before
            and hop.node != here
            and (hop.to == here if hop.to != ALL else _chance(result, hop.node, here) > 0)
        ]
        if not fitting:
            break
        # The last hop ends as the monitor accepts it, and no other; of those before, what was heard
        # first was passed on.
        exact = [hop for hop in fitting if hop.end_us == crossing.accepted_us]
        likely = [hop for hop in fitting if _chance(result, hop.node, here) >= ONE // 2]
        hop = (exact or likely or fitting)[0]
        found.append(hop)
        here, before = hop.node, hop.start_us
    return found[::-1]


def _chance(result: Any, node: int, other: int) -> int:
    """Chance in 1/32768 that a node's frames are received by another; robots: all of them."""
    plan = result.plan
    if plan.robots[node] or plan.robots[other]:
        return ONE
    return int(plan.radio.prob_q15[node * plan.nodes + other])
