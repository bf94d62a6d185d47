"""A sweep that was run, from its folder."""

from __future__ import annotations

import json
import os
from pathlib import Path

from innervate.sweeping import tables
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
        results, timings = (
            polars.read_parquet(path / name) for name in (tables.RESULTS, tables.TIMINGS)
        )
        complete = bool(origin["complete"])
    except FileNotFoundError as error:
        name = Path(str(error.filename or "")).name or tables.RESULTS
        raise SweepError(f"{path} is not a finished sweep's folder: it has no {name}") from None
    except (OSError, ValueError, KeyError, TypeError, polars.exceptions.PolarsError):
        raise SweepError(f"{path} is damaged; give its sweep again") from None
    plan = make_plan(path / "sweep.toml")
    return Sweep(plan, results, timings, complete, written=path)
