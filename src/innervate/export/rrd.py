"""A run for Rerun's viewer (rerun.io): its network in space, coloured by what it did.

Every entity has the timeline `sim_time`, the duration since the start of the simulation. What did
not change has no row: the viewer shows the newest one before.
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from innervate.export import files, recording
from innervate.export.errors import ExportError
from innervate.export.rrd_parts import Column, Parts
from innervate.network import networks

TIMELINE = "sim_time"
WARNING = recording.WARNING
LOG = "events"


def check(plan: Any) -> None:
    """Say whether there is something to show.

    Raises:
        ExportError: the network has no places, or shows none.
        ModuleNotFoundError: Rerun's package is missing.
    """
    if not networks()[plan.kind].has_places(plan):
        raise ExportError(f"--rerun has no view in space of this {plan.kind}; try --mcap")
    import rerun  # noqa: F401


def write(plan: Any, found: Mapping[str, Any], path: Path) -> int:
    """Write a recording, whole or not at all, of a run's tables (polars); how many rows it has.

    Raises:
        ExportError: as check() says, or the file cannot be written.
    """
    import rerun
    import rerun.blueprint as views

    check(plan)
    made: Parts = networks()[plan.kind].rerun_parts(rerun, plan, found)
    told = [*recording.events(plan)]
    log = sorted([*made.log, *((at, one["message"], one["level"]) for at, one in told)])
    with files.beside(path) as fresh:
        stream = rerun.RecordingStream("innervate")
        stream.save(fresh, default_blueprint=_arranged(views, made))
        stream.send_recording_name(f"{plan.scenario.name}, seed {plan.scenario.seed}")
        for name, thing in made.still:
            stream.log(name, thing, static=True)
        count = sum(_send(rerun, stream, column) for column in made.columns)
        if log:
            levels = ["WARN" if level >= WARNING else "INFO" for _, _, level in log]
            texts = rerun.TextLog.columns(text=[text for _, text, _ in log], level=levels)
            stream.send_columns(LOG, [_times(rerun, [at for at, _, _ in log])], texts)
        stream.disconnect()
    return count + len(log)


def _times(rerun: Any, times_us: Iterable[int]) -> Any:
    moments = np.fromiter(times_us, np.int64) * 1000
    return rerun.TimeColumn(TIMELINE, duration=moments.astype("timedelta64[ns]"))


def _send(rerun: Any, stream: Any, column: Column) -> int:
    if column.times_us:
        stream.send_columns(column.name, [_times(rerun, column.times_us)], column.content)
    return len(column.times_us)


def _arranged(views: Any, made: Parts) -> Any:
    """The views of the viewer: tabs in space above, curves and what happened below."""
    space = [
        views.Spatial3DView(name=name, origin="/", contents=_paths(entities))
        for name, entities in made.views
    ]
    below = [views.TextLogView(name="Events", origin=f"/{LOG}")]
    if made.curves:
        below.insert(0, views.TimeSeriesView(name="Curves", contents=_paths(made.curves)))
    whole = views.Vertical(views.Tabs(*space), views.Horizontal(*below), row_shares=[3, 1])
    return views.Blueprint(whole)


def _paths(entities: Sequence[str]) -> list[str]:
    return [f"+ /{entity}" for entity in entities]
