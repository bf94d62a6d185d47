"""Tables of a simulation, compiled and plain: made, written, grown, handed over, moved out."""

from typing import NamedTuple

import numpy as np
import pytest

from innervate.sim import tables as sim_tables
from innervate.sim.recorded import Recorded
from innervate.sim.tables import (
    TAP,
    WIDE,
    Tables,
    get,
    hand_over,
    longer,
    move_rows,
    put,
    row_dtype,
    uniform,
)

NAMES = ("time", "node", ("force", 3))
FIELDS = (("kind", 0, 1, 9, "", ""), ("path", 2, 0, 9, "", ""))


@pytest.fixture(params=[True, False], ids=["plain", "arrays"])
def tables(request):
    return Tables(request.param)


def numbers(table):
    return table if isinstance(table, list) else table.tolist()


def test_numbers_are_all_of_one_value(tables):
    assert numbers(tables.numbers(3)) == [0, 0, 0]
    assert numbers(tables.numbers(2, -1, np.int64)) == [-1, -1]
    assert numbers(tables.given([[1, 2], [3, 1 << 40]])) == [1, 2, 3, 1 << 40]
    assert numbers(tables.given(())) == []


def test_records_are_apart_from_each_other_and_begin_at_nought(tables):
    made = tables.records(NAMES, 3)
    put(made, 1, time=1 << 40, node=7, force=(4, 5, 6))
    assert [int(get(made, i, "time")) for i in range(3)] == [0, 1 << 40, 0]
    assert [int(get(made, i, "node")) for i in range(3)] == [0, 7, 0]
    assert [list(get(made, i, "force")) for i in range(3)] == [[0, 0, 0], [4, 5, 6], [0, 0, 0]]


def test_what_was_put_does_not_change_with_what_it_came_from(tables):
    made, force = tables.records(NAMES, 1), [1, 2, 3]
    put(made, 0, force=force)
    force[0] = 9
    assert list(get(made, 0, "force")) == [1, 2, 3]


def test_fields_have_64_bits_where_they_are_said_to():
    kinds = row_dtype(NAMES)
    assert [kinds[name].base for name in kinds.names] == [np.int64, np.int32, np.int32]
    assert kinds["force"].shape == (3,)
    assert {row_dtype(NAMES, ("node", "force"))[name].base for name in ("node", "force")} == {
        np.dtype(np.int64)}  # fmt: skip
    assert {"time", "start", "at", "fingerprint", "offset"} <= WIDE


def test_states_begin_in_their_range_and_are_rows_of_words(tables):
    states = tables.states(FIELDS, 2)
    put(states, 1, kind=3, path=[4, 5])
    words = tables.words(states, FIELDS)
    assert [[int(words[i][k]) for k in range(3)] for i in range(2)] == [[1, 0, 0], [3, 4, 5]]
    words[0][2] = 8
    assert list(get(states, 0, "path")) == [0, 8]


def test_an_outbox_is_empty_and_has_room(tables):
    out = tables.outbox(5, FIELDS)
    assert [int(one[0]) for one in (out.count, out.limit, out.overflow)] == [0, 5, 0]
    assert (len(out.action), len(out.frame)) == (5, 5)


def test_a_table_grows_and_keeps_what_is_in_it(tables):
    made = tables.records(NAMES, 2)
    for i in range(2):
        put(made, i, node=i + 1)
    grown = longer(made, 5)
    put(grown, 3, node=9)
    assert [int(get(grown, i, "node")) for i in range(5)] == [1, 2, 0, 9, 0]
    assert numbers(longer(tables.numbers(2, 7), 4)) == [7, 7, 0, 0]


class World(NamedTuple):
    run: object
    rows: object
    taps: object
    tapped: object


def world_of(tables):
    world = World(tables.records(("rows", "taps"), 1), tables.records(NAMES, 4),
                  tables.records(TAP, 4), tables.states(FIELDS, 4))  # fmt: skip
    for i in range(4):
        put(world.rows, i, time=10 * i, node=i, force=(i, 2 * i, 3 * i))
        put(world.taps, i, time=(1 << 40) + i, at=i, why=2)
        put(world.tapped, i, kind=i + 1, path=(i, i + 1))
    return world


def test_filled_rows_are_moved_out_and_no_others(tables):
    world, parts = world_of(tables), {"rows": []}
    for count in (3, 0, 1):
        put(world.run, 0, rows=count)
        move_rows(world, parts, {"rows": NAMES}, WIDE)
        assert int(get(world.run, 0, "rows")) == 0
    put(world.rows, 0, node=99, force=(9, 9, 9))  # the loop fills it again
    first, none, last = parts["rows"]
    assert first["node"].tolist() == [0, 1, 2]
    assert first["force"].tolist() == [[0, 0, 0], [1, 2, 3], [2, 4, 6]]
    assert (len(none), last["time"].tolist()) == (0, [0])
    assert first.dtype == none.dtype == row_dtype(NAMES)


def test_kept_frames_are_handed_over_once(tables):
    world, seen = world_of(tables), []
    put(world.run, 0, taps=2)

    def tap(rows, frames, now):
        seen.append((rows["time"].tolist(), rows["at"].tolist(), frames["kind"].tolist(),
                     frames["path"].tolist(), now))  # fmt: skip

    hand_over(world, None, 50)
    assert int(get(world.run, 0, "taps")) == 2
    hand_over(world, tap, 50)
    assert seen == [([1 << 40, (1 << 40) + 1], [0, 1], [1, 2], [[0, 1], [1, 2]], 50)]
    assert int(get(world.run, 0, "taps")) == 0


def test_draws_of_a_stream_are_the_same_anywhere_and_below_their_end():
    assert (
        uniform(1, "medium", 4, 1 << 30).tolist() == uniform(1, "medium", 9, 1 << 30)[:4].tolist()
    )
    assert uniform(1, "medium", 2, 1 << 30).tolist() != uniform(2, "medium", 2, 1 << 30).tolist()
    assert uniform(1, "medium", 2, 1 << 30).tolist() != uniform(1, "medias", 2, 1 << 30).tolist()
    for n in (1, 2, 7):
        assert set(uniform(3, "x", 400, n).tolist()) == set(range(n))


def test_plain_tables_have_less_room():
    assert Tables(True).rows == sim_tables.PLAIN_ROWS < Tables(False).rows == sim_tables.ROWS


@pytest.mark.parametrize("checks", [True, False])
@pytest.mark.parametrize("trail", [True, False])
def test_something_is_to_be_done_after_a_call_if_it_is_checked_or_kept(checks, trail):
    kept = Recorded(checks=checks, trail=trail)
    assert kept.is_watchful == (checks or trail)
    usual = Recorded()
    assert (usual.checks, usual.observe, usual.is_watchful) == (True, True, True)
    assert (usual.deliveries, usual.trail, usual.tap) == (False, False, False)
