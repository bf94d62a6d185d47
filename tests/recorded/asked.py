"""What pages are told of running nodes, by words that are put into the nodes' mouths.

Kept like what simulated networks tell (`tests.recorded.watched`, whose command writes both). Here
nobody runs: a script says what nodes answer, whether they answer, and what time it is.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from innervate.web import live
from innervate.web.errors import Refused
from innervate.web.live import Live
from innervate.web.messages import parse
from innervate.web.snapshot import DeltaEncoder, Part, Snapshot

Words = dict[str, Any]


def path(port: int, own: int, far: int, received: int = 1) -> Words:
    """A path over UDP between two numbers that stand for addresses."""
    return {"port": port, "own": f"udp 127.0.0.1:{own}", "name": f"udp 127.0.0.1:{far}",
            "up": True, "counters": {"received": received}}  # fmt: skip


def cell(number: int, parent: int | None, *ends: tuple[int, int]) -> Words:
    """A cell of a skin; `ends` are its paths."""
    return {"kind": "skin", "role": "cell", "number": number, "parent": parent,
            "load": 20 * number + 5, "command": None, "counters": {},
            "paths": [path(at, *both) for at, both in enumerate(ends)],
            "ports": [{"port": at, "path": at} for at in range(len(ends))]}  # fmt: skip


def pc(*ends: tuple[int, int]) -> Words:
    """The PC of a skin."""
    return {"kind": "skin", "role": "sink", "cells": [2], "counters": {}, "ports": [],
            "paths": [path(at, *both) for at, both in enumerate(ends)]}  # fmt: skip


def node(number: int, near: dict[int, int], onward: list[int], **more: Any) -> Words:
    """A node of a mesh; `near` has its neighbours and by which path it hears each."""
    return {"kind": "mesh", "role": "node", "number": number, "gateway": 0, "onward": onward,
            "neighbours": [{"node": one, "ports": [at]} for one, at in near.items()],
            "paths": [path(at, 10 * number + at, 99, number) for at in sorted({*near.values()})],
            "counters": {"dropped: short": number}, **more}  # fmt: skip


def alarm(kind: str, number: int, ago_s: float) -> Words:
    """An alarm about the robot, as a monitor tells it."""
    return {"kind": kind, "robot": 3, "reporter": 3, "number": number, "ago_s": ago_s}


def station(number: int, queued: int, place: int | None, does: str) -> Words:
    """A station of a team."""
    return {"kind": "radio", "role": "station", "number": number, "queued": queued, "mode": 0,
            "place": place, "radio": does, "counters": {"packets received": 7 * number,
            "packets delivered": number, "packets accepted": number + queued},
            "timing": TIMING, "paths": [{"port": 0, "own": "air", "name": "air", "up": True,
            "counters": {"received": 3 * number}}]}  # fmt: skip


TIMING = {"slot_us": 500, "packet_slots": 100, "ta_us": 100, "dmax_us": 50}
SKIN = [cell(0, 0, (2, 1), (3, 4), (5, 6)), cell(1, 1, (4, 3), (6, 5)), pc((1, 2))]
MESH = [
    node(0, {1: 0, 2: 1}, [], role="gateway", alarms=[alarm("predict", 1, 0.5)]),
    node(1, {0: 0, 2: 0}, [0]),
    node(2, {0: 0, 1: 1, 3: 2}, [0, 1]),
    node(3, {2: 0}, [2], robot={"at_cm": [100, 200], "fence": "inside"}),
]
RADIO = [station(0, 0, 1, "listening"), station(1, 4, 2, "sending"), station(2, 9, None, "off")]


def do(name: str, **more: Any) -> list[Any]:
    """A page's command."""
    return ["do", {"do": name, **more}]


def says(who: int, **words: Any) -> list[Any]:
    """From now on a node says something else."""
    return ["says", who, words]


def wait(seconds: float) -> list[Any]:
    """Time goes on."""
    return ["wait", seconds]


def silent(who: int, gone: bool) -> list[Any]:
    """A node answers no more: it is gone, or only slow."""
    return ["silent", who, gone]


def again(who: int) -> list[Any]:
    """A node answers again."""
    return ["again", who]


def cut(*paths: int, of: Words) -> Words:
    """The `paths` of a node, some of them down."""
    return {"paths": [one | {"up": one["port"] not in paths} for one in of["paths"]]}


