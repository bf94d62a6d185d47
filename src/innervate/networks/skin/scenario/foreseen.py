"""What a skin's own events leave of it, as far as a plan alone tells."""

from __future__ import annotations

from array import array
from dataclasses import replace

from innervate.networks.skin.scenario.plan import Plan
from innervate.scenario.actions.cables import CUT, KILL, RESTORE, REVIVE
from innervate.topology.graph import UNREACHABLE
from innervate.topology.patch import NOTHING


def foreseen(made: Plan) -> list[str]:
    """Cells that have no way when all events have happened, a sentence for each reason."""
    if not made.faults or made.script:
        return []
    off, depths = _left(made)
    on = [depth for cell, depth in enumerate(depths) if cell not in off]
    apart = sum(depth == UNREACHABLE for depth in on)
    most = made.params["max_depth"]
    deep = sum(depth > most for depth in on)
    whole = len(depths)
    found = []
    if not on:
        found.append("all cells are off at the end")
    if apart:
        found.append(f"at the end no cable joins {apart:,} of {whole:,} cells with the PC")
    if deep:
        found.append(
            f"at the end {deep:,} of {whole:,} cells are more than {most} hops from the PC, and "
            f"can have no way; raise protocol.max_depth"
        )
    return found


def _left(made: Plan) -> tuple[set[int], array[int]]:
    """(cells that are off, hops of every cell to the PC) when all events have happened."""
    graph = made.graph
    off: set[int] = set()
    cut: set[int] = set()
    for fault in made.faults:
        if fault.action in (KILL, REVIVE):  # a cell that is off does not restart
            (off.add if fault.action == KILL else off.discard)(fault.node)
        elif fault.action in (CUT, RESTORE):
            end = min(fault.end, graph.peer[fault.end])
            (cut.add if fault.action == CUT else cut.discard)(end)
    peer = array("i", graph.peer)
    for end in (*cut, *(end for cell in off for end in graph.ends_of(cell))):
        if peer[end] >= 0:
            peer[peer[end]] = NOTHING
            peer[end] = NOTHING
    return off, replace(graph, peer=peer).depths()
