"""What is computed and seldom looked at, kept as data: a change that is to change nothing keeps it.

`python -m tests.recorded.kept` measures everything anew and writes `kept/*.json`, which is read
before it is committed; `--check` compares instead and names what differs; `--only plans` does one.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from tests.recorded import declared, files, plans, simulated, wire
from tests.recorded.data import tidy
from tests.recorded.record import differences

FOLDER = Path(__file__).resolve().parent / "kept"
# What each file holds: pairs of a name and a function that measures it.
SUBJECTS = {
    "plans": plans.found,
    "declared": declared.found,
    "wire": wire.found,
    "files": files.found,
    "simulated": simulated.found,
}


@cache
def measures(subject: str) -> dict[str, Callable[[], Any]]:
    """How everything of a subject is measured, by name."""
    return dict(SUBJECTS[subject]())


@cache
def kept(subject: str) -> dict[str, Any]:
    """What was recorded, by name."""
    found: dict[str, Any] = json.loads((FOLDER / f"{subject}.json").read_text(encoding="utf-8"))
    return found


def compared(subject: str, name: str) -> list[str]:
    """What differs from what was recorded, one line each: key, was, is."""
    found = json.loads(json.dumps(measures(subject)[name]()))
    return differences(name, kept(subject).get(name, "(nothing)"), found)


def main() -> int:
    """Write what is measured, or compare."""
    parser = argparse.ArgumentParser(description=__doc__, prog="python -m tests.recorded.kept")
    parser.add_argument("--check", action="store_true", help="compare; write nothing")
    parser.add_argument("--only", choices=SUBJECTS, help="one of the subjects")
    told = parser.parse_args()
    lost = []
    for subject in [told.only] if told.only else SUBJECTS:
        if told.check:
            lost += [line for name in measures(subject) for line in compared(subject, name)]
            continue
        found = {name: measure() for name, measure in measures(subject).items()}
        (FOLDER / f"{subject}.json").write_text(tidy(found) + "\n", encoding="utf-8")
    print("\n".join(lost) if lost else "all the same" if told.check else "written")
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
