"""One planted fault after the other: whether one of the tests that are near it fails.

A process that has imported what is large and foreign forks for each fault: what it forks imports
the toolkit with the fault in it (`planting/`) and runs tests, near and cheap ones first, until one
fails. What fails without the fault, too, finds nothing: it is tried alone, its answer is kept.
"""

from __future__ import annotations

import contextlib
import gc
import hashlib
import importlib
import json
import os
import select
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from tests.mutants.choose import Choice, shared, words_of
from tests.mutants.draw import Fault
from tests.mutants.planting import sitecustomize
from tests.mutants.turns import Turns, rounds, turn

FOUND, SURVIVED = "found", "survived"
LARGE = (
    "numpy", "numba", "polars", "matplotlib.pyplot", "msgspec", "hypothesis", "networkx", "rich",
    "cyclopts", "asyncio", "cryptography.hazmat.primitives.asymmetric.x25519", "websockets",
    "starlette.applications", "uvicorn",
)  # fmt: skip
CROWDED = 5  # so much longer it may take by the clock
LATE = "did not end in time"
FORGIVEN_MAX = 12  # tests that fail without the fault, too, before one gives up


class Way(NamedTuple):
    """How tests run.

    Attributes:
        plain: whatever is compiled runs as Python.
        anew: nothing is compiled yet.
        each_s: of processor time; a test that takes longer fails.
        all_s: no further test begins when so much processor time is spent.
    """

    name: str
    plain: bool = False
    anew: bool = False
    each_s: float = 12.0
    all_s: float = 0.0


AS_IS = Way("as it is")
PLAIN = Way("plain", plain=True)
ANEW = Way("compiled anew", anew=True, each_s=100.0)


class Outcome(NamedTuple):
    """What became of a fault.

    Attributes:
        verdict: FOUND or SURVIVED.
        by: the test that failed first.
        tests: how many ended before.
        took_s: how long all of it took.
    """

    verdict: str
    by: str
    tests: int
    took_s: float


class Seen(NamedTuple):
    """What one process saw.

    Attributes:
        failed: the test that failed; "" if none did.
        why: what it said.
        passed: those that passed before, and how long each took on the processor.
        compiled: the faulty file is one that compiled code came from.
    """

    failed: str
    why: str
    passed: dict[str, float]
    compiled: bool = False


class Watch:
    """A plugin for pytest: order and limits of tests, and a line for each beginning and end."""

    def __init__(self, log: Path, way: Way, words: set[str], without: frozenset[str]) -> None:
        self.log, self.way, self.words, self.without = log, way, words, without
        self.began_s = 0.0, 0.0  # a test, by the clock and by the processor
        self.turn = 0
        self.files: list[str] = []
        self.took_s: dict[str, float] = {}
        self.turns: dict[str, set[int]] = {}  # of the tests of each file that was collected

    def tell(self, what: str, name: str, why: str | float = "") -> None:
        with self.log.open("a", encoding="utf-8") as file:
            file.write(json.dumps([what, name, why]) + "\n")

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        orders = [(*self._order(item.nodeid), item) for item in items]
        for number, place, *_ in orders:
            self.turns.setdefault(self.files[place], set()).add(number)
        now = [one for one in orders if one[0] == self.turn and one[-1].nodeid not in self.without]
        items[:] = [item for *_, item in sorted(now, key=lambda one: one[:3])]

    def may_have(self, test: str) -> bool:
        """True if a file was not collected yet, or has tests that wait for this turn."""
        return self.turn in self.turns.get(test.partition("::")[0], {self.turn})

    def _order(self, test: str) -> tuple[int, int, int]:
        """The turn of a test, the place of its file, and how few of the words it says."""
        place = self.files.index(test.partition("::")[0])
        return turn(test, place, self.took_s.get(test, 0.0)), place, -shared(test, self.words)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self.tell("begins", item.nodeid)
        signal.signal(signal.SIGALRM, self._late)
        self.began_s = time.monotonic(), sum(os.times()[:4])
        signal.setitimer(signal.ITIMER_REAL, 1.0, 1.0)
        try:
            return (yield)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            if sum(os.times()[:4]) > self.way.all_s:
                item.session.shouldstop = "no more time"

    def _late(self, *_: Any) -> None:
        clock_s, processor_s = self.began_s
        if time.monotonic() - clock_s > CROWDED * self.way.each_s or (
            sum(os.times()[:4]) - processor_s > self.way.each_s
        ):
            pytest.fail(LATE)

    def tell_compiled(self, path: str) -> None:
        """Say if functions of the faulty file were compiled, or taken from what was."""
        from numba.core.dispatcher import Dispatcher

        from innervate.kernel import compilation

        gc.unfreeze()  # see tests/conftest.py
        found = compilation._registered | {
            one.py_func for one in gc.get_objects() if isinstance(one, Dispatcher)
        }
        if path in {one.__code__.co_filename for one in found}:
            self.tell("compiled", path)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self.tell("failed", report.nodeid, str(report.longrepr)[-300:])
        elif report.when == "teardown":
            self.tell("ended", report.nodeid, sum(os.times()[:4]) - self.began_s[1])

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.failed:
            self.tell("failed", report.nodeid, str(report.longrepr)[-300:])


