"""The summary of any network's run: frames, messages, losses by reason, latencies, a headline.

A network that knows more of its runs has a summary of its own.
"""

from collections.abc import Mapping
from typing import Any, TypedDict

import numpy as np

from innervate.analysis import headline as level
from innervate.analysis.headline import Headline, every, verb
from innervate.analysis.percentiles import usual
from innervate.analysis.summary_common import Common, Percentiles, measured
from innervate.folders import blamed
from innervate.kernel.words import number_of
from innervate.network import NetworkError, networks
from innervate.scenario.declared.shared import script_of
from innervate.sim.counts import Counts

# Counted by reason or number: what is not named there has not happened.
COUNTED = ("frames.lost_by", "messages.dropped_by", "reports")


class Frames(TypedDict):
    """Frames on their links; one counts once for every link that it takes.

    On the air it counts as a reception, once for each node that could hear it.

    Attributes:
        sent: handed to a link.
        arrived: reached a node that is on.
        lost: by all reasons.
        lost_by: by reason.
        in_flight: on their way at the end.
    """

    sent: int
    arrived: int
    lost: int
    lost_by: Mapping[str, int]
    in_flight: int


class Messages(TypedDict):
    """What users gave to the network, and what it gave to users.

    Attributes:
        sent: given to nodes by their users.
        delivered: given to users by nodes; more than sent if one is for many.
        dropped_by: given up by nodes, by reason.
        latency_ms: from the one to the other; None if none were delivered or no rows were kept.
    """

    sent: int
    delivered: int
    dropped_by: Mapping[str, int]
    latency_ms: Percentiles


class Reports(TypedDict, total=False):
    """What was reported; nothing where that was not kept.

    Attributes:
        reports: how often nodes reported something, by its number.
        measures: a network's own figures, by their names, which end in a unit.
    """

    reports: dict[str, int]
    measures: dict[str, float | None]


class Summary(Common, Reports):
    """Of a run of any network.

    Attributes:
        kind: of network.
        nodes: how many there are.
        off: how many of them were off at the end.
        frames: on the links.
        messages: of users.
    """

    kind: str
    nodes: int
    off: int
    frames: Frames
    messages: Messages


def summarize(result: Any) -> Summary:
    """The summary of a run; what never happened is None."""
    plan, counts = result.plan, result.counts
    return {
        "kind": plan.kind,
        "name": plan.scenario.name,
        **measured(result, result.handled + counts.arrived),
        "headline": _headline(result).as_summary(),
        "nodes": counts.nodes,
        "off": len(counts.off),
        "frames": {
            "sent": counts.sent,
            "arrived": counts.arrived,
            "lost": sum(counts.lost_by.values()),
            "lost_by": counts.lost_by,
            "in_flight": counts.in_flight,
        },
        "messages": {
            "sent": counts.offered,
            "delivered": counts.delivered,
            "dropped_by": counts.dropped_by,
            "latency_ms": latency_ms(result.rows.get("deliveries")),
        },
        **_reports(result.rows),
        **_measures(result),
    }


def _headline(result: Any) -> Headline:
    """Of a run, or of a script, which ends in the middle of what it shows."""
    script = script_of(result.plan)
    if script is None:
        return headline(result.counts, result.handled)
    return Headline(
        level.OK, f"nothing broke in {number_of(len(script.steps), 'step')} of its script."
    )


def _measures(result: Any) -> Reports:
    """The figures that a network has of its own."""
    network = networks()[result.plan.kind]
    if not network.has("measures"):
        return {}
    states, off = nodes_of(result), set(result.counts.off)
    on = [node for node in range(result.counts.nodes) if node not in off]
    nodes = [states[node] for node in on] if isinstance(states, list) else states[on]
    rows, deliveries = (result.rows.get(name, ()) for name in ("rows", "deliveries"))
    try:
        found = network.measures(nodes, rows, deliveries, result.plan)
    except Exception as error:
        words = network.folder and blamed(error, network.folder)
        if not words:
            raise
        raise NetworkError(words) from None
    return {"measures": {name: _plain(value) for name, value in found.items()}}


def states_of(world: Any) -> Any:
    """The nodes' states of a simulation, their fields as attributes, compiled or plain."""
    states = world.cells if hasattr(world, "cells") else world.stations
    return states if isinstance(states, list) else states.view(np.recarray)


def nodes_of(result: Any) -> Any:
    """The states of a simulation's nodes, whatever its medium, by their numbers from 0."""
    return states_of(result.world)[: result.counts.nodes]


def _plain(value: Any) -> float | None:
    """A number as JSON has it."""
    if value is None:
        return None
    return int(value) if isinstance(value, int | np.integer) else float(value)


def _reports(rows: Mapping[str, Any]) -> Reports:
    """How often nodes reported something, if that was kept."""
    if "rows" not in rows:
        return {}
    codes, times = np.unique(rows["rows"]["code"], return_counts=True)
    found = zip(codes.tolist(), times.tolist(), strict=True)
    return {"reports": {str(code): count for code, count in found}}


