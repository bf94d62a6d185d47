"""Runs of any network that has no module `run` of its own: its loop driven, its rows as tables.

Its `simulation` takes what is to be kept by name: plain, checks, observe, deliveries, trail, tap.
"""

from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Any

from innervate import folders
from innervate.analysis.summary import summarize
from innervate.network import networks
from innervate.running import blaming, playing
from innervate.scenario.declared.shared import refuse_script, script_of
from innervate.sim.counts import Counts
from innervate.sim.driver import Ended, InvariantBroken, Left, Simulation
from innervate.sim.status import ON_FRAME, ON_INPUT, ON_START, ON_TIMER
from innervate.sim.tables import get
from innervate.trace.tables import TIME, Column, Table, taken

__all__ = ["TABLES", "call_words", "columns", "simulate", "summarize", "tables_of", "trail",
           "written_of"]  # fmt: skip

_NODE = Column("node", "Int32", "node", "who")
REPORTS = Table("reports", "a node reported something", (
    TIME, _NODE,
    Column("code", "Int32", "number", "what, as the protocol numbers it"),
    Column("a", "Int64", "raw", "of the report"),
    Column("b", "Int64", "raw", "of the report"),
), rows="rows")  # fmt: skip
DELIVERIES = Table("deliveries", "a node's user was given a message", (
    TIME, _NODE,
    Column("port", "Int32", "port", "it came in on"),
    Column("latency_us", "Int64", "us", "since it was sent", "latency"),
), rows="deliveries")  # fmt: skip
TABLES = (REPORTS, DELIVERIES)


@dataclass(slots=True, kw_only=True)
class Result(Left):
    """What a simulation leaves when it ends."""

    # All rows of the loop's tables by their names, arrays of records, times in us.
    rows: dict[str, Any]
    counts: Counts  # of the medium
    handled: int  # handler calls


def simulation(plan: Any, **kept: bool) -> Simulation:
    """A plan's network, not yet begun."""
    refuse_script(plan)
    made: Simulation = networks()[plan.kind].simulation(plan, **kept)
    return made


def simulate(
    plan: Any,
    *,
    plain: bool = False,
    checks: bool = True,
    received: bool | None = None,
    progress: Callable[[int, int], None] | None = None,
    tap: Any = None,
) -> Result:
    """Run a plan; `received` is for skins: here summaries and measures are made of such rows.

    A script is played in place of the clock.

    Raises:
        ScenarioError: a script that is to be captured, or has a step that cannot be.
        InvariantBroken: a checker found what must not happen.
        NetworkError: in the protocol of a folder: with its file and line.
    """
    network = networks()[plan.kind]
    if script_of(plan) is not None and tap is None:
        with blaming.blaming(network) if network.folder is not None else nullcontext():
            return Result(**playing.play(plan))
    kept = {"checks": checks, "deliveries": True, "tap": tap is not None}
    if network.folder is None:
        running = simulation(plan, plain=plain, **kept)
        return _result(running, running.finish(progress, tap))
    if not plain:
        if network.in_plain:
            raise folders.NetworkError(network.in_plain)
        blaming.try_plain(network, plan, checks=checks)
    running = simulation(plan, plain=plain, **kept)
    watch = blaming.Watched(running, network) if plain else None
    try:
        with blaming.blaming(network, watch):
            ended = running.finish(progress, tap)
    except InvariantBroken as error:
        handled = int(get(running.world.run, 0, "handled"))
        blaming.again(network, plan, handled, error, checks=checks)
    return _result(running, ended)


def _result(running: Simulation, ended: Ended) -> Result:
    return Result(
        rows=ended.rows,
        counts=running.counts(),
        handled=int(get(running.world.run, 0, "handled")),
        **running.left(ended),
    )


def tables_of(result: Any) -> tuple[Table, ...]:
    """The tables of a run: of the rows that its loop keeps."""
    return tuple(table for table in TABLES if table.rows in result.rows)


written_of = tables_of


def columns(table: Table, result: Any) -> dict[str, Any]:
    """One array for every column of a table; what rows do not say is null."""
    rows = result.rows[table.rows]
    found = dict.fromkeys((column.name for column in table.columns), [None] * len(rows))
    found |= taken(table, rows)
    if "latency" in rows.dtype.names:
        found["latency_us"] = [us if us >= 0 else None for us in rows["latency"].tolist()]
    return found


def trail(plan: Any, until_us: int) -> Iterator[Any]:
    """The trail of a plan: structured arrays with the fields of tables.TRAIL."""
    return simulation(plan, checks=False, observe=False, trail=True).pieces("trail", until_us)


def call_words(plan: Any, row: Any) -> str:
    """A row of the trail in words: "node 3: frame on port 1"."""
    handler, port = int(row["handler"]), int(row["port"])
    what = {
        ON_START: "switched on" if port == 0 else "restarted",
        ON_FRAME: f"frame on port {port}",
        ON_TIMER: f"timer {port}",
        ON_INPUT: "given something by its user",
    }.get(handler, f"handler {handler}")
    return f"node {int(row['node'])}: {what}"
