"""What runs and paper tables give, kept as data: the judge of a change that is to change nothing.

`python -m tests.recorded.record` measures everything anew and writes `runs.json`, and of each paper
in its small size the table and what every piece of work gave; `--check` compares instead, and names
what differs. The tests read the same files.
"""

from __future__ import annotations

import argparse
import csv
import gzip
import json
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import innervate
from innervate import scenario as scenarios
from innervate.papers import book
from innervate.papers.experiment import Point, columns
from innervate.papers.store import Store, stamp
from innervate.sweeping.planfile import is_plan

HERE = Path(__file__).resolve().parent
RUNS, TABLES = HERE / "runs.json", HERE / "papers"
EXAMPLES = HERE.parents[1] / "examples"
OF_THE_MACHINE = ("wall_s", "events_per_s")

# Run uncompiled as well: those that take seconds that way. The compiled runs hold the others, and
# test_parity.py of each network holds every loop plain against compiled.
PLAIN = (
    "line", "loop-three", "loop-five", "setup-4", "demo",
    "radio-disaster", "radio-figure-1", "radio-saturated", "radio-churn",
    "mesh-document", "mesh-field", "mesh-team", "own-links",
)  # fmt: skip


def sources() -> dict[str, Path]:
    """Every bundled scenario and every example that is one, by name."""
    found = {name: Path(path) for name, path in scenarios.bundled().items()}
    for path in sorted(EXAMPLES.glob("*.toml")):
        if not is_plan(path.read_text(encoding="utf-8")):
            found[path.stem] = path
    return found


def measure(path: Path, plain: bool = False) -> dict[str, Any]:
    """Summary of a run without what depends on the machine; the fingerprint is part of it."""
    summary = innervate.run(path, plain=plain).summary
    kept = {key: value for key, value in summary.items() if key not in OF_THE_MACHINE}
    found: dict[str, Any] = json.loads(json.dumps(kept))
    return found


def paper(system: str, folder: Path) -> tuple[str, dict[str, Any]]:
    """A paper in its small size: its table as CSV, what each piece of work gave by its key."""
    book.main(system, folder, quick=True)
    text = (folder / f"papers-{system}.csv").read_text(encoding="utf-8")
    return text, Store(folder / book.RESULTS, stamp()).values


def recorded_results(system: str) -> dict[str, Any]:
    """What each piece of a paper's work in its small size gave, by its key."""
    with gzip.open(TABLES / f"{system}.jsonl.gz", "rt", encoding="utf-8") as file:
        return {entry["key"]: entry["value"] for entry in map(json.loads, file)}


def keep_results(system: str, values: dict[str, Any]) -> None:
    """Write what `recorded_results` reads."""
    lines = [json.dumps({"key": key, "value": values[key]}) + "\n" for key in sorted(values)]
    packed = gzip.compress("".join(lines).encode(), 9, mtime=0)
    (TABLES / f"{system}.jsonl.gz").write_bytes(packed)


def lay_out(system: str, folder: Path) -> None:
    """The recorded results as a paper of the present sources finds them: nothing is to be run."""
    store = Store(folder / book.RESULTS, stamp())
    for key, value in recorded_results(system).items():
        store.put(key, value)


def seed_cost_s(point: Point) -> float:
    """About how long `once_more` takes."""
    run = point.work
    is_series = isinstance(run, partial) and run.func is columns
    return point.cost_s / (len(run.args[2]) if is_series else 1)


def once_more(point: Point, recorded: Any) -> tuple[Any, Any]:
    """A piece of work run again, and what is recorded of it; of a series the first seed."""
    run = point.work
    if not isinstance(run, partial) or run.func is not columns:
        found = run()
    else:
        measure, case, seeds = run.args
        found = columns(measure, case, seeds[:1])
        recorded = (
            {name: column[:1] for name, column in recorded.items()}
            if isinstance(recorded, dict) else recorded[:1]
        )  # fmt: skip
    return json.loads(json.dumps(found)), recorded


def differences(name: str, recorded: Any, found: Any) -> list[str]:
    """Where two summaries differ, one line each, with both values."""
    if isinstance(recorded, dict) and isinstance(found, dict):
        return [
            line
            for key in sorted({*recorded, *found})
            for line in differences(
                f"{name}.{key}", recorded.get(key, "(nothing)"), found.get(key, "(nothing)")
            )
        ]
    same = type(recorded) is type(found) and recorded == found
    return [] if same else [f"{name}: was {recorded!r}, is {found!r}"]


def recorded_runs() -> dict[str, Any]:
    """The summaries as they were recorded, by scenario."""
    found: dict[str, Any] = json.loads(RUNS.read_text(encoding="utf-8"))
    return found


def rows_of(text: str) -> dict[str, Any]:
    """A table's rows by figure and claim."""
    rows = list(csv.DictReader(text.splitlines()))
    return {f"{row['figure']}: {row['claim']}": row for row in rows}


def _runs(check: bool) -> list[str]:
    found = {}
    for name, path in sources().items():
        print(f"run {name}", flush=True)
        found[name] = measure(path)
        if name in PLAIN:
            lost = differences(f"{name} (plain)", found[name], measure(path, plain=True))
            if lost:
                raise SystemExit("\n".join(["compiled and plain differ:", *lost]))
    if check:
        return differences("runs", recorded_runs(), found)
    RUNS.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    return []


def _papers(check: bool) -> list[str]:
    lost = []
    TABLES.mkdir(exist_ok=True)
    for system in book.papers():
        print(f"papers {system}", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            text, values = paper(system, Path(folder))
        kept = TABLES / f"{system}.csv"
        if check:
            lost += differences(system, rows_of(kept.read_text(encoding="utf-8")), rows_of(text))
            lost += differences(system, recorded_results(system), values)
        else:
            kept.write_text(text, encoding="utf-8")
            keep_results(system, values)
    return lost


def main() -> int:
    """Write the records, or compare with them."""
    parser = argparse.ArgumentParser(description=__doc__, prog="python -m tests.recorded.record")
    parser.add_argument("--check", action="store_true", help="compare; write nothing")
    check = parser.parse_args().check
    lost = _runs(check) + _papers(check)
    print("\n".join(lost) if lost else "all the same" if check else "written")
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
