import numpy as np
import pytest

from innervate.networks.skin.analysis import rows
from innervate.networks.skin.analysis.summary import loops
from innervate.networks.skin.sim.observer import LOOP_CLOSED, LOOP_OPEN
from innervate.sim.tables import ROW, row_dtype


class Recorded:
    def __init__(self, table, ended_us):
        self.rows = np.array(table, row_dtype(ROW))
        self.ended_us = ended_us


def test_loops_by_hand():
    result = Recorded(
        [
            (100, 7, LOOP_OPEN, 4, 0),
            (150, 3, LOOP_OPEN, 2, 0),
            (180, 7, LOOP_CLOSED, 0, 0),
            (200, 7, LOOP_OPEN, 6, 0),
            (230, 3, LOOP_CLOSED, 0, 0),
        ],
        ended_us=1200,
    )
    found = rows.loop_episodes(result)
    assert found.cell.tolist() == [7, 3, 7]
    assert found.opened_us.tolist() == [100, 150, 200]
    assert found.closed_us.tolist() == [180, 230, rows.NEVER]
    assert found.length.tolist() == [4, 2, 6]
    assert loops(result) == {"episodes": 3, "longest_ms": 1.0}


def test_no_rows():
    result = Recorded([], 1000)
    assert loops(result) == {"episodes": 0, "longest_ms": None}
    assert len(rows.parent_changes(result).cell) == 0
    assert len(rows.broken_changes(result).end) == 0


@pytest.fixture(scope="module")
def looping(go):
    """The paper's rule, which closes loops in nearly every recovery of setup 1 (E25)."""
    return go("setup-1", "protocol.rule=paper", "protocol.updates=periodic", seconds=2.5)


def test_the_papers_rule_closes_loops(looping):
    found = rows.loop_episodes(looping)
    assert len(found.cell) > 0
    assert (found.length >= 2).all()
    assert (found.opened_us > 2_000_000).all()
    stood = found.closed_us != rows.NEVER
    assert (found.closed_us[stood] >= found.opened_us[stood]).all()
    assert loops(looping)["longest_ms"] > 0
    assert len(found.cell) == int(looping.world.run["loops"][0])
    assert (~stood).sum() == int(looping.world.run["loops_open"][0])


def test_parent_changes_lead_to_the_final_parents(looping):
    changes = rows.parent_changes(looping)
    assert (np.diff(changes.time_us) >= 0).all()
    last = dict(zip(changes.cell.tolist(), changes.new.tolist(), strict=True))
    parents = looping.world.watch.port.tolist()
    assert parents == [last[cell] for cell in range(len(parents))]


def test_each_change_starts_from_the_port_before(looping):
    port = {}
    changes = rows.parent_changes(looping)
    steps = zip(changes.cell.tolist(), changes.old.tolist(), changes.new.tolist(), strict=True)
    for cell, old, new in steps:
        assert old == port.get(cell, -1)
        assert new != old
        port[cell] = new


def test_unrouted_ends_as_the_world_says(looping):
    steps = rows.unrouted_steps(looping)
    assert steps.cells[0] == 99
    assert steps.cells[-1] == int(looping.world.run["unrouted"][0])
    assert (np.diff(steps.cells) != 0).all()


def test_values_after_rows():
    steps = rows.Steps(*(np.array(x) for x in ([2, 5], [10, 20], [7, 3], [0, 0])))
    assert rows.values_at(steps, np.array([0, 2, 4, 5, 9])).tolist() == [0, 7, 7, 3, 3]
