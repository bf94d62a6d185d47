"""Which tests run which line of the sources: a plugin for pytest, and what it wrote, read back.

`pytest -p tests.mutants.cover` notes the lines of each test (also of processes that it starts) in
the folder that INNERVATE_COVER names, and how long each test took. What runs compiled leaves no
lines; of that, the lines are known which its tests run uncompiled. From Python 3.12 on a line costs
something once in each test (sys.monitoring); before that, each time it runs.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import sys
from collections import defaultdict
from pathlib import Path
from typing import Any

import coverage
import pytest

WHERE = "INNERVATE_COVER"
SETTINGS = """
[run]
data_file = {folder}/lines
source_pkgs = innervate
parallel = true
sigterm = true
core = {core}
disable_warnings = module-not-measured, no-data-collected, already-imported, no-sysmon-context
context = ${{PYTEST_CURRENT_TEST-}}
"""


NOTED = "noted.json"  # what the files were when lines were noted
MONITORS = hasattr(sys, "monitoring")


def digest(path: Path) -> str:
    """What a file is known by."""
    return hashlib.blake2b(path.read_bytes(), digest_size=10).hexdigest()


def folder() -> Path:
    """Where the lines are written."""
    return Path(os.environ[WHERE])


class Recorder:
    """Notes lines and times, in the process that runs tests."""

    def __init__(self) -> None:
        self.took_s: dict[str, float] = defaultdict(float)
        self.failed: set[str] = set()
        self.lines = coverage.Coverage(config_file=str(folder() / "settings"))
        self.lines.start()

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item, nextitem: pytest.Item | None) -> Any:
        self._switch(item.nodeid)
        try:
            return (yield)
        finally:
            self._switch("between")

    def _switch(self, context: str) -> None:
        self.lines.switch_context(context)
        if MONITORS:
            sys.monitoring.restart_events()  # lines that ran before count in this test, too

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.took_s[report.nodeid] += report.duration
        if report.failed:
            self.failed.add(report.nodeid)

    def pytest_sessionfinish(self) -> None:
        self.lines.stop()
        self.lines.save()
        text = json.dumps({"took_s": self.took_s, "failed": sorted(self.failed)})
        (folder() / f"times-{os.getpid()}.json").write_text(text)


def pytest_configure(config: pytest.Config) -> None:
    """Start, in workers or where there are none; what is started from here notes its lines, too."""
    folder().mkdir(parents=True, exist_ok=True)
    settings = folder() / "settings"
    core = "sysmon" if MONITORS else "ctrace"
    settings.write_text(SETTINGS.format(folder=folder(), core=core))
    if hasattr(config, "workerinput") or not config.getoption("numprocesses", None):
        os.environ["COVERAGE_PROCESS_START"] = str(settings)  # for what tests start
        config.pluginmanager.register(Recorder())


class Covered:
    """What a run noted.

    Args:
        where: the folder that it wrote to.
        root: of the project, as it ran.
    """

    def __init__(self, where: Path, root: Path) -> None:
        self.root = root
        self._data = coverage.CoverageData(str(where / "lines"))
        for part in sorted(where.glob("lines.*")):
            data = coverage.CoverageData(str(part))
            with contextlib.suppress(coverage.exceptions.CoverageException):  # a killed process
                data.read()
                self._data.update(data)
        self.took_s: dict[str, float] = {}
        failed: set[str] = set()
        for path in where.glob("times-*.json"):
            times = json.loads(path.read_text())
            self.took_s |= times["took_s"]
            failed.update(times["failed"])
        for test in failed:  # what fails without a fault finds none
            self.took_s.pop(test, None)
        self._noted: dict[str, str] = json.loads((where / NOTED).read_text())
        self._of_file: dict[str, dict[int, frozenset[str]]] = {}

    def tests_of(self, path: str, line: int) -> frozenset[str]:
        """Tests that run a line of a file; of a file that was edited since, any line."""
        if self._noted.get(path) != digest(self.root / path):
            return self.tests_of_file(path)
        return self._lines(path).get(line, frozenset())

    def tests_of_file(self, path: str) -> frozenset[str]:
        """Tests that run anything of a file, while they run."""
        return frozenset().union(*self._lines(path).values())

    def _lines(self, path: str) -> dict[int, frozenset[str]]:
        if path not in self._of_file:
            found = self._data.contexts_by_lineno(str((self.root / path).resolve()))
            self._of_file[path] = {
                line: frozenset(map(self._test, contexts)) & self.took_s.keys()
                for line, contexts in found.items()
            }
        return self._of_file[path]

    @staticmethod
    def _test(context: str) -> str:
        """The test's name; contexts of other processes say the phase as well."""
        return re.sub(r" \((setup|call|teardown)\)$", "", context)
