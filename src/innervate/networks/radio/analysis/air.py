"""What was on the air of a radio run, and what each station heard of it.

Recomputed from the run's transmissions and pair delays alone, so that it can be drawn for any
moment of any run. Times are us of true time; intervals hold their first moment, not their last.
"""

from typing import Any, Literal, NamedTuple

import numpy as np

from innervate.analysis.ways import Flags as Flags
from innervate.analysis.ways import Numbers as Numbers
from innervate.dialect.access import REPORT_LEFT
from innervate.networks.radio.protocol import constants as const
from innervate.scenario.actions.channel import FADE, GARBLE, JOIN, KILL, LEAVE

# Frames that may carry packets; where one of them overlaps something, there was a collision.
CARRYING = (const.DATA, const.OPEN)
FOREVER = 1 << 62


class Air(NamedTuple):
    """All transmissions in the order of their start: one entry each, as `result.sent` has them."""

    node: Numbers  # who sent
    kind: Numbers  # which frame, see protocol/constants.py
    # start, end: when it was on the air; `end` as it was, if its sender died or stopped then
    start: Numbers
    end: Numbers
    # deaf_from, deaf_to: when its sender's radio could not listen; on a cable never
    deaf_from: Numbers
    deaf_to: Numbers
    faded: Flags  # a fault of the scenario hid it: nobody heard it
    row: Numbers  # its place in `result.sent`


class Groups(NamedTuple):
    """Maximal groups of transmissions that overlap on the air, single ones too."""

    of: Numbers  # the group of every transmission of `air(result)`
    # start, end: of every group
    start: Numbers
    end: Numbers
    members: Numbers  # how many transmissions it has
    collision: Flags  # it has several, at least one of which may carry packets


class Heard(NamedTuple):
    """What one station heard: intervals as rows of (from, to)."""

    cd: Numbers  # at least one other station's signal was there
    voc: Numbers  # exactly one was
    deaf: Numbers  # its radio could not listen, so that it knew neither; not part of `cd` and `voc`
    off: Numbers  # it was switched off


def air(result: Any) -> Air:
    """All transmissions of a run."""
    order = np.argsort(result.sent["time"], kind="stable")
    sent = result.sent[order]
    turnaround = int(result.plan.params["ta_us"])
    node = sent["node"].astype(np.int64)
    start, end = sent["time"].copy(), sent["end"].copy()
    decided, listens = start - turnaround, end + turnaround
    for fault in result.plan.faults:
        if fault.action == KILL:
            stopped = (node == fault.node) & (decided <= fault.at_us) & (fault.at_us < end)
            end[stopped] = np.maximum(start[stopped], fault.at_us)
    if result.plan.params.get("full_duplex"):
        _stop(result.rows, node, start, end)
        listens = decided
    faded = _faded(result.plan.faults, node, sent["kind"], decided)
    return Air(node, sent["kind"].astype(np.int64), start, end, decided, listens, faded, order)


def _stop(rows: Any, node: Numbers, start: Numbers, end: Numbers) -> None:
    """Cut the transmissions that their senders broke off."""
    stops = rows[rows["code"] == const.REPORT_STOPPED]
    if len(stops) == 0:
        return
    cut = _latest(node, start, stops)
    end[cut] = np.minimum(end[cut], stops["time"])


def _faded(faults: Any, node: Numbers, kind: Numbers, decided: Numbers) -> Flags:
    """CR-Rs that faults of the scenario hid; those that were to be garbled are used up first."""
    hidden = np.zeros(len(node), np.bool_)
    spoilers = [fault for fault in faults if fault.action in (GARBLE, FADE)]
    for station in {fault.node for fault in spoilers}:
        mine = [fault for fault in spoilers if fault.node == station]
        left, seen = {GARBLE: 0, FADE: 0}, 0
        for place in np.flatnonzero((node == station) & (kind == const.CRR)).tolist():
            while seen < len(mine) and mine[seen].at_us < decided[place]:
                left[mine[seen].action] = mine[seen].value
                seen += 1
            if left[GARBLE]:
                left[GARBLE] -= 1
            elif left[FADE]:
                left[FADE] -= 1
                hidden[place] = True
    return hidden


def groups(result: Any, on_air: Air | None = None) -> Groups:
    """Which transmissions overlap; touching is not overlapping."""
    found = air(result) if on_air is None else on_air
    if len(found.start) == 0:
        none = np.zeros(0, np.int64)
        return Groups(none, none, none, none, np.zeros(0, np.bool_))
    behind = np.maximum.accumulate(found.end)
    fresh = np.ones(len(found.start), np.bool_)
    fresh[1:] = found.start[1:] >= behind[:-1]
    of = np.cumsum(fresh) - 1
    first = np.flatnonzero(fresh)
    members = np.bincount(of)
    carrying = np.bincount(of, np.isin(found.kind, CARRYING))
    end = np.maximum.reduceat(found.end, first)
    return Groups(of, found.start[first], end, members, (members > 1) & (carrying > 0))


