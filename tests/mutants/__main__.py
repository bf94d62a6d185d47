"""`make mutants`: plants faults, one at a time, and says how many the tests found, by room.

What was done is kept in the folder, so that a second call goes on where the first ended.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import subprocess
import sys
import tomllib
from collections import Counter
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from tests.mutants.draw import Fault, drawn
from tests.mutants.trial import FOUND, Bench, Outcome

ROOT = Path(__file__).resolve().parents[2]
EQUIVALENT = Path(__file__).with_name("equivalent.toml")
Tried = tuple[Fault, Outcome]
Before = dict[tuple[str, str, str, str, int], Outcome]  # by the key of the fault


def main() -> int:
    """Draw, try, report; 1 if fewer were found than asked for."""
    asked = arguments()
    work = asked.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    chosen = drawn(ROOT, asked.seed, asked.count)
    if asked.room:
        chosen = [fault for fault in chosen if fault.room == asked.room]
    kept = work / f"tried-{asked.seed}.jsonl"
    before = read(kept)
    if asked.again:
        before = {key: outcome for key, outcome in before.items() if outcome.verdict == FOUND}
    left = [fault for fault in chosen if fault.key not in before]
    tried = [(fault, before[fault.key]) for fault in chosen if fault.key in before]
    if left:
        bench = Bench(ROOT, work, asked.budget_s, compiled(asked.workers))
        tried += try_all(left, bench, kept, asked.workers)
    return report(tried, asked.least)


def arguments() -> argparse.Namespace:
    """What the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="of the draw")
    parser.add_argument("--count", type=int, default=300, help="faults to draw")
    parser.add_argument("--room", help="only those of one room: analysis, live, plot ...")
    parser.add_argument("--again", action="store_true", help="try those anew that were not found")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--budget-s", type=float, default=40.0, help="of tests for one fault")
    parser.add_argument("--least", type=float, default=0.0, help="share that has to be found")
    parser.add_argument("--work", type=Path, default=ROOT / ".mutants", help="where it is kept")
    return parser.parse_args()


def compiled(workers: int) -> Path | None:
    """Where compiled code is kept, once what many tests run is compiled."""
    if not (ROOT / "tests/loops.py").exists():
        return None
    command = [sys.executable, "-m", "tests.loops", str(workers)]
    subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    asking = "from innervate.kernel import compilation; print(compilation.open_cache())"
    return Path(subprocess.check_output([sys.executable, "-c", asking], text=True).strip())


def try_all(chosen: list[Fault], bench: Bench, kept: Path, workers: int) -> list[Tried]:
    """Try faults side by side, in processes that are forked from this one."""
    tried = []
    context = multiprocessing.get_context("fork")
    with ProcessPoolExecutor(workers, context) as pool, kept.open("a", encoding="utf-8") as file:
        jobs = {pool.submit(bench.try_out, fault): fault for fault in chosen}
        for job in as_completed(jobs):
            fault, outcome = jobs[job], job.result()
            tried.append((fault, outcome))
            about = f"{len(tried)}/{len(chosen)} {outcome.verdict} ({outcome.took_s:.0f} s)"
            print(f"{about}: {fault} {outcome.by}", flush=True)
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
    names = ("path", "line", "old", "new")
    found = [one for one in same if (*(one[n] for n in names), one.get("nth", 0)) == fault.key]
    return str(found[0]["why"]) if found else None


if __name__ == "__main__":
    sys.exit(main())