class Bench:
    """Where faults are tried.

    Args:
        root: of the project.
        work: a folder for what is kept.
        budget_s: of processor time for the tests of a fault.
        compiled: the folder of what is compiled of these sources, if there is one.
    """

    def __init__(
        self, root: Path, work: Path, budget_s: float, compiled: Path | None = None
    ) -> None:
        self.root, self.work, self.budget_s, self.compiled = root, work, budget_s, compiled
        self.choice, self.turns = Choice(root), Turns(root, work / "took.jsonl")
        self._passed: set[tuple[str, str]] = set()  # by the way; also with faults elsewhere
        for name in LARGE:
            with contextlib.suppress(ImportError):
                importlib.import_module(name)

    def try_out(self, fault: Fault) -> Outcome:
        """Plant a fault, run tests until one fails that does not fail without it.

        Compiled code is taken as it was compiled of sound sources: a fault in it shows plain.
        """
        started, count = time.monotonic(), 0
        files = self.choice.tests_for(fault.path, words_of(self.root, fault))
        is_compiler = fault.room == "kernel"
        for way in (AS_IS, ANEW if is_compiler else PLAIN):
            seen = self._found(fault, way._replace(all_s=self.budget_s), files)
            count += len(seen.passed)
            if seen.failed or not (seen.compiled or is_compiler):
                break
        took_s = round(time.monotonic() - started, 1)
        return Outcome(FOUND if seen.failed else SURVIVED, seen.failed, count, took_s)

    def _found(self, fault: Fault, way: Way, files: list[str]) -> Seen:
        passed: dict[str, float] = {}
        is_compiled = False
        unsound = self._unsound(way)
        for _ in range(FORGIVEN_MAX):
            seen = self.run(files, way, fault, frozenset(unsound | passed.keys()))
            passed |= seen.passed
            is_compiled |= seen.compiled
            if not seen.failed or self._counts(seen, way, fault):
                break
            unsound.add(seen.failed)
            files = [file for file in files if file != seen.failed]  # one that cannot be collected
            seen = seen._replace(failed="")
        self._passed.update((way.name, test) for test in passed)
        return seen._replace(passed=passed, compiled=is_compiled)

    def _counts(self, seen: Seen, way: Way, fault: Fault) -> bool:
        """True if a test passes without the fault; one that was late is asked again: by now all
        that it runs is compiled."""
        test = seen.failed
        is_late = LATE in seen.why
        if is_late and seen.compiled:  # it may have waited for what the fault made compile anew
            return False
        if (way.name, test) in self._passed and not is_late:
            return True
        key = f"{way.name} {test} {self._digest(test)}"
        if self._kept().get(key) and not is_late:
            return True
        sound = self.run([test], way._replace(all_s=10 * self.budget_s))
        is_sound = bool(sound.passed) and not sound.failed
        with (self.work / "sound.jsonl").open("a", encoding="utf-8") as file:
            file.write(json.dumps([key, is_sound]) + "\n")
        return is_sound and not (is_late and not self.run([test], way, fault).failed)

    def _digest(self, test: str) -> str:
        path = self.root / test.partition("::")[0]
        return hashlib.blake2b(path.read_bytes() if path.is_file() else b"").hexdigest()[:12]

    def _kept(self) -> dict[str, bool]:
        path = self.work / "sound.jsonl"
        lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
        return dict(map(json.loads, lines))

    def _unsound(self, way: Way) -> set[str]:
        """Tests that failed without any fault, in files that are still the same."""
        found = set()
        for key, is_sound in self._kept().items():
            head, _, known = key.rpartition(" ")
            test = head.removeprefix(f"{way.name} ")
            if not is_sound and test != head and self._digest(test) == known:
                found.add(test)
        return found

    def run(
        self, tests: list[str], way: Way, fault: Fault | None = None,
        without: frozenset[str] = frozenset(),
    ) -> Seen:  # fmt: skip
        """Run tests in a process of their own, until one fails."""
        with tempfile.TemporaryDirectory(prefix="fault-", ignore_cleanup_errors=True) as place:
            folder = Path(place)
            env = self._env(way, fault, folder)
            words = words_of(self.root, fault) if fault else set()
            watch = Watch(folder / "log", way, words, without)
            watch.took_s = self.turns.took_s()
            child = os.fork()
            if not child:
                run_here(self.root, env, tests, watch)
            ended = os.pidfd_open(child)
            select.select([ended], [], [], CROWDED * (way.all_s + way.each_s))
            os.close(ended)
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            end_those_left(place)
            seen = seen_in(folder / "log")
        if way.name == AS_IS.name:
            self.turns.keep(seen.passed)
        return seen

    def _env(self, way: Way, fault: Fault | None, folder: Path) -> dict[str, str]:
        """With a fault, what is compiled is not kept: it may not be what its sources say."""
        env = {"PYTHONPATH": str(self.root / "src"), "INNERVATE_TRIAL": str(folder)}
        if fault or way.plain:
            text = self._edit(fault) | {"plain": way.plain}
            env |= {sitecustomize.FAULT: json.dumps(text)}
            env["PYTHONPATH"] += f":{Path(sitecustomize.__file__).parent}"
        if fault or way.anew:
            own = folder / "compiled"
            env["INNERVATE_CACHE"] = str(own)
            if self.compiled and not way.anew:
                shutil.copytree(self.compiled, own / self.compiled.name, copy_function=os.link)
        return env

    def _edit(self, fault: Fault | None) -> dict[str, Any]:
        if fault is None:
            return {"path": "", "start": 0, "end": 0, "new": ""}
        path = str(self.root / fault.path)
        return {"path": path, "start": fault.start, "end": fault.end, "new": fault.new}


