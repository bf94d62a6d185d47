"""Events of a skin and what came of them, in plain words."""

from collections.abc import Iterable, Mapping
from typing import Any

from innervate.kernel.words import number_of
from innervate.plot.happened import NODES, cable_words
from innervate.plot.words import ms_words
from innervate.scenario.actions.cables import ACTIONS
from innervate.scenario.cables import Fault
from innervate.topology import PORTS, Graph

LOST = {
    "cut": "on a cut cable",
    "noise": "noise or a loose plug",
    "off": "cell switched off",
    "queue_full": "queue full",
    "broken_link": "queue of a broken port",
    "no_route": "no known way to the PC",
    "loop": "after too many hops",
}
MISSED = {
    "off": "switched off",
    "no_route": "without a way to the PC",
    "on_the_way": "had a way, but it was lost on it",
}


def unkept(result: Any) -> list[str]:
    """That samples came of which none was kept, and how to keep them; nothing if all is there."""
    if result.has_deliveries or not result.plan.data_period_us:
        return []
    return ["Samples were counted, not kept: no received.parquet, no pictures of touch; of more "
            "than 1,000,000 only innervate.run(..., received=True) keeps them."]  # fmt: skip


def early_words(lost: int, early: int) -> str:
    """How many of the lost samples are no loss to the headline; "" = none."""
    if not early:
        return ""
    which = f"{early:,} of them " if early < lost else "all " if lost > 1 else ""
    return f"{which}before cells had a way for the first time"


def end_words(graph: Graph, end: int) -> str:
    """A cable by one of its ends: "cable to interface 1" or "cable p0 r1 c2 E - p0 r1 c3 W"."""
    far = graph.peer[end]
    for one in (end, far):
        if one >= PORTS * graph.cells:
            return f"cable to interface {one - PORTS * graph.cells}"
    return f"cable {graph.label_end(end)} - {graph.label_end(far)}"


def fault_words(graph: Graph, fault: Fault) -> str:
    """What happened: "cable to interface 1 cut"."""
    action = ACTIONS[fault.action]
    if fault.end >= 0:
        return f"{end_words(graph, fault.end)} {cable_words(action, fault)}"
    node = "the PC" if fault.node == graph.sink else f"cell {graph.label(fault.node)}"
    return f"{node} {NODES[action]}"


def headline(graph: Graph, fault: Fault, recovery: Mapping[str, Any], still: str = "") -> str:
    """One event and what came of it, as a sentence; `still`: see outcome()."""
    what = fault_words(graph, fault)
    begin = f"{what[0].upper()}{what[1:]} at {recovery['at_s']:.3f} s"
    return f"{begin}: {outcome(recovery, still)}."


def outcome(recovery: Mapping[str, Any], still: str = "") -> str:
    """What came of an event: noticed when, all routed when.

    `still` says it where cells that cables reach were not all routed again: "3 cells still had no
    way at the end".
    """
    detected, settled = recovery.get("detected_ms"), recovery.get("converged_ms")
    routed = recovery.get("others_ms", recovery.get("routed_ms"))
    gone, all_gone = recovery.get("cut_off", 0), recovery.get("cut_off_total", 0)
    parts = []
    if detected is not None:
        parts.append(f"noticed after {ms_words(detected)}")
    if gone:
        them, were = ("it", "was") if gone == 1 else ("them", "were")
        what = f"{were} cut off, as no cable joined {them} with the PC any more"
        parts.append(f"{number_of(gone, 'cell')} {what}")
    whom = "every other cell" if all_gone or recovery.get("action") == "kill" else "every cell"
    if routed is not None and routed > 0:
        parts.append(f"{whom} had a way again after {ms_words(routed)}")
    elif routed is not None:
        parts.append(f"{whom} kept its way to the PC")
        if settled:
            parts.append(f"the last one changed it after {ms_words(settled)}")
    elif recovery.get("without_way") == 0 and not all_gone:
        parts.append("no cell was on any more")
    elif not all_gone or recovery.get("without_way"):
        parts.append(still or _lacking(recovery.get("without_way")))
    if all_gone > gone:
        parts.append(f"{number_of(all_gone - gone, 'cell')} stayed cut off")
    return ", ".join(parts)


def _lacking(cells: int | None) -> str:
    """Cells that a cable path would reach, but that have no way."""
    who = "some cells" if cells is None else number_of(cells, "cell")
    return f"{who} still had no way to the PC by the next event or the end"


def broken_cables(broken: Iterable[Mapping[str, Any]]) -> list[str]:
    """The cables behind a summary's `broken`, each once although both its ends may notice."""
    since: dict[frozenset[str], float | None] = {}
    names: dict[frozenset[str], str] = {}
    for port in broken:
        here, there = f"{port['cell']} {port['port']}", str(port.get("to") or "")
        cable = frozenset((here, there))
        times = [t for t in (since.get(cable), port.get("since_s")) if t is not None]
        since[cable] = min(times, default=None)
        if there.startswith("pc."):
            names[cable] = f"cable from interface {there[3:]} to {here}"
        else:
            names.setdefault(cable, f"cable {here} - {there}" if there else f"cable at {here}")
    return [
        name if (at := since[cable]) is None else f"{name}, since {at:.3f} s"
        for cable, name in names.items()
    ]
