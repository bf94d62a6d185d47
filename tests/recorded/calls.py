"""A million calls of each protocol: what nodes are told, and what plain Python makes of it.

`python -m tests.recorded.calls [--only skin]` simulates and draws, plays all calls in plain Python
and writes `calls/*.xz` (what is told) and `calls/*.json` (hashes over state and outbox after every
call); `--check` plays what is kept, and says what differs. Six minutes of processor time, four of
them for the mesh. C then plays all of it in seconds (tests/boards/test_million.py).
"""

from __future__ import annotations

import argparse
import hashlib
import io
import json
import lzma
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from boards.firmware.__main__ import replay
from boards.firmware.drawn import LIFE, Drawn, lives
from boards.firmware.native import Native
from boards.firmware.play import Player
from boards.firmware.script import Script
from boards.roles import roles
from innervate.firmware.emit import Library

FOLDER = Path(__file__).resolve().parent / "calls"
BOARDS = Path(__file__).resolve().parents[2] / "boards/firmware"
NAMES = ("skin", "csma", "radio", "mesh")
REPLAYED, DRAWN = 100_000, 900_000
EVERY = 2_500  # calls of a simulation from one hash to the next
PIECE = 10 * LIFE  # drawn calls under one hash
GENERATOR = ("script.py", "play.py", "marks.py")  # what calls and hashes are made by


class Run(NamedTuple):
    """A simulation.

    Attributes:
        size: bytes of its part of the script.
        calls: of all its nodes.
        marks: hashes, after every so many calls and at its end.
    """

    size: int
    calls: int
    marks: list[str]


class Record(NamedTuple):
    """What is kept of a protocol.

    Attributes:
        sources: a hash of all that has a part in it.
        kept: bytes of the script's part that drawn calls are made of; the simulations follow.
        runs: the simulations.
        drawn: a hash for every PIECE of the drawn calls.
    """

    sources: str
    kept: int
    runs: list[Run]
    drawn: list[str]


@cache
def library(name: str) -> Library:
    """A protocol as C."""
    return Library(roles()[name], {})


def sources(made: Library, told: bytes) -> str:
    """A hash of what has a part in a record: functions, fields, constants, and what is told."""
    hashed = hashlib.blake2b(f"{made.digest()} {sorted(made.constants.items())}".encode())
    for name in GENERATOR:
        hashed.update((BOARDS / name).read_bytes())
    hashed.update(told)
    return hashed.hexdigest()[:16]


def told(name: str) -> bytes:
    """What is kept of what nodes are told: records to draw from, then simulations."""
    return lzma.decompress((FOLDER / f"{name}.xz").read_bytes())


def kept(name: str) -> Record:
    """What is kept of what comes of it."""
    found: dict[str, Any] = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    runs = [Run(run[0], run[1], run[2].split()) for run in found["runs"]]
    return Record(found["sources"], found["kept"], runs, found["drawn"])


def pieces(first: int, count: int) -> bytes:
    """The script of some pieces of drawn calls."""
    file = io.BytesIO()
    for piece in range(first, first + count):
        script = Script(file)
        script.begin()
        lives(script, 1 + piece * (PIECE // LIFE), PIECE)
        script.say()
    return file.getvalue()


def hexadecimal(marks: list[int]) -> list[str]:
    """Hashes as they are kept."""
    return [f"{mark:08x}" for mark in marks]


def measure(name: str) -> tuple[Record, bytes]:
    """Simulate, draw, and play everything in plain Python; the record and what is told."""
    made = library(name)
    with tempfile.TemporaryDirectory() as folder:
        native, runs = Native(made, Path(folder)), io.BytesIO()
        native.script = Script(runs, EVERY)
        _, heard = replay(native, REPLAYED, 1)
    head = io.BytesIO()
    Drawn(made, heard, 1).keep(Script(head))
    everything = head.getvalue() + runs.getvalue()
    played = [Run(size, calls, marks) for size, calls, marks in _runs(made, runs.getvalue())]
    drawn = _drawn(made, head.getvalue(), 0, DRAWN // PIECE)
    return Record(sources(made, everything), len(head.getvalue()), played, drawn), everything


def _runs(made: Library, script: bytes) -> list[tuple[int, int, list[str]]]:
    """Simulations in plain Python, one after the other."""
    found = []
    for part in Player(made).parts(script):
        player = Player(made)
        marks = hexadecimal(list(player.play(part)))
        found.append((len(part), player.calls, marks))
    return found


def _drawn(made: Library, head: bytes, first: int, count: int) -> list[str]:
    """Hashes of pieces of drawn calls in plain Python."""
    player = Player(made)
    assert not list(player.play(head))
    return hexadecimal(list(player.play(pieces(first, count))))


def in_python(name: str, runs: int, marks: int, first: int, count: int) -> list[str]:
    """What differs when plain Python plays some of it; one line each.

    Args:
        name: of the protocol.
        runs, marks: how many simulations, each up to which of its hashes; 0 = to its end.
        first, count: which pieces of the drawn calls.
    """
    record, script, made = kept(name), told(name), library(name)
    at, lost = record.kept, []
    for number, run in enumerate(record.runs[:runs]):
        play, wanted = Player(made).play(script[at : at + run.size]), run.marks[: marks or None]
        found = hexadecimal([mark for mark, _ in zip(play, wanted, strict=False)])
        at += run.size
        if found != wanted:
            lost.append(f"{name}: simulation {number}: {wanted} was, {found} is")
    found = _drawn(made, script[: record.kept], first, count)
    for i, (was, is_now) in enumerate(zip(record.drawn[first:], found, strict=False)):
        if was != is_now:
            lost.append(
                f"{name}: drawn calls from {(first + i) * PIECE} on: {was} was, {is_now} is"
            )
    return lost


def write(name: str, record: Record, script: bytes) -> None:
    """Keep them."""
    FOLDER.mkdir(exist_ok=True)
    (FOLDER / f"{name}.xz").write_bytes(lzma.compress(script, preset=9 | lzma.PRESET_EXTREME))
    lines = [f'"sources": "{record.sources}"', f'"kept": {record.kept}']
    runs = ",\n".join(json.dumps([run.size, run.calls, " ".join(run.marks)]) for run in record.runs)
    rows = (record.drawn[at : at + 8] for at in range(0, len(record.drawn), 8))
    drawn = ",\n".join(json.dumps(row)[1:-1] for row in rows)
    text = ",\n".join([*lines, f'"runs": [\n{runs}]', f'"drawn": [\n{drawn}]'])
    (FOLDER / f"{name}.json").write_text("{" + text + "}\n", encoding="utf-8")


def main() -> int:
    """Write what is measured, or compare."""
    parser = argparse.ArgumentParser(description=__doc__, prog="python -m tests.recorded.calls")
    parser.add_argument("--check", action="store_true", help="compare; write nothing")
    parser.add_argument("--only", choices=NAMES, help="one of the protocols")
    asked, lost = parser.parse_args(), []
    for name in [asked.only] if asked.only else NAMES:
        if asked.check:
            lost += in_python(name, len(kept(name).runs), 0, 0, DRAWN // PIECE)
        else:
            write(name, *measure(name))
    print("\n".join(lost) if lost else "all the same" if asked.check else "written")
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