def taken_for_collided(result: Any) -> int:
    """How many transmissions that met no other station's their senders took for collided.

    Mostly since nobody answered: a sender cannot tell that from a collision.
    """
    on_air = air(result)
    told = result.rows[result.rows["code"] == const.REPORT_COLLISION]
    if len(told) == 0 or len(on_air.start) == 0:
        return 0
    sent = np.unique(_latest(on_air.node, on_air.start, told, "left"))  # the next may begin now
    far = max((max(row) for row in result.plan.delays_us), default=0)
    of = groups(result, on_air._replace(end=on_air.end + far)).of  # as long as it may be heard
    first = np.flatnonzero(np.diff(of, prepend=-1))
    least, most = (one.reduceat(on_air.node, first) for one in (np.minimum, np.maximum))
    return int(np.count_nonzero((least == most)[of[sent]]))


def _latest(
    node: Numbers, start: Numbers, rows: Any, side: Literal["left", "right"] = "right"
) -> Numbers:
    """Per row the transmission that its station had begun last, by its place."""
    mine = np.lexsort((start, node))
    key = (node[mine] << 44) | start[mine]
    wanted = (rows["node"].astype(np.int64) << 44) | rows["time"]
    return np.asarray(mine[np.searchsorted(key, wanted, side) - 1])


def off_times(result: Any) -> list[Numbers]:
    """Per station the intervals in which it was switched off, as rows of (from, to)."""
    plan = result.plan
    changes = [
        (fault.at_us, place, fault.node, fault.action == JOIN)
        for place, fault in enumerate(plan.faults)
        if fault.action in (JOIN, KILL)
    ]
    changes += _left(result)
    since: list[int | None] = [0 if absent else None for absent in plan.absent]
    since += [None] * (plan.stations - len(since))
    found: list[list[tuple[int, int]]] = [[] for _ in range(plan.stations)]
    for at_us, _, node, on in sorted(changes):
        begun = since[node]
        if on and begun is not None:
            found[node].append((begun, at_us))
            since[node] = None
        elif not on and begun is None:
            since[node] = at_us
    for node, begun in enumerate(since):
        if begun is not None:
            found[node].append((begun, FOREVER))
    return [np.array(spans, np.int64).reshape(-1, 2) for spans in found]


def _left(result: Any) -> list[tuple[int, int, int, bool]]:
    """Robots that left: when, in which place among the plan's events, who.

    At the moment of the event that had it leave where nothing kept it, else behind all of them.
    """
    told: dict[tuple[int, int], list[int]] = {}
    for place, fault in enumerate(result.plan.faults):
        if fault.action == LEAVE:
            told.setdefault((fault.at_us, fault.node), []).append(place)
    found = []
    for row in result.rows[result.rows["code"] == REPORT_LEFT]:
        at_us, node = int(row["time"]), int(row["node"])
        places = told.get((at_us, node))
        found.append((at_us, places.pop(0) if places else len(result.plan.faults), node, False))
    return found


def signals(result: Any, from_us: int, to_us: int, on_air: Air | None = None) -> list[Heard]:
    """What every station heard between two moments.

    At a moment at which several signals begin and end, what counts is what is there afterwards.
    """
    found = air(result) if on_air is None else on_air
    far = max((max(row) for row in result.plan.delays_us), default=0)
    near = (found.deaf_from < to_us) & (np.maximum(found.end + far, found.deaf_to) > from_us)
    columns: Any = (column[near] for column in found)
    part = Air(*columns)
    delays = np.array(result.plan.delays_us, np.int64)
    off = off_times(result)
    return [
        _heard(part, delays[:, station], station, off[station], from_us, to_us)
        for station in range(result.plan.stations)
    ]


def _heard(
    part: Air, delays: Numbers, station: int, off: Numbers, from_us: int, to_us: int
) -> Heard:
    """One station's share of `signals`."""
    delay = delays[part.node]
    own = part.node == station
    there = ~own & (delay >= 0) & ~part.faded & (part.end > part.start)
    sent = np.stack([part.start + delay, part.end + delay], axis=1)[there]
    deaf = np.stack([part.deaf_from, part.deaf_to], axis=1)[own]
    shut = np.concatenate([deaf, off])
    times = np.unique(np.concatenate([sent.ravel(), shut.ravel(), [from_us, to_us]]))
    listens = _count(times, shut) == 0
    present = _count(times, sent)
    return Heard(
        *(
            _intervals(times, state, from_us, to_us)
            for state in (
                (present > 0) & listens,
                (present == 1) & listens,
                _count(times, deaf) > 0,
                _count(times, off) > 0,
            )
        )
    )


def _count(times: Numbers, spans: Numbers) -> Numbers:
    """How many of the spans hold each moment."""
    begun = np.searchsorted(np.sort(spans[:, 0]), times, "right")
    ended = np.searchsorted(np.sort(spans[:, 1]), times, "right")
    return begun - ended


def _intervals(times: Numbers, state: Flags, from_us: int, to_us: int) -> Numbers:
    """Where a step function is true, within from_us <= t < to_us."""
    inside = state & (times >= from_us) & (times < to_us)
    turned = np.diff(inside.astype(np.int8), prepend=0, append=0)
    first = times[np.flatnonzero(turned == 1)]
    last = np.flatnonzero(turned == -1)
    return np.stack([first, times[np.minimum(last, len(times) - 1)]], axis=1)
