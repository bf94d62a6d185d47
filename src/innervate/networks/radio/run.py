"""What is particular to radio runs: the simulation, the summary, the tables."""

from collections.abc import Iterator, Mapping
from typing import Any

from innervate.dialect.access import CLOCK, LEAVE, RESULT
from innervate.networks.radio import tables as radio_tables
from innervate.networks.radio.analysis import summary as analysis
from innervate.networks.radio.analysis.summary_keys import RadioSummary, SlottedSummary
from innervate.networks.radio.protocol.constants import MAIN
from innervate.networks.radio.sim import simulate as simulator
from innervate.networks.radio.slotted import run as radio_slotted
from innervate.running import simulating
from innervate.sim.channel.loop import ON_CARRIER
from innervate.sim.status import ON_FRAME, ON_INPUT, ON_START, ON_TIMER
from innervate.trace.tables import Table, taken


def simulate(plan: Any, *, received: bool | None, **how: Any) -> Any:
    """Run a radio plan, on the level it asks for; `received` is for skins."""
    if _is_slotted(plan):
        return radio_slotted.simulate(plan, how["plain"])
    return simulator.simulate(plan, **how)


def _is_slotted(plan: Any) -> bool:
    return bool(plan.scenario.model.channel.level == "slotted")


def summarize(result: Any) -> RadioSummary | SlottedSummary:
    """The summary of a run; what never happened is None."""
    if _is_slotted(result.plan):
        return radio_slotted.summarize(result)
    return analysis.summarize(result)


def tables_of(result: Any) -> tuple[Table, ...]:
    """The tables of a run; the slotted level has none."""
    return () if _is_slotted(result.plan) else radio_tables.TABLES


written_of = tables_of


def columns(table: Table, result: Any) -> dict[str, Any]:
    """One array for every column of a table."""
    return taken(table, getattr(result, table.rows))


def trail(plan: Any, until_us: int) -> Iterator[Any]:
    """The trail of a plan: structured arrays with the fields of tables.TRAIL."""
    return iter(()) if _is_slotted(plan) else simulating.trail(plan, until_us)


def summary_name(summary: Mapping[str, Any]) -> str:
    """By what name a run has its summary."""
    return "slotted" if summary.get("level") == "slotted" else "radio"


def without_events(summary: Mapping[str, Any]) -> str:
    """Why a run has no events to compare; "" if it has."""
    slotted = summary.get("level") == "slotted"
    return "a run on the slotted level has no events to compare" if slotted else ""


def call_words(plan: Any, row: Any) -> str:
    """A row of the trail in words: "station 3: carrier came"."""
    handler, port = int(row["handler"]), int(row["port"])
    given = {LEAVE: "is to leave", RESULT: "is told who received its packet", CLOCK: "is told time"}
    what = {
        ON_START: "switched on",
        ON_FRAME: f"received a frame of type {port}",
        ON_TIMER: "a wait is over" if port == MAIN else "its minislot",
        ON_INPUT: given.get(port, "was offered a packet"),
        ON_CARRIER: ("hears nothing", "", "hears several", "hears one")[port & 3],
    }[handler]
    return f"station {int(row['node'])}: {what}"
