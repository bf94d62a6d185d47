"""A sweep that was run, from its folder."""

from __future__ import annotations

import json
import os
from hashlib import sha256
from pathlib import Path

from innervate.sweeping import tables
from innervate.sweeping.base import PLAN_FILE
from innervate.sweeping.errors import SweepError
from innervate.sweeping.result import Sweep
from innervate.sweeping.sweep import make_plan


def load_sweep(folder: str | os.PathLike[str]) -> Sweep:
    """A sweep from its folder; nothing is run.

    Raises:
        SweepError: it is no sweep's folder, or damaged.
    """
    import polars

    path = Path(folder)
    try:
        origin = json.loads((path / "provenance.json").read_text(encoding="utf-8"))
        written = (path / PLAN_FILE).read_bytes()
        results, timings = (
            polars.read_parquet(path / name) for name in (tables.RESULTS, tables.TIMINGS)
        )
        complete = bool(origin["complete"])
        planned, scenario = origin.get("plan"), origin["identity"]["the scenario"]
    except FileNotFoundError as error:
        name = Path(str(error.filename or "")).name or tables.RESULTS
        raise SweepError(f"{path} is not a finished sweep's folder: it has no {name}") from None
    except (OSError, ValueError, KeyError, TypeError, polars.exceptions.PolarsError):
        raise SweepError(f"{path} is damaged; give its sweep again") from None
    if planned not in (None, sha256(written).hexdigest()):
        raise SweepError(
            f"the tables in {path} are of another plan than its {PLAN_FILE}: its last sweep was "
            "killed before its end, or the file was changed; give that sweep again"
        )
    plan = make_plan(path / PLAN_FILE)
    if plan.identity()["the scenario"] != scenario:
        raise SweepError(f"{path / plan.base.file} is missing or was changed; give its sweep again")
    return Sweep(plan, results, timings, complete, written=path)
