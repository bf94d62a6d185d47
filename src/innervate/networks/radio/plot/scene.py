"""A stretch of a radio run as it is drawn, by SVG or matplotlib: boxes, what was heard, marks."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from innervate.dialect.access import REPORT_DELIVERED
from innervate.networks.radio.analysis.air import (
    Air,
    Groups,
    Heard,
    air,
    groups,
    off_times,
    signals,
)
from innervate.networks.radio.analysis.packets import first_offer_us, successes
from innervate.networks.radio.plot.words import FrameWords, frame_words, report_words, turn_words
from innervate.networks.radio.protocol import constants as const
from innervate.scenario.actions.channel import KILL

LANES_MAX = 128
BOXES_MAX = 4000
PACKETS_MAX = 130  # a window chosen here is at most that many packets long, or 3 a station
MARGIN = 0.015
READABLE_SLOTS = 80
ENLARGED = 0.3  # share of a resolution that is shown enlarged
BEFORE = 0.05  # of that, how much of the time before its first frame

NOTICED, DONE, FAILED = "noticed", "done", "failed"
MARKS = {const.REPORT_COLLISION: NOTICED, REPORT_DELIVERED: DONE, const.REPORT_FAILED: FAILED}


class Window(NamedTuple):
    """A stretch of a run: from when to when, and the moment that slots are counted from."""

    from_us: int
    to_us: int
    origin_us: int


@dataclass(frozen=True, slots=True)
class Box:
    """A transmission: lane, place in time, what it is and the labels it may have, longest first."""

    station: int
    start_us: int
    end_us: int
    kind: int
    words: FrameWords
    labels: tuple[str, ...]
    collided: bool
    tip: str


@dataclass(frozen=True, slots=True)
class Note:
    """Something a station reported: NOTICED, DONE or FAILED."""

    station: int
    at_us: int
    kind: str
    tip: str


@dataclass(frozen=True, slots=True)
class Scene:
    """All that is drawn of a stretch of a run."""

    window: Window  # what is shown
    slot_us: int
    stations: tuple[int, ...]  # those that have a lane, in order
    # boxes, notes: in order of time
    boxes: tuple[Box, ...]
    notes: tuple[Note, ...]
    heard: dict[int, Heard]  # by station; intervals cut to the window
    cut: bool  # there was more between the moments that were asked for than can be shown
    off: str = ""  # why stations are off: "switched off", "not in the team", both; "" if none is

    @property
    def frames(self) -> list[FrameWords]:
        """The kinds of frames that appear."""
        found = {box.kind: box.words for box in self.boxes}
        return [found[kind] for kind in sorted(found)]


def resolution(result: Any) -> Window:
    """The first collision and all it took until everybody who waited then was served, or a limit.

    Without a collision: from the first transmission on.
    """
    on_air = air(result)
    found = groups(result, on_air)
    params = result.plan.params
    packet_us = params["packet_slots"] * params["slot_us"] + 2 * params["ta_us"]
    limit = max(PACKETS_MAX, 3 * result.plan.stations) * packet_us
    if len(on_air.start) == 0:
        begin = first_offer_us(result)
        return Window(begin, max(begin + 1, min(begin + limit, result.ended_us)), begin)
    struck = np.flatnonzero(found.collision)
    place = struck[0] if len(struck) else 0
    origin, over = int(found.start[place]), int(found.end[place])
    served = successes(result)
    served = served[(served["end"] > origin) & (served["offered"] <= over)]
    firsts = np.unique(served["node"], return_index=True)[1]
    last = int(served["time"][firsts].max()) if len(firsts) else origin + limit
    last = max(min(last, origin + limit), over)
    edge = max(round(MARGIN * (last - origin)), params["slot_us"])
    return Window(origin - params["ta_us"] - edge, last + edge, origin)


def beginning(result: Any, whole: Window) -> Window | None:
    """The first part of a resolution, up to its first success or an enlargement of 3.3.

    What was before it is shortened, too: a narrow screen would show nothing else. None where the
    whole is short enough to be read.
    """
    length = whole.to_us - whole.from_us
    if length < READABLE_SLOTS * int(result.plan.params["slot_us"]):
        return None
    ends = successes(result)["end"]
    ends = ends[(ends > whole.origin_us) & (ends < whole.to_us)]
    success = 1.03 * (int(ends[0]) - whole.from_us) if len(ends) else length
    to_us = whole.from_us + round(min(success, ENLARGED * length))
    before_us = round(BEFORE * max(0, to_us - whole.origin_us))
    return whole._replace(from_us=max(whole.from_us, whole.origin_us - before_us), to_us=to_us)


def scene(
    result: Any, from_us: int | None = None, to_us: int | None = None, origin_us: int | None = None
) -> Scene:
    """What is drawn of a run between two moments (us of true time); else of its first resolution.

    Slots count from `origin_us`, or the first collision; a window has to end after it begins.
    """
    window = _window(result, from_us, to_us, origin_us)
    on_air = air(result)
    found = groups(result, on_air)
    inside = (on_air.deaf_from < window.to_us) & (on_air.end > window.from_us)
    which = np.flatnonzero(inside)
    cut = len(which) > BOXES_MAX
    if cut:
        window = window._replace(to_us=int(on_air.start[which[BOXES_MAX]]))
        which = which[:BOXES_MAX]
    heard = signals(result, window.from_us, window.to_us, on_air)
    stations = _lanes(result, on_air, which)
    shown = set(stations)
    boxes = _boxes(result, on_air, found, which)
    return Scene(
        window=window,
        slot_us=int(result.plan.params["slot_us"]),
        stations=stations,
        boxes=tuple(box for box in boxes if box.station in shown),
        notes=tuple(note for note in _notes(result, window) if note.station in shown),
        heard={station: heard[station] for station in stations},
        cut=cut or len(stations) < result.plan.stations,
        off=_off_words(result, window, stations),
    )


def _off_words(result: Any, window: Window, stations: tuple[int, ...]) -> str:
    """Why those are off that are between two moments: who left, or is yet to join, did not fail."""
    spans = off_times(result)
    begun = {(int(low), node) for node in stations for low, high in spans[node]
             if low < window.to_us and high > window.from_us}  # fmt: skip
    failed = begun & {(fault.at_us, fault.node) for fault in result.plan.faults
                      if fault.action == KILL}  # fmt: skip
    said = ("switched off" if failed else "", "not in the team" if begun - failed else "")
    return ", or ".join(filter(None, said))


def _window(result: Any, from_us: int | None, to_us: int | None, origin_us: int | None) -> Window:
    chosen = resolution(result)
    low = chosen.from_us if from_us is None else from_us
    high = chosen.to_us if to_us is None else to_us
    if high <= low:
        raise ValueError(f"a window must end after it begins, not at {high} us after {low} us")
    inside = low <= chosen.origin_us < high
    origin = origin_us if origin_us is not None else chosen.origin_us if inside else low
    return Window(low, high, origin)


def _lanes(result: Any, on_air: Air, which: Any) -> tuple[int, ...]:
    """All stations, or if they are too many the first of those that send."""
    n = result.plan.stations
    if n <= LANES_MAX:
        return tuple(range(n))
    nodes, first = np.unique(on_air.node[which], return_index=True)
    return tuple(sorted(nodes[np.argsort(first)][:LANES_MAX].tolist()))


def _boxes(result: Any, on_air: Air, found: Groups, which: Any) -> list[Box]:
    protocol, slot = result.plan.protocol, int(result.plan.params["slot_us"])
    turns = {
        (int(row["node"]), int(row["time"])): (int(row["a"]), int(row["b"]))
        for row in result.rows[result.rows["code"] == const.REPORT_TURN]
    }
    decided = on_air.start - int(result.plan.params["ta_us"])
    boxes = []
    for place in which.tolist():
        node, kind = int(on_air.node[place]), int(on_air.kind[place])
        start, end = int(on_air.start[place]), int(on_air.end[place])
        words = frame_words(protocol, kind)
        labels: tuple[str, ...] = (words.name, words.letter)
        long = (end - start) / slot
        slots = "1 slot" if long == 1 else f"{long:g} slots"
        tip = f"station {node}: {words.name}, {start} to {end} us, {slots}"
        turn = turns.get((node, int(decided[place])))
        if turn is not None and kind == const.DATA:
            labels = (f"{words.name} {turn[0]}", f"{words.letter}{turn[0]}", words.letter)
            tip += f", {turn_words(protocol, *turn)}"
        collided = bool(found.collision[found.of[place]])
        tip += ", collided" if collided else ""
        boxes.append(Box(node, start, end, kind, words, labels, collided, tip))
    return boxes


def _notes(result: Any, window: Window) -> list[Note]:
    rows = result.rows
    inside = (rows["time"] >= window.from_us) & (rows["time"] < window.to_us)
    part = rows[inside & np.isin(rows["code"], list(MARKS))]
    noticed = {
        (int(row["node"]), int(row["time"]))
        for row in part
        if row["code"] == const.REPORT_COLLISION
    }
    notes = []
    for row in part:
        node, at, code = int(row["node"]), int(row["time"]), int(row["code"])
        # A collision says already that its packet failed.
        if code == const.REPORT_FAILED and (node, at) in noticed:
            continue
        words = report_words(result.plan.protocol, code, int(row["a"]), int(row["b"]))
        notes.append(Note(node, at, MARKS[code], f"station {node}: {words}, {at} us"))
    return notes
