"""Who is off, cut off, seeking a way: from tables of a world that are written here."""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.skin.analysis.headline import SkinFacts
from innervate.networks.skin.analysis.reach import LABELS_MAX, reach, world_facts
from innervate.networks.skin.sim import counters as words
from innervate.sim.cables.world import ALIVE, DEAD

CELLS = 4
NEVER = -1  # cut off: not


def world(**tables):
    """All cells and the PC are on, joined and routed, and have been."""
    watch = {"apart": [NEVER] * CELLS, "joined": [1] * CELLS, "routed": [1] * CELLS,
             "had": [1] * CELLS}  # fmt: skip
    alive = tables.pop("alive", [ALIVE] * (CELLS + 1))
    return Of(watch=Of(**watch | tables), alive=alive, counters=[0] * 64)


def one(value, others, at=2):
    return [value if i == at else others for i in range(CELLS)]


@pytest.mark.parametrize(("tables", "said"), [
    ({}, {}),
    ({"alive": [ALIVE, DEAD, ALIVE, DEAD, ALIVE]}, {"off": [1, 3]}),
    ({"alive": [ALIVE] * CELLS + [DEAD]}, {"pc_off": True}),
    ({"apart": one(0, NEVER), "joined": one(0, 1), "routed": one(0, 1)},
     {"cut_off": [2], "since_s": 0.0}),  # from the very beginning
    ({"apart": [NEVER, 2_500_000, 1_500_000, NEVER], "joined": [1, 0, 0, 1]},
     {"cut_off": [1, 2], "since_s": 1.5}),
    ({"routed": one(0, 1)}, {"seeking": [2]}),
    ({"routed": one(0, 1), "had": one(0, 1)}, {"seeking": [2], "never": [2]}),
    ({"had": one(0, 1)}, {}),  # it has a way
    ({"routed": one(0, 1), "joined": one(0, 1), "had": one(0, 1)}, {}),
])  # fmt: skip
def test_a_cell_is_in_the_list_that_its_tables_say(tables, said):
    found = world_facts(world(**tables), CELLS)
    assert found == SkinFacts(CELLS, [], (), [], [], [])._replace(**said)


@pytest.mark.parametrize(("count", "before", "most"), [(3, 0, 3), (3, 7, 7), (101, 0, 101)])
def test_a_summary_names_a_hundred_and_counts_all(count, before, most):
    graph = Of(label=lambda node: f"c{node}")
    counters = np.zeros(64, np.int64)
    counters[words.EARLY] = 5
    result = Of(plan=Of(graph=graph), counters=counters)
    facts = SkinFacts(500, off=[7], cut_off=list(range(count)), seeking=[300, 301], never=[301],
                      since_s=2.5, cut_off_before=before)  # fmt: skip
    labels = [f"c{node}" for node in range(min(count, 100))]
    assert reach(result, facts) == {
        "cut_off": {"cells": count, "labels": labels, "since_s": 2.5, "most": most},
        "without_way": {"cells": 2, "labels": ["c300", "c301"], "never": 1},
        "switched_off": {"cells": 1, "labels": ["c7"]},
        "lost_at_start": 5,
    }
    assert set(reach(result, None).values()) == {None}
    assert LABELS_MAX == 100  # docs: at most 100