def run_here(root: Path, env: dict[str, str], tests: list[str], watch: Watch) -> None:
    """Run tests in this process, which is there for nothing else; does not return."""
    os.setsid()
    said = os.open(watch.log.with_name("said"), os.O_WRONLY | os.O_CREAT)
    for descriptor in (1, 2):
        os.dup2(said, descriptor)
    os.chdir(root)
    os.environ |= env
    if sitecustomize.FAULT in env:
        sitecustomize.plant(**json.loads(env[sitecustomize.FAULT]))
    sys.path.insert(0, str(root / "src"))
    asked = ["-x", "-q", "-m", "not slow", "-p", "no:cacheprovider",
             f"--basetemp={watch.log.parent / 'tests'}"]  # fmt: skip
    watch.files = [test.partition("::")[0] for test in tests]
    try:
        for watch.turn, some in rounds(tests):
            left = [one for one in some if watch.may_have(one)]
            if left and pytest.main([*asked, *left], [watch]) not in (0, 5):
                break
        if sitecustomize.FAULT in env:
            watch.tell_compiled(sitecustomize.planted[0])
    finally:
        os._exit(0)


def end_those_left(place: str) -> None:
    """End what was started in a place and has outlived the test that started it."""
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if place.encode() in (process / "environ").read_bytes():
                os.kill(int(process.name), signal.SIGKILL)


def seen_in(log: Path) -> Seen:
    """What a process wrote of its tests; one that began and did not end has failed."""
    lines = [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []
    failed = [(name, why) for what, name, why in lines if what == "failed"]
    if not failed and lines and lines[-1][0] == "begins":
        failed = [(lines[-1][1], LATE)]
    bad = {name for name, _ in failed}
    ended = {name: took_s for what, name, took_s in lines if what == "ended"}
    passed = {name: took_s for name, took_s in ended.items() if name not in bad}
    compiled = any(what == "compiled" for what, *_ in lines)
    return Seen(*(failed[0] if failed else ("", "")), passed, compiled)
