"""What a skin's own events leave of it, as far as a plan alone tells."""

from __future__ import annotations

from array import array
from dataclasses import replace

from innervate.networks.skin.scenario.plan import Plan
from innervate.networks.skin.scenario.targets import hit
from innervate.scenario.actions.cables import CUT, KILL, RESTART, RESTORE, REVIVE, TABLE
from innervate.scenario.cables import Fault, fault_words
from innervate.scenario.events import Harmed
from innervate.topology.graph import UNREACHABLE
from innervate.topology.patch import NOTHING

WHY = {
    CUT: "it is cut already",
    RESTORE: "it is not cut",
    KILL: "it is off already",
    REVIVE: "it is on",
    RESTART: "it is off, and stays so",
}


def foreseen(made: Plan) -> list[str]:
    """Events that change nothing, and cells that have no way when all have happened."""
    if not made.faults or made.script:
        return []
    off, cut, idle = _played(made)
    depths = _depths(made, off, cut)
    on = [depth for cell, depth in enumerate(depths) if cell not in off]
    apart = sum(depth == UNREACHABLE for depth in on)
    most = made.params["max_depth"]
    deep = sum(depth > most for depth in on)
    whole = len(depths)
    found = [f"{fault_words(made, fault)}: {why}, so nothing happens" for fault, why in idle]
    if not on:
        found.append("all cells are off at the end")
    if apart:
        found.append(f"at the end no cable joins {apart:,} of {whole:,} cells with the PC")
    if deep:
        found.append(
            f"at the end {deep:,} of {whole:,} cells {'is' if deep == 1 else 'are'} more than "
            f"{most} hop{'' if most == 1 else 's'} from the PC, and can have no way; raise "
            "protocol.max_depth"
        )
    return found


def _played(made: Plan) -> tuple[set[int], set[int], list[tuple[Fault, str]]]:
    """(cells that are off, cables that are cut, by an end, at the end; events in vain, and why)."""
    harmed, idle = Harmed(TABLE), []
    off = harmed.by["kill"]
    for fault in made.faults:
        action, what = TABLE[fault.action], hit(made.graph, fault.end, fault.node)
        is_vain = what in off  # a cell that is off does not restart
        if action.harms or action.mends:
            is_vain = (what in harmed.by[action.mends or action.word]) == action.harms
        if is_vain and fault.action in WHY:
            idle.append((fault, WHY[fault.action]))
        harmed.note(action.word, what)
    return off, harmed.by["cut"], idle


def _depths(made: Plan, off: set[int], cut: set[int]) -> array[int]:
    """Hops of every cell to the PC, without these cells and cables."""
    graph = made.graph
    peer = array("i", graph.peer)
    for end in (*cut, *(end for cell in off for end in graph.ends_of(cell))):
        if peer[end] >= 0:
            peer[peer[end]] = NOTHING
            peer[end] = NOTHING
    return replace(graph, peer=peer).depths()
