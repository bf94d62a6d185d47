"""What runs and paper tables give, kept as data: the judge of a change that is to change nothing.

`python -m tests.recorded.record` measures everything anew and writes `runs.json`, the tables of
`papers/` and the rows that they were made of; `--check` compares instead, and names what differs.
The tests read the same files. What is drawn of all that is kept by `tests.recorded.pictures`.
"""

from __future__ import annotations

import argparse
import csv
import gzip
import json
import math
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import innervate
from innervate import scenario as scenarios
from innervate.papers import book
from innervate.papers.experiment import Point, columns
from innervate.papers.store import Store
from innervate.sweeping.planfile import is_plan
from innervate.trace.sources import stamp

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


def table(system: str, folder: Path) -> str:
    """The table of a paper in its small size, as CSV."""
    book.main(system, folder, quick=True)
    return (folder / f"papers-{system}.csv").read_text(encoding="utf-8")


def rows(system: str) -> dict[str, Any]:
    """What the runs of a paper in its small size left, by point."""
    text = gzip.decompress((TABLES / f"{system}.rows.gz").read_bytes()).decode()
    found: dict[str, Any] = json.loads(text)
    return found


def keep_rows(system: str, folder: Path) -> None:
    """Keep what a paper's run left in a folder."""
    values = Store(folder / book.RESULTS, "", any_stamp=True).values
    text = json.dumps({key: values[key] for key in sorted(values)}, separators=(",", ":"))
    (TABLES / f"{system}.rows.gz").write_bytes(gzip.compress(text.encode(), 9, mtime=0))


def lay_out(system: str, folder: Path) -> None:
    """The kept rows as a paper of the present sources finds them: nothing is left to be run."""
    store = Store(folder / book.RESULTS, stamp())
    for key, value in rows(system).items():
        store.put(key, value)


def seed_cost_s(point: Point) -> float:
    """About how long `once_more` takes."""
    run = point.work
    is_series = isinstance(run, partial) and run.func is columns
    return point.cost_s / (len(run.args[2]) if is_series else 1)


def once_more(point: Point, kept: Any) -> tuple[Any, Any]:
    """A piece of a paper's work run again, and what is kept of it; of a series the first seed."""
    run = point.work
    if isinstance(run, partial) and run.func is columns:
        measure_seed, case, seeds = run.args
        found = columns(measure_seed, case, seeds[:1])
        is_named = isinstance(kept, dict)
        kept = {name: all_[:1] for name, all_ in kept.items()} if is_named else kept[:1]
    else:
        found = run()
    return json.loads(json.dumps(found)), kept


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
    return [] if same(recorded, found) else [f"{name}: was {recorded!r}, is {found!r}"]


def same(recorded: Any, found: Any) -> bool:
    """True if nothing differs but the last digits of floats, which processors add up differently.

    What a run is known by, its fingerprint, is text and has to be the same on all of them.
    """
    if type(recorded) is not type(found):
        return False
    if isinstance(recorded, dict):
        return recorded.keys() == found.keys() and all(same(recorded[k], found[k]) for k in found)
    if isinstance(recorded, list):
        return len(recorded) == len(found) and all(map(same, recorded, found))
    if isinstance(recorded, float):
        return math.isclose(recorded, found, rel_tol=1e-12)
    return bool(recorded == found)


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
    for system in book.books():
        print(f"papers {system}", flush=True)
        kept = TABLES / f"{system}.csv"
        with tempfile.TemporaryDirectory() as folder:
            text = table(system, Path(folder))
            if check:
                was = rows_of(kept.read_text(encoding="utf-8"))
                lost += differences(system, was, rows_of(text))
                found = Store(Path(folder) / book.RESULTS, stamp()).values
                lost += differences(system, rows(system), found)
            else:
                kept.write_text(text, encoding="utf-8")
                keep_rows(system, Path(folder))
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
