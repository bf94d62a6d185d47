"""How a mesh came to know itself: discovery rounds, tables, gateways; what it cost on the air."""

from typing import Any

import numpy as np

from innervate.analysis.ways import Numbers
from innervate.networks.mesh.analysis.messages import NEVER, newest_before
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.analysis.summary_keys import Airtime, Discovery, Gateway, Suspects
from innervate.networks.mesh.protocol import constants as const
from innervate.scenario.actions.field import KILL, RESTART

FINDING = (const.REQUEST, const.RESPONSE)
TABLING = (const.TABLE, const.TABLE_ACK, const.ACTIVATE, const.GRAPH)
CONTROL = (*FINDING, *TABLING)
# What airtime is spent on; an ack of a hop belongs to the packet that it acknowledges.
USES = {
    "discovery": FINDING,
    "tables": TABLING,
    "messages": (const.DATA, const.E2E_ACK),
    "alarms": (const.ALARM,),
    "beacons": (const.POSITION,),
}


def acked_kinds(sent: Any) -> Numbers:
    """Per transmission its type; of an ack the type of the packet that it acknowledges.

    An ack names its packet by origin and number; one of nothing that was sent stays an ACK.
    """
    kinds: Numbers = sent["kind"].astype(np.int64)
    name = sent["origin"].astype(np.int64) << 16 | sent["seq"]
    packets, acks = np.flatnonzero(kinds != const.ACK), np.flatnonzero(kinds == const.ACK)
    last = newest_before(name[packets], sent["end"][packets], name[acks], sent["time"][acks])
    known = last != NEVER
    kinds[acks[known]] = kinds[packets[last[known]]]
    return kinds


def airtime_us(sent: Any) -> Numbers:
    """How long each transmission was on the air."""
    found: Numbers = sent["end"] - sent["time"]
    return found


def discovery(result: Any, kinds: Numbers) -> Discovery:
    """The summary's part on the first discovery round; `kinds` as acked_kinds() has them."""
    rows = result.rows
    begun = rows["time"][rows["code"] == const.REPORT_ROUND]
    if len(begun) == 0:
        return {
            "recall": None, "complete_s": None, "tables_s": None, "airtime_s": None,
            "rounds": None, "responses_s": None, "tables_airtime_s": None, "with_tables": None,
        }  # fmt: skip
    first, ended = int(begun[0]), int(begun[1]) if len(begun) > 1 else result.ended_us
    graphs = rows["time"][rows["code"] == const.REPORT_GRAPH]
    sent, spent = result.sent, airtime_us(result.sent)
    round_ = (sent["time"] >= first) & (sent["time"] < ended)
    answers = sent["end"][round_ & (sent["kind"] == const.RESPONSE) & (sent["receivers"] > 0)]
    collected = int(graphs[0]) if len(graphs) else None
    in_time = answers[answers <= collected] if collected is not None else answers
    known = result.rounds[:1]
    tabled, done_us = tables(result, first)
    return {
        "recall": float(known["both"][0] / known["good"][0])
        if len(known) and known["good"][0]
        else None,
        "complete_s": (collected - first) / 1e6 if collected is not None else None,
        "tables_s": (done_us - first) / 1e6 if done_us is not None else None,
        "airtime_s": float(spent[round_ & np.isin(kinds, FINDING)].sum() / 1e6),
        "rounds": len(begun),
        "responses_s": (int(in_time.max()) - first) / 1e6 if len(in_time) else None,
        "tables_airtime_s": float(spent[round_ & np.isin(kinds, TABLING)].sum() / 1e6),
        "with_tables": tabled,
    }


