"""`make mutants`: plants faults in copies of this tree, and says how many the tests found, by room.

First the tests run once with their lines noted; then every fault is tried with those that run its
line. What was done is kept in the folder, so that a second call goes on where the first ended.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from functools import partial
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from tests.mutants import cover
from tests.mutants.draw import Fault, drawn
from tests.mutants.trial import FOUND, Copy, Outcome, tests_for

ROOT = Path(__file__).resolve().parents[2]
EQUIVALENT = Path(__file__).with_name("equivalent.toml")
Tried = tuple[Fault, Outcome]
Choose = Callable[[Fault], tuple[list[str], float]]  # which tests, and how long they took
Before = dict[tuple[str, str, str, str, int], Outcome]  # by the key of the fault


def main() -> int:
    """Draw, try, report; 1 if fewer were found than asked for."""
    asked = arguments()
    work = asked.work.resolve()
    chosen = drawn(ROOT, asked.seed, asked.count)
    if asked.room:
        chosen = [fault for fault in chosen if fault.room == asked.room]
    copies = [Copy(ROOT, work / f"copy-{number}") for number in range(asked.workers)]
    covered = cover.Covered(lines_noted(work, copies[0], asked.workers), copies[0].folder)
    kept = work / f"tried-{asked.seed}.jsonl"
    before = read(kept)
    if asked.again:
        before = {key: outcome for key, outcome in before.items() if outcome.verdict == FOUND}
    choose = partial(tests_for, covered=covered, budget_s=asked.budget_s)
    tried = try_all(chosen, before, choose, kept, copies)
    return report(tried, asked.least)


def arguments() -> argparse.Namespace:
    """What the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="of the draw")
    parser.add_argument("--count", type=int, default=300, help="faults to draw")
    parser.add_argument("--room", help="only those of one room: analysis, live, plot ...")
    parser.add_argument("--again", action="store_true", help="try those anew that were not found")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--budget-s", type=float, default=60.0, help="of tests for one fault")
    parser.add_argument("--least", type=float, default=0.0, help="share that has to be found")
    parser.add_argument("--work", type=Path, default=ROOT / ".mutants", help="where it is kept")
    return parser.parse_args()


def lines_noted(work: Path, copy: Copy, workers: int) -> Path:
    """Note which test runs which line: all tests at first, then those whose file is another."""
    where = work / "lines"
    noted = where / cover.NOTED
    before = json.loads(noted.read_text()) if noted.exists() else {}
    now = {name: cover.digest(copy.folder / name) for name in copy.names if name.endswith(".py")}
    tests = [name for name in now if is_test(name) and now[name] != before.get(name)]
    if tests:
        print(f"Noting which lines run in {len(tests)} test files (all: as long as two runs) ...")
        command = [sys.executable, "-m", "pytest", "-q", "-m", "not slow", "-n", str(workers),
                   "--dist", "worksteal", "-p", "tests.mutants.cover", *tests]  # fmt: skip
        env = copy.env | {cover.WHERE: str(where)}
        loops = [sys.executable, "-m", "tests.loops", str(workers)]
        if "tests/loops.py" in copy.names:
            subprocess.run(loops, cwd=copy.folder, env=copy.env, check=False)
        subprocess.run(command, cwd=copy.folder, env=env, check=False)
        sources = {name: value for name, value in before.items() if not is_test(name)}
        kept = sources or {name: value for name, value in now.items() if not is_test(name)}
        noted.write_text(json.dumps(kept | {name: now[name] for name in now if is_test(name)}))
    return where


def is_test(name: str) -> bool:
    """True for a file of tests."""
    return name.startswith("tests/") and Path(name).name.startswith("test_")


def try_all(
    chosen: list[Fault], before: Before, choose: Choose, kept: Path, copies: list[Copy]
) -> list[Tried]:
    """Try what was not tried before, in copies side by side."""
    free: SimpleQueue[Copy] = SimpleQueue()
    for copy in copies:
        free.put(copy)

    def one(fault: Fault) -> Tried:
        copy = free.get()
        try:
            return fault, copy.try_out(fault, *choose(fault))
        finally:
            free.put(copy)

    tried = [(fault, before[fault.key]) for fault in chosen if fault.key in before]
    left = [fault for fault in chosen if fault.key not in before]
    with ThreadPoolExecutor(len(copies)) as pool, kept.open("a", encoding="utf-8") as file:
        for job in as_completed([pool.submit(one, fault) for fault in left]):
            fault, outcome = job.result()
            tried.append((fault, outcome))
            print(f"{len(tried)}/{len(chosen)} {outcome.verdict}: {fault} {outcome.by}", flush=True)
            file.write(json.dumps([fault, outcome]) + "\n")
            file.flush()
    return tried


def read(kept: Path) -> Before:
    """What was tried before; of the same fault the last."""
    if not kept.exists():
        return {}
    lines = map(json.loads, kept.read_text(encoding="utf-8").splitlines())
    return {Fault(*fault).key: Outcome(*outcome) for fault, outcome in lines}


def report(tried: list[Tried], least: float) -> int:
    """The share found by room, and those that were not."""
    same = equivalents()
    counted = [(fault, outcome) for fault, outcome in tried if why(fault, same) is None]
    total, found = Counter[str](), Counter[str]()
    for fault, outcome in counted:
        total[fault.room] += 1
        found[fault.room] += outcome.verdict == FOUND
    print("\n| room | planted | found | share |\n|---|---:|---:|---:|")
    for room in sorted(total):
        print(f"| {room} | {total[room]} | {found[room]} | {found[room] / total[room]:.0%} |")
    share = found.total() / max(1, total.total())
    print(f"| all | {total.total()} | {found.total()} | {share:.1%} |")
    print(f"\n{len(tried) - len(counted)} more change nothing that can be seen (equivalent.toml)")
    for fault, outcome in counted:
        if outcome.verdict != FOUND:
            print(f"{outcome.verdict}: {fault} ({outcome.tests} tests)")
    return int(share < least)


def equivalents() -> list[dict[str, Any]]:
    """Faults that change nothing that can be seen, each with the reason."""
    found: list[dict[str, Any]] = tomllib.loads(EQUIVALENT.read_text(encoding="utf-8"))["fault"]
    return found


def why(fault: Fault, same: list[dict[str, Any]]) -> str | None:
    """Why a fault changes nothing; None if it does."""
    wanted = (fault.path, fault.text, fault.old, fault.new)
    found = [one for one in same if (one["path"], one["line"], one["old"], one["new"]) == wanted]
    return str(found[0]["why"]) if found else None


if __name__ == "__main__":
    sys.exit(main())