def known_latencies_us(deliveries: Any) -> Any:
    """Latencies of what users handed in, us; rows of what nobody did say -1."""
    if deliveries is None or "latency" not in (deliveries.dtype.names or ()):
        return np.zeros(0)
    return deliveries["latency"][deliveries["latency"] >= 0]


def latency_ms(deliveries: Any) -> Percentiles:
    """Median, 99th percentile and maximum of deliveries' latencies, ms."""
    return usual(known_latencies_us(deliveries) / 1e3, nearest=True)


def headline(counts: Counts, handled: int, goes_on: bool = False) -> Headline:
    """The state of any network, from what its medium counted.

    degraded: frames were lost, messages were given up or not delivered, or a node is off. down: all
    nodes are off, or of all frames, or of all messages, none came. no data: nothing has happened
    yet, or nobody said anything.
    A message may be for many: where more are delivered than were given, nobody knows of whom some
    are missing. On the air receptions that are lost make nothing worse if no message is missing.

    Args:
        counts: of the medium.
        handled: handler calls.
        goes_on: messages that are not delivered may still come.
    """
    if not handled and not counts.offered:
        return level.BEFORE_ALL
    nodes, off = counts.nodes, counts.off
    lost, dropped = sum(counts.lost_by.values()), sum(counts.dropped_by.values())
    if nodes and len(off) == nodes:
        who = every(nodes, "node").capitalize()
        return Headline(level.DOWN, f"{who} {verb(nodes, 'is')} off.", off)
    if lost and not counts.arrived:
        how = ("succeeded", "failed") if counts.is_shared else ("arrived", "did not arrive")
        return _down(_none(counts.sent, _frame(counts), *how), counts)
    unheard = max(counts.offered - counts.delivered, counts.unheard)
    missing = 0 if goes_on else max(unheard - dropped, 0)
    if (dropped or missing) and not counts.delivered:
        said = _none(counts.offered, "message", "was delivered", "was not delivered")
        return _down(said, counts)
    if not (counts.sent or counts.offered or off):
        return Headline(level.NO_DATA, "No frame was sent.")
    failed = 0 if _is_spared(counts, missing + dropped) else lost
    wrong = [
        _part(dropped, counts.offered, "message", "given up"),
        _part(missing, counts.offered, "message", "not delivered"),
        _part(len(off), nodes, "node", "off"),
        _part(failed, counts.sent, _frame(counts), "lost"),
    ]
    said = ", ".join(filter(None, wrong))
    return Headline(level.DEGRADED, f"{said}.", off) if said else Headline(level.OK, _well(counts))


def _down(said: str, counts: Counts) -> Headline:
    """That nothing came, and who is off."""
    off = _part(len(counts.off), counts.nodes, "node", "off")
    return Headline(level.DOWN, f"{', '.join(filter(None, (said, off)))}.", counts.off)


def _frame(counts: Counts) -> str:
    """What frames are counted by."""
    return "reception" if counts.is_shared else "frame"


def _is_spared(counts: Counts, missing: int) -> bool:
    """Receptions that are lost on the air are nobody's loss where every message is there."""
    return counts.is_shared and not missing and 0 < counts.delivered <= counts.offered


def _well(counts: Counts) -> str:
    lost, what = sum(counts.lost_by.values()), _frame(counts)
    kept = f"no {what} is lost." if counts.sent < 2 else f"none of {counts.sent:,} {what}s is lost."
    if lost:
        kept = f"{_part(lost, counts.sent, what, 'lost')}."
    if counts.delivered > counts.offered > 0 and not counts.unheard:
        many = f"{number_of(counts.offered, 'message')} {verb(counts.offered, 'is')}"
        return f"{many} {times_words(counts)}, {kept}"
    under_way = max(counts.offered - counts.delivered, counts.unheard)
    if under_way > 0:
        return f"{_part(under_way, counts.offered, 'message', 'under way')}, {kept}"
    if counts.offered:
        what = every(counts.offered, "message").capitalize()
        return f"{what} {verb(counts.offered, 'is')} delivered once, {kept}"
    return kept.capitalize()


def times_words(counts: Counts) -> str:
    """How often messages were delivered; told is also what cannot be without repetitions."""
    said = f"delivered {counts.delivered:,} times"
    if counts.delivered > (counts.offered - counts.unheard) * counts.nodes > 0:
        said += f", more often than once at each of {number_of(counts.nodes, 'node')}"
    return said


def _none(count: int, what: str, did: str, did_not: str) -> str:
    """That not one of them did something, or that the only one did not."""
    return f"None of {count:,} {what}s {did}" if count > 1 else f"The only {what} {did_not}"


def _part(count: int, total: int, what: str, how: str) -> str:
    if not count:
        return ""
    return f"{count:,} of {total:,} {what}s {verb(count, 'is')} {how}"