def tables(result: Any, since_us: int) -> tuple[int | None, int | None]:
    """(nodes that got a whole table from a time on, when the last of them did).

    The second is None if one that was on all the time never got one; both without tables.
    """
    plan, rows = result.plan, result.rows
    if plan.params["mode"] == const.TABLE_FREE:
        return None, None
    made = rows[(rows["code"] == const.REPORT_TABLE) & (rows["time"] >= since_us)]
    nodes, first = np.unique(made["node"], return_index=True)
    leads = set(rows["node"][rows["code"] == const.REPORT_ROUND].tolist())
    off = {fault.node for fault in plan.faults if fault.action in (KILL, RESTART)}
    off |= {node for node in range(plan.nodes) if plan.absent[node]}
    missing = set(range(plan.nodes)) - set(nodes.tolist()) - off - leads
    if missing or not len(nodes):
        return len(nodes), None
    return len(nodes), int(made["time"][first].max())


def gateways(result: Any) -> list[Gateway]:
    """Who became gateway, when; how long later the last node that was on had tables of it."""
    rows = result.rows
    led = rows[(rows["code"] == const.REPORT_GATEWAY) & (rows["a"] == rows["node"])]
    made = rows[rows["code"] == const.REPORT_TABLE]
    ground = Ground(result.plan)
    found: list[Gateway] = []
    for row in led:
        at, epoch = int(row["time"]), int(row["b"])
        on = np.array(ground.on_at(at), np.bool_)
        mine = made[(made["b"] == epoch) & (made["time"] >= at) & on[made["node"]]]
        on[row["node"]] = False
        nodes, first = np.unique(mine["node"], return_index=True)
        served = len(nodes) and set(np.flatnonzero(on).tolist()) <= set(nodes.tolist())
        found.append({
            "node": int(row["node"]),
            "at_s": at / 1e6,
            "epoch": epoch,
            "tables_s": (int(mine["time"][first].max()) - at) / 1e6 if served else None,
        })  # fmt: skip
    return found


def takeover_s(result: Any, led: list[Gateway]) -> float | None:
    """From the first death of a gateway to complete tables of its successor; None without."""
    return next(iter(takeovers(result.plan.faults, led).values()), None)


def takeovers(faults: Any, led: list[Gateway]) -> dict[int, float]:
    """Per successor of a gateway that died, by its place in `led`: from the death to its tables.

    In the order of deaths; without successors whose tables never were everywhere.
    """
    found: dict[int, float] = {}
    for fault in faults:
        then = sum(gateway["at_s"] * 1e6 <= fault.at_us for gateway in led)
        leading = then and led[then - 1]["node"] == fault.node
        if fault.action == KILL and leading and then < len(led) and then not in found:
            at_s, tables_s = led[then]["at_s"], led[then]["tables_s"]
            if tables_s is not None:
                found[then] = float(at_s + tables_s - fault.at_us / 1e6)
    return found


def airtime(result: Any, kinds: Numbers) -> Airtime:
    """Seconds on the air by use, and the busiest node's share of the run."""
    sent, spent = result.sent, airtime_us(result.sent)
    used = {use: float(spent[np.isin(kinds, members)].sum() / 1e6) for use, members in USES.items()}
    each = np.bincount(sent["node"], spent, result.plan.nodes)
    return {
        "discovery_s": used["discovery"],
        "tables_s": used["tables"],
        "messages_s": used["messages"],
        "alarms_s": used["alarms"],
        "beacons_s": used["beacons"],
        "busiest": int(each.argmax()),
        "busiest_share": float(each.max() / result.ended_us),
    }


def control_bytes(result: Any, kinds: Numbers) -> int:
    """Bytes of discovery and tables on the air, acks of hops included, without PHY bytes."""
    return int(result.sent["bytes"][np.isin(kinds, CONTROL)].sum())


def suspects(result: Any) -> Suspects:
    """How often nodes gave up on a neighbour; `wrong`: one that was switched on."""
    rows = result.rows[result.rows["code"] == const.REPORT_SUSPECT]
    ground = Ground(result.plan)
    wrong = 0
    for low, high in zip(ground.times, [*ground.times[1:], 1 << 62], strict=True):
        on = np.array(ground.on_at(low), np.bool_)
        part = rows[(rows["time"] >= low) & (rows["time"] < high)]
        wrong += int(np.count_nonzero(on[part["a"]]))
    return {"raised": len(rows), "wrong": wrong}
