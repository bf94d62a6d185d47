"""Calls made in Python and in C, and compared: `python -m boards.firmware`.

`python -m boards.firmware [--calls N] [--seed S] [--plain] [--emulated] [skin csma ...]`: of each
role N calls (1,000,000), half as nodes of plain simulations are told them, with one seed after the
other, half drawn. State and outbox are compared after every call. The C is compiled with a check
of every sum, shift and index; `--plain`: without. `--emulated`: the same calls besides on an
emulated Cortex-M3, once with a Cortex-M0's code, and on RISC-V; hashes over states and outboxes
of all calls are compared with this machine's. Exit code 1 if anything differs, 2 if something
is not installed.
"""

from __future__ import annotations

import argparse
import io
import sys
import tempfile
import time
from pathlib import Path

from boards.errors import BoardFailed, BoardMissing
from boards.firmware import qemu
from boards.firmware.drawn import Drawn, lives
from boards.firmware.native import Native
from boards.firmware.play import Player
from boards.firmware.replayed import Heard, Shadow
from boards.firmware.script import Script
from boards.parity.record import plan_of, scenario_of
from boards.roles import roles
from innervate import scenario
from innervate.firmware.emit import Library
from innervate.folders import NetworkError
from innervate.live.board import Role

CALLS = 1_000_000
MORE = 100_000  # lives of a seed, at most


def replay(native: Native, calls: int, seed: int) -> tuple[int, Heard]:
    """Simulate until so many calls were made both ways; how many, and what nodes heard.

    Raises:
        BoardFailed: the two disagree.
    """
    heard, done = Heard(), 0
    while done < calls:
        shadow = Shadow(native, calls - done)
        shadow.heard = heard
        if native.script:
            native.script.begin()
        shadow.run(scenario.plan(scenario_of(native.library.role, seed=seed)))
        if native.script:
            native.script.say()
        if not shadow.calls:
            raise BoardFailed(f"{native.library.role.name}: a simulation made no call")
        done, seed = done + shadow.calls, seed + 1
    return done, heard


def compare(role: Role, calls: int, seed: int, sanitized: bool) -> tuple[int, int]:
    """Make calls of a role both ways; how many were replayed, how many drawn.

    Raises:
        BoardMissing, BoardFailed: no compiler; they disagree.
    """
    with tempfile.TemporaryDirectory() as folder:
        native = Native(Library(role, {}), Path(folder), sanitized)
        replayed, heard = replay(native, calls // 2, seed)
        player, file = Player(native.library, native), io.BytesIO()
        draw(native.library, heard, seed, Script(file), calls - replayed)
        for _ in player.play(file.getvalue()):
            pass
    return replayed, player.calls


def draw(library: Library, heard: Heard, seed: int, script: Script, calls: int) -> None:
    """Write down so many drawn calls, and what they are made of.

    Raises:
        BoardFailed: nodes were told nothing that calls could be made of.
    """
    if not heard.frames and not heard.items:
        raise BoardFailed(f"no node was told anything in the simulations: {_remedy(library.role)}")
    Drawn(library, heard, seed).keep(script)
    script.begin()
    lives(script, 1 + seed * MORE, calls)
    script.say()


def _remedy(role: Role) -> str:
    """What has nodes be told something: of a scenario without inputs more calls do not."""
    if getattr(plan_of(role), "inputs", True):
        return "make more calls"
    name = role.watched.scenario or role.name
    return f"their scenario has no [[input]]; write one with it as boards/parity/{name}.toml"


def emulate(role: Role, calls: int, seed: int, counted: bool = False) -> dict[str, qemu.Result]:
    """Make calls of a role in Python, here in C, and on emulated processors; what came of them.

    `counted`: the emulated Cortex's timer counts instructions.

    Raises:
        BoardMissing, BoardFailed: something is not installed; they disagree.
    """
    with tempfile.TemporaryDirectory() as name:
        folder, path = Path(name), Path(name, "script")
        native = Native(Library(role, {}), folder)
        with path.open("wb") as file:
            native.script = Script(file)
            replayed, heard = replay(native, calls // 2, seed)
            draw(native.library, heard, seed, native.script, calls - replayed)
            native.script.end()
        wanted, found = list(Player(native.library).play(path.read_bytes())), {}
        for where in ("here", *qemu.TARGETS):
            if where == "here":
                there = qemu.on_host(native.library, folder, path)
            else:
                there = qemu.on_target(native.library, folder, path, where, counted)
            if there.marks != wanted:
                raise BoardFailed(f"{where}: hashes {shown(there.marks)}, Python {shown(wanted)}")
            found[where] = there
        return found


def shown(marks: list[int]) -> str:
    """Hashes as one reads them."""
    return " ".join(f"{mark:08x}" for mark in marks)


def main(arguments: list[str]) -> int:
    """The command; its exit code."""
    parser = argparse.ArgumentParser(prog="python -m boards.firmware")
    parser.add_argument("--calls", type=int, default=CALLS)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--plain", action="store_true")
    parser.add_argument("--emulated", action="store_true")
    parser.add_argument("roles", nargs="*")
    asked = parser.parse_args(arguments)
    try:
        known = roles()
    except NetworkError as error:  # what INNERVATE_NETWORKS names
        print(error, file=sys.stderr)
        return 2
    for name in asked.roles or known:
        if name not in known:
            print(f"no protocol {name!r}; known: {', '.join(known)}", file=sys.stderr)
            return 2
        begun = time.monotonic()
        try:
            if asked.emulated:
                found = emulate(known[name], asked.calls, asked.seed)
                print(f"{name}: {asked.calls} calls, {shown(found['here'].marks[-1:])} in Python, "
                      f"here, on {', '.join(qemu.TARGETS)} ({time.monotonic() - begun:.0f} s)",
                      flush=True)  # fmt: skip
                continue
            counts = compare(known[name], asked.calls, asked.seed, not asked.plain)
        except BoardMissing as missing:
            print(missing, file=sys.stderr)
            return 2
        except BoardFailed as failed:
            print(f"{name}: {failed}")
            return 1
        print(f"{name}: {counts[0]} calls replayed and {counts[1]} drawn, Python and C alike "
              f"({time.monotonic() - begun:.0f} s)", flush=True)  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
