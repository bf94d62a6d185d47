"""What pages are told of small simulated networks, message by message, kept as data.

`python -m tests.recorded.watched` plays every script below to a network as its page would, and
writes all that the page gets back into `watched/`, one message a line; `--check` names what differs
instead. Networks are held all the time and moved by seeking, so that no clock has a say.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from innervate import scenario
from innervate.network import networks
from innervate.web import simulated
from innervate.web.errors import Refused
from innervate.web.messages import parse
from innervate.web.simulated import Simulated
from innervate.web.snapshot import DeltaEncoder, Part, Snapshot
from tests.recorded import asked
from tests.recorded.record import differences

FOLDER = Path(__file__).resolve().parent / "watched"
RING_FOLDER = FOLDER.parents[1] / "networks" / "tokenring"
RING = {"kind": "tokenring", "name": "ring", "nodes": 5, "duration_s": 0.3}
SKIN = {
    "kind": "skin", "name": "sleeve", "duration_s": 1.0, "data": {"rate_hz": 100},
    "patch": [{"columns": 4, "rows": 3}],
    "interface": [{"row": 0, "column": 1}, {"row": 2, "column": 2}],
    "touch": {"path": [[0.0, 0.0, 0.0], [0.9, 40.0, 20.0]], "radius_mm": 20.0},
    "event": [{"at_s": 0.3, "action": "cut", "interface": 0},
              {"at_s": 0.4, "action": "restore", "interface": 0},
              {"at_s": 0.45, "action": "loose", "cell": {"row": 1, "column": 1}, "port": "E",
               "loss": 0.5}],
}  # fmt: skip
QUIET = {
    "kind": "skin", "name": "quiet", "duration_s": 0.5, "data": {"rate_hz": 0},
    "patch": [{"columns": 3, "rows": 1}], "interface": [{"row": 0, "column": 0, "port": "W"}],
}  # fmt: skip
RADIO = {
    "kind": "radio", "name": "team", "duration_s": 2.0, "stations": 5,
    "traffic": {"kind": "saturated", "packets": 12},
    "event": [{"at_s": 0.2, "action": "kill", "station": 3}],
}  # fmt: skip
MESH = {
    "kind": "mesh", "name": "yard", "duration_s": 30.0, "seed": 4, "nodes": 9, "standby": [1],
    "radio": {"mean_degree": 4},
    "flow": [{"from": "all", "to": "gateway", "every_s": 1.0, "jitter_s": 1.0}],
    "event": [{"at_s": 5.0, "action": "kill", "node": 7}],
}  # fmt: skip
ROBOT = {
    "kind": "mesh", "name": "fenced", "duration_s": 40.0, "seed": 2,
    "node": [{"x_m": 0.0, "y_m": 0.0}, {"x_m": 30.0, "y_m": 0.0, "name": "mast"},
             {"name": "rover", "x_m": 20.0, "y_m": 5.0}],
    "radio": {"reach_m": 60},
    "robot": [{"node": "rover", "speed_mps": 2.0, "waypoints": [[20, 5], [20, 30], [10, 0]]}],
    "fence": {"polygon": [[-5, -15], [50, -15], [50, 15], [-5, 15]]},
}  # fmt: skip


def to(t_s: float) -> dict[str, Any]:
    """The command that goes to a moment."""
    return {"do": "seek", "t_s": t_s}


def do(name: str, **more: Any) -> dict[str, Any]:
    """Any other command."""
    return {"do": name, **more}


HOLD = [do("pause")]
STEPS = [do("step"), do("step")]
SCRIPTS: dict[str, tuple[dict[str, Any], list[dict[str, Any]]]] = {
    "ring": (RING, [
        *HOLD, *STEPS, to(0.05), do("cut", link=1), do("cut", link=1), to(0.1), do("kill", node=3),
        do("kill", node=3), do("heal", link=3), do("heal", link=1), do("revive", node=2),
        do("revive", node=3), do("heal", link=9), do("kill", node=5), to(0.2), *STEPS, to(0.06),
        to(0.3), do("cut", link=0), do("step"), do("save"), do("touch", node=0, value=3), to(0.0),
    ]),
    "skin": (SKIN, [
        *HOLD, *STEPS, to(0.1), *STEPS, to(0.3), *STEPS, to(0.31), to(0.35), to(0.5),
        do("touch", node=5, value=200), to(0.6), do("touch", node=5, value=0),
        do("touch", node=12, value=9), do("command", code=7, value=300, node=4),
        do("command", code=8), do("command", code=8, node=13), do("command", code=8, node=12),
        to(0.62), to(0.7), do("kill", node=5), do("kill", node=5), do("kill", node=12),
        do("kill", node=99), do("revive", node=6), *STEPS, to(0.75), do("cut", link=0),
        do("cut", link=0), do("heal", link=1), do("heal", link=77), to(0.8), do("revive", node=5),
        do("heal", link=0), to(0.95), do("save"), to(0.72), to(0.3), to(1.0), do("save"),
        do("step"), do("kill", node=1), do("speed", value=0.02), do("speed", value=1e-9),
        do("speed", value=3.0), do("go"), do("pause"),
    ]),
    "quiet": (QUIET, [
        *HOLD, to(0.1), do("touch", node=1, value=9), do("cut", link=1), to(0.2),
        do("kill", node=1), do("heal", link=1), do("revive", node=1), to(0.3), do("heal", link=1),
        do("heal", link=1), to(0.5),
    ]),
    "radio": (RADIO, [
        *HOLD, *STEPS, *[to(round(0.004 * i, 3)) for i in range(1, 24)], *STEPS, to(0.21),
        do("revive", node=2), do("kill", node=2), do("kill", node=2), do("kill", node=5),
        do("cut", link=0), do("heal", link=0), to(0.4), do("revive", node=3), do("revive", node=3),
        to(0.6), do("save"), to(0.1), to(2.0), do("step"), do("kill", node=0),
    ]),
    "mesh": (MESH, [
        *HOLD, *STEPS, to(0.5), to(1.5), *STEPS, to(4.0), do("kill", node=3), do("kill", node=3),
        do("revive", node=4), do("cut", link=1), do("cut", link=1), do("cut", link=200), to(4.5),
        to(6.0), *STEPS, do("heal", link=1), do("heal", link=1), do("revive", node=3), to(9.0),
        do("kill", node=0), to(9.5), do("revive", node=77), to(29.0), do("save"), to(7.0),
        to(30.0), do("touch", node=1, value=1),
    ]),
    "robot": (ROBOT, [
        *HOLD, to(9.0), to(14.0), *STEPS, to(18.0), to(18.1), to(22.0), to(27.0),
        do("kill", node=2), to(33.0), do("save"), to(40.0),
    ]),
}  # fmt: skip


class Watched:
    """A simulation and the page that looks at it.

    Args:
        tables: its scenario.
    """

    def __init__(self, tables: dict[str, Any]) -> None:
        self.source = Simulated(scenario.plan(scenario.from_dict(tables)), 0)
        self.source.prepare()
        scene = {**self.source.scene(), "version": "-"}
        self._scene = Part({"type": "scene", **scene})
        self._page = DeltaEncoder(self.source.history)
        self._before: Snapshot | None = None

    def do(self, command: dict[str, Any]) -> list[Any]:
        """What a page is told when it has asked for something: the answer, then what is new."""
        told: list[Any] = []
        try:
            answer = self.source.carry_out(parse(json.dumps(command)))
            told += [answer] if answer else []
        except Refused as error:
            told.append({"refused": str(error)})
        while self.source.work() == 0:
            pass
        return told + self.news()

    def news(self) -> list[Any]:
        """The messages that bring the page up to now."""
        source = self.source
        self._before = Snapshot(self._scene, source.fields(), source.history.newest, self._before)
        found: list[Any] = []
        while True:
            found += [json.loads(text) for text in self._page.messages(self._before)]
            if not self._page.is_behind(self._before):
                return found


NAMES = tuple(sorted(path.stem for path in FOLDER.glob("*.jsonl")))


@contextmanager
def at_hand() -> Iterator[None]:
    """No slice of work ends because of the clock; the ring is one of the networks."""
    slice_s, folders = simulated.SLICE_S, os.environ.get("INNERVATE_NETWORKS")
    simulated.SLICE_S, os.environ["INNERVATE_NETWORKS"] = 1e9, str(RING_FOLDER)
    networks.cache_clear()
    try:
        yield
    finally:
        simulated.SLICE_S = slice_s
        del os.environ["INNERVATE_NETWORKS"]
        if folders is not None:
            os.environ["INNERVATE_NETWORKS"] = folders
        networks.cache_clear()


def told(name: str) -> list[list[Any]]:
    """All messages of a script: at first, then after every command, which stands before them."""
    if name in asked.SCRIPTS:
        return asked.told(name)
    tables, commands = SCRIPTS[name]
    with at_hand():
        watched = Watched(tables)
        return [["at first", *watched.news()], *([one, *watched.do(one)] for one in commands)]


def lines(found: list[list[Any]]) -> str:
    """Messages as they are kept: one a line."""
    return "".join(
        json.dumps(message, separators=(",", ":")) + "\n" for step in found for message in step
    )


def by_step(text: str) -> dict[str, Any]:
    """Kept messages by the command before them and their place behind it."""
    found: dict[str, Any] = {}
    step, at, place = "", 0, 0
    for message in map(json.loads, text.splitlines()):
        if message == "at first" or "do" in message:
            at, place, step = at + 1, 0, json.dumps(message)
        found[f"{at} {step} {place}"] = message
        place += 1
    return found


def changes(name: str) -> list[str]:
    """Where a network tells its pages something else than was kept, one line each."""
    kept = (FOLDER / f"{name}.jsonl").read_text(encoding="utf-8")
    return differences(name, by_step(kept), by_step(lines(told(name))))


def main() -> int:
    """Write what pages are told, or compare with it."""
    if "--check" in sys.argv[1:]:
        lost = [line for name in NAMES for line in changes(name)]
        print("\n".join(lost) if lost else "all the same")
        return 1 if lost else 0
    FOLDER.mkdir(exist_ok=True)
    for name in (*SCRIPTS, *asked.SCRIPTS):
        (FOLDER / f"{name}.jsonl").write_text(lines(told(name)), encoding="utf-8")
        print(f"watched {name}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
