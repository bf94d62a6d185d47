"""When a test has its turn: near ones before those further away, cheap ones before dear ones.

How long tests take is kept from fault to fault; before that `make test` has told it.
"""

from __future__ import annotations

import json
from bisect import bisect
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

CHEAP_S = (0.1, 1.0)  # a test that takes longer waits a turn; than the second, two
RECORDED, MORE = "tests/recorded/", 4  # what looks at so much may take so many times as long
FIRST, NEAR = 3, 15  # files that are collected before all others; whose tests need not wait
TURNS = len(CHEAP_S) + 2
OF_SUITE = ".mutants/suite.xml"  # what `make test` leaves


class Turns:
    """Knows how long tests took; of what was never run it is taken that it is cheap.

    Args:
        root: of the project.
        kept: the file that is added to.
    """

    def __init__(self, root: Path, kept: Path) -> None:
        self.kept = kept
        suite = root / OF_SUITE
        self._suite = dict(read_suite(suite)) if suite.exists() else {}

    def took_s(self) -> dict[str, float]:
        """How long tests took: on this bench or, if they did not pass on it, in the whole suite."""
        return self._suite | self._longest()

    def keep(self, passed: dict[str, float]) -> None:
        """Note how long tests took that were not seen yet, or took less."""
        known = self._longest()
        with self.kept.open("a", encoding="utf-8") as file:
            for test, took_s in passed.items():
                if test not in known or took_s > known[test]:
                    file.write(json.dumps([test, round(took_s, 3)]) + "\n")

    def _longest(self) -> dict[str, float]:
        found: dict[str, float] = {}
        lines = self.kept.read_text(encoding="utf-8").splitlines() if self.kept.exists() else []
        for test, took_s in map(json.loads, lines):
            found[test] = max(took_s, found.get(test, 0.0))
        return found


def turn(test: str, place: int, took_s: float) -> int:
    """The turn of a test, from 0, by the place of its file among those that may notice."""
    own_s = took_s / MORE if test.startswith(RECORDED) else took_s
    return bisect(CHEAP_S, own_s) + (place >= NEAR)


def rounds(files: list[str]) -> Iterator[tuple[int, list[str]]]:
    """Turns, each with the files that may have tests in it."""
    yield 0, files[:FIRST]
    yield 0, files[FIRST:NEAR]
    yield from ((number, files) for number in range(1, TURNS))


def read_suite(path: Path) -> Iterator[tuple[str, float]]:
    """Tests of a run of pytest, and how long they took by the clock."""
    for case in ElementTree.parse(path).iter("testcase"):
        file = case.attrib["classname"].replace(".", "/") + ".py"
        yield f"{file}::{case.attrib['name']}", float(case.attrib["time"])
