"""Which cells have no way to the PC at the end of a run: cut off, seeking one, switched off."""

from typing import Any

import numpy as np

from innervate.networks.skin.analysis.commands import missed_on_the_way
from innervate.networks.skin.analysis.frames import lost_at_start
from innervate.networks.skin.analysis.headline import SkinFacts
from innervate.networks.skin.analysis.rows import apart_steps, marks
from innervate.networks.skin.analysis.summary_keys import Apart, Data, Reach
from innervate.sim.cables.world import DEAD

LABELS_MAX = 100


def skin_facts(result: Any, data: Data) -> SkinFacts | None:
    """What a headline is made of; None of a run that nobody observed."""
    if len(marks(result).row) == 0:
        return None
    most = int(apart_steps(result).cells.max(initial=0))
    facts = world_facts(result.world, result.plan.graph.cells)
    return facts._replace(
        cut_off_before=most if most > len(facts.cut_off) else 0,
        sent=data["sent"],
        lost=data["lost"],
        early=lost_at_start(result),
    )


def world_facts(world: Any, cells: int) -> SkinFacts:
    """What an observed simulation says of its cells at the moment it stands at, data left out."""
    watch = world.watch
    alive, apart = np.array(world.alive), np.array(watch.apart)
    cut_off = apart >= 0
    seeking = (np.array(watch.joined) == 1) & (np.array(watch.routed) == 0)
    return SkinFacts(
        cells=cells,
        off=np.flatnonzero(alive[:cells] == DEAD).tolist(),
        cut_off=np.flatnonzero(cut_off).tolist(),
        seeking=np.flatnonzero(seeking).tolist(),
        never=np.flatnonzero(seeking & (np.array(watch.had) == 0)).tolist(),
        since_s=int(apart[cut_off].min()) / 1e6 if cut_off.any() else None,
        at_once=len(np.unique(apart[cut_off])) < 2,
        pc_off=int(alive[cells]) == DEAD,
        missed=missed_on_the_way(world, cells),
    )


def reach(result: Any, facts: SkinFacts | None) -> Reach:
    """Entries of a summary on cells that have no way to the PC at the end of a run; see `Reach`."""
    if facts is None:
        return {
            "cut_off": None, "without_way": None, "switched_off": None, "lost_at_start": None,
        }  # fmt: skip
    label = result.plan.graph.label

    def counted(nodes: Any) -> Apart:
        return {"cells": len(nodes), "labels": [label(node) for node in nodes[:LABELS_MAX]]}

    most = max(len(facts.cut_off), facts.cut_off_before)
    return {
        "cut_off": {**counted(facts.cut_off), "since_s": facts.since_s, "most": most},
        "without_way": {**counted(facts.seeking), "never": len(facts.never)},
        "switched_off": counted(facts.off),
        "lost_at_start": lost_at_start(result),
    }
