"""A run as a capture: simulated again, with every frame written as it leaves and comes in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

import innervate
from innervate.export import bulk, files, links, pcapng
from innervate.export.errors import ExportError
from innervate.sim import taps

# A row may be told so much later than the moment it is of, us: a mesh on a channel that all share
# tells of a frame when all have heard its end.
LATE_US = {"skin": 0, "radio": 0, "mesh": 2_000_000}
WORDS = {
    taps.CUT: "cable cut",
    taps.NOISE: "noise",
    taps.OFF: "switched off",
    taps.QUEUE: "queue full",
    taps.BROKEN: "port found broken",
    taps.COLLISION: "collision, or not heard from its start",
    taps.SENDING: "receiver was sending",
    taps.SPOILT: "broken off or garbled",
}
DROPPED = "dropped: "
UNREADABLE = (taps.NOISE, taps.COLLISION, taps.SPOILT)

Progress = Callable[[int, int], None]


@dataclass
class Written:
    """What a capture holds.

    Attributes:
        frames: how many packets.
        sent: frames that left, or were lost at their sender.
        received: frames that came in.
        dropped: how many, by reason.
        result: of the simulation.
    """

    frames: int
    sent: int
    received: int
    dropped: dict[str, int]
    result: Any


def write(
    plan: Any,
    path: Path,
    *,
    window_us: tuple[int, int] | None = None,
    fingerprint: str = "",
    progress: Progress | None = None,
) -> Written:
    """Simulate a plan and write all frames of a window of time to a capture, in order of time.

    Args:
        plan: what `scenario` made of a file.
        path: the file; there whole or not at all.
        window_us: from the first moment to before the second, simulated time; None = all.
        fingerprint: what the run must have, if it was run before.
        progress: called now and then with (time_us, duration_us).

    Raises:
        ExportError: the plan has no frames, the file cannot be written, or the simulation is not
            the run that it should be.
        InvariantBroken: a checker found what must not happen.
    """
    if getattr(plan, "script", ()):
        raise ExportError("a scenario with a script has no clock and no capture; remove [script]")
    simulate = simulator(plan)
    with files.whole(path) as file:
        stream = _Stream(plan, file, window_us or (0, plan.duration_us))
        result = simulate(plan, tap=stream.take, progress=progress)
        if result.interrupted:
            raise KeyboardInterrupt
        if fingerprint and fingerprint != result.fingerprint:
            raise ExportError(
                "this version simulates the scenario in another way than when it was run; "
                "run it again and export that"
            )
        stream.flush(1 << 62)
    return Written(stream.frames, stream.sent, stream.received, stream.dropped, result)


def simulator(plan: Any) -> Callable[..., Any]:
    """The function that simulates plans of this kind.

    Raises:
        ExportError: there are no frames in its simulation.
    """
    if plan.kind == "radio" and plan.scenario.model.channel.level == "slotted":
        raise ExportError('the slotted level has no frames; set channel.level = "event"')
    room = "innervate.sim" if plan.kind == "skin" else f"innervate.sim.{plan.kind}"
    found: Callable[..., Any] = import_module(f"{room}.simulate").simulate
    return found


def interfaces(plan: Any) -> list[links.Interface]:
    """One for every cabled port of a skin, every node, every station."""
    link_type = links.LINK_TYPES[plan.kind]
    if plan.kind == "mesh":
        found = [(name, links.describe("node", i)) for i, name in enumerate(plan.names)]
    elif plan.kind == "radio":
        found = [(f"station {i}", links.describe("station", i)) for i in range(plan.stations)]
    else:
        found = [_port(plan.graph, end) for end in cabled(plan.graph)]
    return [links.Interface(link_type, name, text) for name, text in found]


def cabled(graph: Any) -> list[int]:
    """Ends that have a cable."""
    return [end for end, peer in enumerate(graph.peer) if peer >= 0]


def _port(graph: Any, end: int) -> tuple[str, str]:
    node, port = graph.node_of(end), graph.port_of(end)
    cable = (graph.label_end(end), graph.label_end(graph.peer[end]))
    is_pc = node == graph.cells
    return cable[0], links.describe("pc" if is_pc else "cell", -1 if is_pc else node, port, cable)


class _Stream:
    """Puts frames in order of time and writes them."""

    def __init__(self, plan: Any, file: BinaryIO, window_us: tuple[int, int]) -> None:
        self.kind = plan.kind
        self.file = file
        self.window_us = window_us
        self.late_us = LATE_US[plan.kind]
        self.frames = self.sent = self.received = 0
        self.dropped: dict[str, int] = {}
        self.rows: list[Any] = []
        self.kept: list[Any] = []
        self.number = np.arange(_places(plan))
        if plan.kind == "skin":
            self.number = np.zeros(_places(plan), np.int64)
            self.number[cabled(plan.graph)] = np.arange(len(cabled(plan.graph)))
        comment = f"innervate {plan.kind} {plan.scenario.name}, seed {plan.seed}, simulated"
        file.write(pcapng.section(comment, f"innervate {innervate.__version__}"))
        for one in interfaces(plan):
            file.write(pcapng.interface(*one))

    def take(self, rows: Any, frames: Any, now: int) -> None:
        """What a simulation hands over."""
        first, last = self.window_us
        inside = (rows["time"] >= first) & (rows["time"] < last)
        self.rows.append(rows[inside])
        self.kept.append(frames[inside])
        self.flush(now - self.late_us)

    def flush(self, until: int) -> None:
        """Write what happened before a time, us; nothing of before will come any more."""
        rows, frames = np.concatenate(self.rows), np.concatenate(self.kept)
        order = np.argsort(rows["time"], kind="stable")
        count = int(np.searchsorted(rows["time"][order], until))
        self.rows, self.kept = [rows[order[count:]]], [frames[order[count:]]]
        if count:
            self._write(rows[order[:count]], frames[order[:count]])

    def _write(self, rows: Any, frames: Any) -> None:
        made = {
            "skin": lambda: bulk.skin_frames(frames),
            "mesh": lambda: bulk.mesh_frames(rows, frames),
            "radio": lambda: bulk.radio_frames(frames),
        }[self.kind]()
        numbers = self.number[rows["at"]].tolist()
        flags = np.where(rows["out"] == 1, pcapng.OUTBOUND, pcapng.INBOUND)
        unreadable = (rows["out"] == 0) & np.isin(rows["why"], UNREADABLE)
        flags = np.where(unreadable, flags | pcapng.CRC_ERROR, flags).tolist()
        comments = [b"", *((DROPPED + WORDS[why]).encode() for why in sorted(WORDS))]
        columns = (numbers, (rows["time"] * 1000).tolist(), made, flags, rows["why"].tolist())
        packet = pcapng.packet
        self.file.write(b"".join(
            packet(number, time_ns, data, flag, comments[why])
            for number, time_ns, data, flag, why in zip(*columns, strict=True)
        ))  # fmt: skip
        self._count(rows)

    def _count(self, rows: Any) -> None:
        self.frames += len(rows)
        self.sent += int((rows["out"] == 1).sum())
        self.received += int(((rows["out"] == 0) & (rows["why"] == taps.FINE)).sum())
        for why, word in WORDS.items():
            lost = int((rows["why"] == why).sum())
            if lost:
                self.dropped[word] = self.dropped.get(word, 0) + lost


def _places(plan: Any) -> int:
    """How many interfaces rows can be of."""
    if plan.kind == "skin":
        return len(plan.graph.peer)
    return int(plan.nodes if plan.kind == "mesh" else plan.stations)
