"""A run as a capture: simulated again, with every frame written as it leaves and comes in."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

import innervate
from innervate.export import cabled, files, pcapng
from innervate.export.errors import ExportError
from innervate.network import networks
from innervate.sim import taps

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
    """What a capture holds, once it is written."""

    frames: int  # how many packets
    sent: int  # frames that left, or were lost at their sender
    received: int  # frames that came in
    dropped: dict[str, int]  # how many, by reason
    result: Any  # of the simulation


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
    captured = captured_of(plan)
    why = captured.refusal(plan)
    if why:
        raise ExportError(why)
    with files.whole(path) as file:
        stream = _Stream(plan, file, window_us or (0, plan.duration_us))
        result = captured.simulate(plan, tap=stream.take, progress=progress)
        if result.interrupted:
            raise KeyboardInterrupt
        if fingerprint and fingerprint != result.fingerprint:
            raise ExportError(
                "this version simulates the scenario in another way than when it was run; "
                "run it again and export that"
            )
        stream.flush(1 << 62)
    return Written(stream.frames, stream.sent, stream.received, stream.dropped, result)


def captured_of(plan: Any) -> Any:
    """What the plan's network says of captures, or what any network of cables does."""
    network = networks()[plan.kind]
    return network.capture if network.has("capture") else cabled.Captured(network)


class _Stream:
    """Puts frames in order of time and writes them."""

    def __init__(self, plan: Any, file: BinaryIO, window_us: tuple[int, int]) -> None:
        self.captured = captured_of(plan)
        self.file = file
        self.window_us = window_us
        self.frames = self.sent = self.received = 0
        self.dropped: dict[str, int] = {}
        self.rows: list[Any] = []
        self.kept: list[Any] = []
        self.number = self.captured.numbers(plan)
        comment = f"innervate {plan.kind} {plan.scenario.name}, seed {plan.seed}, simulated"
        file.write(pcapng.section(comment, f"innervate {innervate.__version__}"))
        link_type = networks()[plan.kind].link_type
        for name, text in self.captured.interfaces(plan):
            file.write(pcapng.interface(link_type, name, text))

    def take(self, rows: Any, frames: Any, now: int) -> None:
        """What a simulation hands over."""
        first, last = self.window_us
        inside = (rows["time"] >= first) & (rows["time"] < last)
        self.rows.append(rows[inside])
        self.kept.append(frames[inside])
        self.flush(now - self.captured.LATE_US)

    def flush(self, until: int) -> None:
        """Write what happened before a time, us; nothing of before will come any more."""
        rows, frames = np.concatenate(self.rows), np.concatenate(self.kept)
        order = np.argsort(rows["time"], kind="stable")
        count = int(np.searchsorted(rows["time"][order], until))
        self.rows, self.kept = [rows[order[count:]]], [frames[order[count:]]]
        if count:
            self._write(rows[order[:count]], frames[order[:count]])

    def _write(self, rows: Any, frames: Any) -> None:
        made = self.captured.frames(rows, frames)
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