SCRIPTS: dict[str, tuple[list[Words], list[list[Any]]]] = {
    "live-skin": (SKIN, [
        wait(0.1), wait(0.15), says(0, paths=[path(0, 2, 1, 41), *SKIN[0]["paths"][1:]]),
        wait(0.25), do("cut", link=1), do("cut", link=0), says(0, **cut(0, of=SKIN[0])), wait(0.2),
        do("cut", link=2), do("heal", link=2), says(0, **cut(of=SKIN[0])), wait(0.2), wait(3.0),
        says(0, **cut(0, of=SKIN[0])), wait(0.2), wait(0.3), says(0, **cut(of=SKIN[0])), wait(0.1),
        says(1, parent=None), wait(0.2), says(1, parent=0), wait(0.2),
        do("kill", node=1), do("kill", node=2), do("revive", node=0), do("kill", node=7),
        says(1, **cut(0, 1, of=SKIN[1])), wait(0.2), do("revive", node=1),
        says(1, **cut(of=SKIN[1])), wait(0.3), do("command", code=3, node=1), do("command", code=4),
        do("command", code=4, node=2), do("command", code=4, node=3), says(1, command=1), wait(0.2),
        says(0, command=2), says(1, command=2), wait(0.2), silent(1, False), wait(0.2), wait(0.2),
        do("kill", node=1), do("cut", link=0), again(1), wait(0.2), silent(1, True), wait(0.2),
        silent(2, True), wait(0.2), do("command", code=1), again(2), again(1), wait(0.2),
        silent(0, True), silent(1, True), silent(2, True), wait(0.2), do("step"), do("save"),
    ]),
    "live-mesh": (MESH, [
        wait(0.3), wait(0.2), says(0, alarms=[alarm("cross", 2, 6.0), alarm("predict", 1, 8.0)]),
        says(3, robot={"at_cm": [300, 250], "fence": "outside"}), wait(0.2),
        do("cut", link=0), do("cut", link=3), do("cut", link=1), do("kill", node=2), wait(0.2),
        says(2, **cut(0, 1, 2, of=MESH[2])), wait(0.2), says(2, neighbours=[]), wait(0.2),
        do("command", code=1), do("revive", node=2),
        says(2, neighbours=MESH[2]["neighbours"], **cut(of=MESH[2])), wait(0.1), wait(0.1),
        says(1, onward=[3]), wait(0.2), says(2, gives_back=False), wait(0.2),
        says(2, gives_back=True), says(1, onward=[], gateway=None), wait(0.2),
        says(1, gateway=0, onward=[2]), wait(0.1), silent(0, True), wait(0.3),
        says(1, role="gateway", gateway=1), says(2, gateway=1, onward=[1]), wait(0.1),
        again(0), says(0, alarms=[alarm("clear", 3, 0.1), alarm("lost", 4, 5.0)]), wait(0.2),
        says(0, counters={"dropped: short": 5, "dropped: replayed": 2, "sent": 9}), wait(0.5),
    ]),
    "live-radio": (RADIO, [
        wait(0.1), wait(0.1), do("kill", node=1), says(1, **cut(0, of=RADIO[1])), wait(0.1),
        says(0, queued=17, radio="sending", place=0), wait(0.1), do("kill", node=1),
        do("cut", link=0), do("revive", node=1), says(1, **cut(of=RADIO[1])), wait(0.2),
        says(2, **cut(0, of=RADIO[2])), wait(3.0), says(2, **cut(of=RADIO[2])), wait(0.2),
        wait(20.0), wait(60.0), silent(0, True), wait(0.2), again(0), wait(0.2),
        silent(0, True), silent(1, True), silent(2, True), wait(0.1),
    ]),
}  # fmt: skip


class Mouths:
    """Answers in place of nodes; takes note of what they are asked to do."""

    def __init__(self, words: list[Words]) -> None:
        self.words = dict(enumerate(copy.deepcopy(words)))
        self.mute: dict[int, bool] = {}
        self.asked: list[Any] = []
        self._number = 0

    def ask(self, requests: dict[int, Words]) -> dict[int, Words]:
        """What those say who answer."""
        found: dict[int, Words] = {}
        for who, request in requests.items():
            self.asked.append([who, request])
            if who not in self.mute:
                self._number += request["do"] == "command"
                found[who] = {"ok": True, "number": self._number, "ports": [0]}
        return found

    def ask_all(self, _request: Words) -> dict[int, Words]:
        """Everybody's status."""
        return {i: copy.deepcopy(one) for i, one in self.words.items() if i not in self.mute}

    def is_gone(self, who: int) -> bool:
        """True if nobody is at the socket."""
        return self.mute.get(who, False)

    def close(self) -> None:
        """Nobody is asked any more."""


class Asked:
    """Nodes that say what a script has them say, and the page that looks at them."""

    def __init__(self, words: list[Words]) -> None:
        self._now_s = 1000.0
        self.nodes = Mouths(words)
        with self._here():
            self.source = Live([Path(f"/nowhere/n{i}.sock") for i in self.nodes.words])
        self._page = DeltaEncoder(self.source.history)
        self._before: Snapshot | None = None
        self._scenes = 0

    @contextmanager
    def _here(self) -> Iterator[None]:
        """The sources' clock and nodes are ours."""
        was = live.time, live.Poller
        live.time = SimpleNamespace(monotonic=lambda: self._now_s)  # type: ignore[assignment]
        live.Poller = lambda _sockets: self.nodes  # type: ignore[assignment,misc]
        try:
            yield
        finally:
            live.time, live.Poller = was  # type: ignore[misc]

    def play(self, step: list[Any]) -> list[Any]:
        """What nodes are asked and what the page is told at a step."""
        told: list[Any] = []
        match step:
            case ["wait", seconds]:
                self._now_s += seconds
            case ["says", who, words]:
                self.nodes.words[who] |= words
                return []
            case ["silent", who, gone]:
                self.nodes.mute[who] = gone
                return []
            case ["again", who]:
                del self.nodes.mute[who]
                return []
        with self._here():
            if step[0] == "do":
                try:
                    self.source.carry_out(parse(json.dumps(step[1])))
                except Refused as error:
                    told.append({"refused": str(error)})
            self._now_s += 0.003
            told.append({"rest_s": round(self.source.work(), 6), "asked": self.nodes.asked})
            self.nodes.asked = []
            return told + self.news()

    def news(self) -> list[Any]:
        """The messages that bring the page up to now."""
        with self._here():
            if self._scenes != self.source.scenes:
                self._scenes = self.source.scenes
                self._scene = Part({"type": "scene", **self.source.scene(), "version": "-"})
            newest = self.source.history.newest
            self._before = Snapshot(self._scene, self.source.fields(), newest, self._before)
        return [json.loads(text) for text in self._page.messages(self._before)]


def told(name: str) -> list[list[Any]]:
    """All messages of a script: at first, then after every step, which stands before them."""
    words, steps = SCRIPTS[name]
    asked = Asked(words)
    return [["at first", *asked.news()], *([{"do": one}, *asked.play(one)] for one in steps)]
