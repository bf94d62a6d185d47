"""Who is off, cut off, seeking a way: from tables of a world that are written here."""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.skin.analysis.commands import _open, missed_on_the_way
from innervate.networks.skin.analysis.frames import queued, under_way
from innervate.networks.skin.analysis.headline import SkinFacts
from innervate.networks.skin.analysis.reach import LABELS_MAX, reach, world_facts
from innervate.networks.skin.protocol.constants import COMMAND, DATA
from innervate.networks.skin.sim import counters as words
from innervate.networks.skin.sim import orders
from innervate.sim.cables.world import ALIVE, DEAD
from innervate.sim.wheel import NIL

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
     {"cut_off": [1, 2], "since_s": 1.5, "at_once": False}),
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


OFF, LOST, HAD, CAME = orders.WAS_OFF, orders.HAD_NO_WAY, orders.HAD_A_WAY, orders.CAME
POOL = 4  # the first slot of a frame on its way


def with_commands(*flying):
    """Three cells; commands 0 and 7, and a place that none has; two frames wait at port 1.

    A ring of three frames a port: what waits at port 1 begins with its last place.
    """
    data, old = Of(kind=DATA, sq=9), Of(kind=COMMAND, sq=5)
    ring = [Of(kind=COMMAND, sq=1000 + i) for i in range(6)]
    ring[5], ring[3] = old, data
    events = [Of(bucket=0, kind=words.COMMAND_BLOCK) for _ in range(POOL)]  # timers
    events += [Of(bucket=0, kind=words.COMMAND_BLOCK) for _ in flying]
    events += [Of(bucket=NIL, kind=words.COMMAND_BLOCK), Of(bucket=0, kind=0)]
    frames = [*(Of(kind=COMMAND, sq=sq) for sq in flying), Of(kind=COMMAND, sq=7), data]
    counters = [0] * 64
    counters[words.GIVEN], counters[words.MISSED + HAD - OFF] = 3, 20
    return Of(
        watch=Of(due_number=[0, 7, -1], due=[HAD, LOST, OFF, HAD, CAME, OFF, HAD, HAD, HAD]),
        run=[Of(queue_frames=3, pool_slots=POOL)], counters=counters, queue=ring, frames=frames,
        buffers=[Of(queued=0, first=0), Of(queued=2, first=2)],
        wheel=Of(events=events, pool=[NIL, len(events), 99]),
    )  # fmt: skip


def test_what_waits_at_a_port_goes_round_its_ring():
    world = with_commands(0)
    assert [frame.sq for frame in queued(world)] == [5, 9]
    assert [frame.sq for frame in under_way(world)] == [0, 5]


@pytest.mark.parametrize(("flying", "missed", "in_flight"), [
    ((), {OFF: 2, LOST: 1, HAD: 2}, 0),
    ((0,), {OFF: 2, LOST: 0, HAD: 1}, 2),  # who has no way may get one, while it flies
    ((7,), {OFF: 2, LOST: 1, HAD: 1}, 1),
    ((0, 7), {OFF: 2, LOST: 0, HAD: 0}, 3),
])  # fmt: skip
def test_who_may_still_get_a_command_has_not_missed_it(flying, missed, in_flight):
    world = with_commands(*flying)
    assert _open(world, 3) == (missed, in_flight)
    assert missed_on_the_way(world, 3) == 20 + missed[HAD]
    world.counters[words.GIVEN] = 0
    assert missed_on_the_way(world, 3) == 0
