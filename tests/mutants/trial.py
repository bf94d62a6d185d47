"""One planted fault after the other: which tests run its line, and whether one of them fails."""

from __future__ import annotations

import ast
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from innervate.kernel import compilation
from tests.mutants.cover import Covered
from tests.mutants.draw import SOURCES, Fault

COMPILING_S = 240.0  # more, in which loops are compiled anew
FOUND, SURVIVED, UNRUN = "found", "survived", "not run by any test"


class Outcome(NamedTuple):
    """What became of a fault.

    Attributes:
        verdict: FOUND, SURVIVED or UNRUN.
        by: the test that failed first, or what else went wrong.
        tests: how many tests there were to find it.
        took_s: how long they ran.
    """

    verdict: str
    by: str
    tests: int
    took_s: float


class Copy:
    """A copy of the project, in which faults are planted.

    Args:
        root: the project.
        folder: where the copy goes.

    Attributes:
        names: its files.
        env: with what processes run in it.
    """

    def __init__(self, root: Path, folder: Path) -> None:
        self.folder = folder
        listed = ["git", "ls-files", "-co", "--exclude-standard"]
        found = subprocess.check_output(listed, cwd=root, text=True).splitlines()
        self.names = [name for name in found if (root / name).is_file()]
        for name in self.names:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(root / name, folder / name)
        self.env = os.environ | {
            "PYTHONPATH": str(folder / "src"),
            "INNERVATE_CACHE": str(folder / ".compiled"),
            "PYTHONDONTWRITEBYTECODE": "",  # bytecode is kept: hundreds of processes start here
        }
        self._stamp = time.time_ns() // 10**9

    def run(self, tests: list[str], most_s: float) -> tuple[bool, str]:
        """Run tests; True and the first that failed, or False and nothing."""
        wanted = self.folder / ".tests"
        wanted.write_text("\n".join(tests))
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
        process = subprocess.Popen(
            [*command, f"@{wanted}"], cwd=self.folder, env=self.env, start_new_session=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )  # fmt: skip
        try:
            said, _ = process.communicate(timeout=most_s)
        except subprocess.TimeoutExpired:
            return True, f"no end within {most_s:.0f} s"
        finally:
            stop(process)
        if process.returncode == 0:
            return False, ""
        failed = re.search(r"^(?:FAILED|ERROR) (\S+(?: \[[^\]]*\])?)", said, re.MULTILINE)
        return True, failed[1] if failed else said.strip().splitlines()[-1][:200]

    def try_out(self, fault: Fault, tests: list[str], took_s: float) -> Outcome:
        """Plant a fault, run the tests, take it out again."""
        if not tests:
            return Outcome(UNRUN, "", 0, 0.0)
        path = self.folder / fault.path
        sound = path.read_bytes()
        started = time.monotonic()
        try:
            self._write(path, sound[: fault.start] + fault.new.encode() + sound[fault.end :])
            found, by = self.run(tests, COMPILING_S + 5 * took_s)
        finally:
            self._write(path, sound)
        verdict = FOUND if found else SURVIVED
        return Outcome(verdict, by, len(tests), round(time.monotonic() - started, 1))

    def _write(self, path: Path, source: bytes) -> None:
        """Write a source as of another second: bytecode is known by the second and the size."""
        path.write_bytes(source)
        self._stamp += 1
        os.utime(path, (self._stamp, self._stamp))


def stop(process: subprocess.Popen[Any]) -> None:
    """End a process and all that it started."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        return
    process.communicate()


def tests_for(fault: Fault, covered: Covered, budget_s: float) -> tuple[list[str], float]:
    """The tests to run, those of the file's own folder first; and how long they took.

    Args:
        fault: what is planted.
        covered: which tests run which lines.
        budget_s: of tests for one fault, as long as they took when nothing was planted.
    """
    tests = running(fault, covered)
    if is_compiled(fault.path):  # lines that run compiled are not noted
        folder = Path(fault.path).parent
        for path in sorted((covered.root / folder).glob("*.py")):
            tests = tests | covered.tests_of_file((folder / path.name).as_posix())
    chosen: list[str] = []
    total_s = 0.0
    for test in sorted(tests, key=lambda test: (-nearness(test, fault.path), covered.took_s[test])):
        if not chosen or total_s + covered.took_s[test] <= budget_s:
            chosen.append(test)
            total_s += covered.took_s[test]
    return chosen, total_s


def running(fault: Fault, covered: Covered) -> frozenset[str]:
    """Tests that run the statement; of what is run at import, those that use what it makes."""
    way = statements(covered.root / fault.path, fault.line)
    first = way[-1].lineno if way else fault.line
    lines = range(first, fault.line + 1)
    tests = frozenset[str]().union(*(covered.tests_of(fault.path, line) for line in lines))
    if tests:
        return tests
    names = {
        target.id
        for one in way if isinstance(one, ast.Assign | ast.AnnAssign)
        for target in (one.targets if isinstance(one, ast.Assign) else [one.target])
        if isinstance(target, ast.Name)
    }  # fmt: skip
    inside = [one for one in way if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef)]
    if inside and inside[-1].body[0].lineno > fault.line:  # a default of an argument
        body = range(inside[-1].body[0].lineno, (inside[-1].end_lineno or 0) + 1)
        return frozenset[str]().union(*(covered.tests_of(fault.path, line) for line in body))
    if inside:
        return frozenset()
    users = (users_of(covered.root, name) for name in names)
    return covered.tests_of_file(fault.path).union(
        *(covered.tests_of(path, line) for found in users for path, line in found)
    )


@cache
def users_of(root: Path, name: str) -> list[tuple[str, int]]:
    """Lines of the sources that name something."""
    word = re.compile(rf"\b{re.escape(name)}\b")
    return [
        (path.relative_to(root).as_posix(), number)
        for path in sorted((root / SOURCES).rglob("*.py"))
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if word.search(line)
    ]


def statements(path: Path, line: int) -> list[ast.stmt]:
    """The statements around a line, outermost first."""
    found: list[ast.stmt] = []
    inner: Any = ast.parse(path.read_bytes())
    while inner is not None:
        below = [one for one in ast.walk(inner) if isinstance(one, ast.stmt) and one is not inner]
        around = [one for one in below if one.lineno <= line <= (one.end_lineno or one.lineno)]
        inner = min(around, key=lambda one: (one.lineno, -(one.end_lineno or 0)), default=None)
        if inner is not None:
            found.append(inner)
    return found


def is_compiled(path: str) -> bool:
    """True for a file that compiled code comes from."""
    return Path(path).relative_to(SOURCES) in compiled_files()


@cache
def compiled_files() -> frozenset[Path]:
    """Files that compiled code comes from."""
    return frozenset(p.relative_to(compilation.ROOT) for p in compilation.source_files())


def nearness(test: str, path: str) -> int:
    """How much the place of a test has in common with that of a source."""
    words = set(re.split(r"[/_.]|::", test.split("[")[0]))
    if "recorded" in words:  # they look at all that comes out
        return 9
    parts = Path(path).relative_to(SOURCES).with_suffix("").parts
    return sum(part in words for part in parts)
