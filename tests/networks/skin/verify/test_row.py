"""A cell, the PC and frames under way as bytes, and back: every field has its place."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.skin.protocol.constants import BEACON, INFINITY, NONE, ONE, PORTS
from innervate.networks.skin.verify import row as r
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.row import IS_PARENT, WAS_PARENT
from tests.networks.skin.verify.tiny import Tiny

HEAD = {"SQ_OWN": 41, "FD_SQ": 42, "FD_DIST": 43, "HOLD": 44, "WAIT": 45, "SENT_SQ": 46,
        "SENT_DIST": 47}  # fmt: skip


def loaded(tiny, c=0):
    r.load_cell(tiny.world, c, 0)
    return tiny.world.cells[0]


@pytest.mark.parametrize(("name", "field"), [
    ("SQ_OWN", "sq_own"), ("FD_SQ", "fd_sq"), ("FD_DIST", "fd_dist"), ("HOLD", "hold"),
    ("WAIT", "wait"), ("SENT_SQ", "sent_sq"), ("SENT_DIST", "sent_dist"),
])  # fmt: skip
def test_every_number_of_a_cell_is_read_from_its_place(name, field):
    cell = loaded(Tiny().cell(0, **HEAD))
    assert getattr(cell, field) == HEAD[name]


@pytest.mark.parametrize("flags", range(8))
def test_flags_of_a_cell_are_single_bits(flags):
    cell = loaded(Tiny().cell(0, FLAGS=flags))
    assert (cell.sq_known, cell.fd_known, cell.soon) == (flags & 1, flags >> 1 & 1, flags >> 2)


@pytest.mark.parametrize(("sent", "dist", "at"), [(r.NOTHING_SENT, -1, True), (3, 3, False)])
def test_who_has_sent_nothing_yet_may_send_at_once(sent, dist, at):
    tiny = Tiny().cell(0, SENT_DIST=sent)
    cell = loaded(tiny)
    gap = (2**30 - tiny.world.params[0].gap_us) % 2**30
    assert (cell.sent_dist, cell.sent_at) == (dist, gap if at else 0)
    assert (cell.own_load, cell.tick_at) == (1, 0)


def test_what_a_port_heard_is_read_and_written_bit_by_bit():
    for says in range(64):
        tiny = Tiny(updates="triggered")
        tiny.port(0, 1, 5, 77, says)
        p = tiny.end(0, 1) % PORTS
        cell = loaded(tiny)
        assert (cell.dist[p], cell.sq[p], cell.load[p]) == (5, 77, says & 1), says
        assert (cell.child[p], cell.pf[p]) == (says >> 1 & 1, (says >> 2 & 3) * ONE), says
        parents = cell.parent == p, cell.sent_parent == p
        assert parents == (bool(says & 16), bool(says & 32)), says
        tiny.port(0, 1, 0, 0, 0)
        r.save_cell(tiny.world, 0, 0)
        assert tiny.port(0, 1) == (5, 77, says)


@pytest.mark.parametrize("ticked", [0, r.HAS_TICKED])
def test_a_socket_without_a_cable_is_broken_from_the_first_tick_on(ticked):
    tiny = Tiny().cell(1, FLAGS=ticked)
    free = next(p for p in range(PORTS) if tiny.lay.port_at[PORTS + p] < 0)
    cell = loaded(tiny, 1)
    assert (cell.dist[free], cell.sq[free], cell.load[free], cell.child[free]) == (
        INFINITY,
        0,
        0,
        0,
    )
    assert cell.pf[free] == (2 * ONE if ticked else 0)
    assert (cell.size[free], cell.heard[free], cell.parent) == (0, 0, NONE)


@pytest.mark.parametrize(("updates", "keeps"), [("triggered", True), ("periodic", False)])
def test_a_cell_comes_back_as_it_was_but_for_what_only_matters_between_ticks(updates, keeps):
    tiny = Tiny(updates=updates).cell(0, **HEAD, FLAGS=7)
    tiny.port(0, 1, 5, 77, IS_PARENT | WAS_PARENT)
    before = bytes(tiny.row)
    loaded(tiny)
    r.save_cell(tiny.world, 0, 0)
    if keeps:
        assert bytes(tiny.row) == before
    else:
        assert (tiny.head(0, "SENT_SQ"), tiny.head(0, "SENT_DIST")) == (0, r.NOTHING_SENT)
        assert tiny.port(0, 1) == (5, 77, IS_PARENT)
    r.save_cell(tiny.world, 0, r.HAS_TICKED)
    assert tiny.head(0, "FLAGS") == 7 | r.HAS_TICKED


@pytest.mark.parametrize(("field", "value", "kept"), [
    ("hold", 255, 255), ("hold", 256, 255), ("wait", 300, 255), ("sq_own", 256 + 9, 9),
    ("fd_sq", 256 + 8, 8),
])  # fmt: skip
def test_what_is_larger_than_a_byte_is_its_most_or_goes_round(field, value, kept):
    tiny = Tiny()
    setattr(loaded(tiny), field, value)
    r.save_cell(tiny.world, 0, 0)
    assert tiny.head(0, field.upper()) == kept


def test_the_pc_is_read_and_written():
    tiny = Tiny().pc(PC_SQ=9, PC_FLAGS=1, PC_PERIODS=3, PC_LISTEN=2)
    before = bytes(tiny.row)
    r.load_pc(tiny.world)
    own = tiny.world.pc.own[0]
    assert (own.sq, own.sq_known, own.periods, own.listen, own.tick_at) == (9, 1, 3, 2, 0)
    tiny.pc(PC_SQ=0, PC_FLAGS=0, PC_PERIODS=0, PC_LISTEN=0)
    r.save_pc(tiny.world)
    assert bytes(tiny.row) == before
    own.sq = 256 + 7
    r.save_pc(tiny.world)
    assert tiny.row[tiny.lay.pc_at + w.PC_SQ] == 7


FRAMES = [(1, 40, 0), (2, 41, 3), (3, 42, 1)]


def test_frames_are_taken_oldest_first_and_leave_nothing():
    tiny = Tiny(updates="triggered", lean=False)
    tiny.world.at[w.CAPACITY] = 3
    way = tiny.way(1, 0)
    for dist, sq, says in FRAMES[:2]:
        r.push(tiny.world, way, Of(dist=dist, sq=256 + sq, load=5 * (says & 1), parent=says >> 1))
    assert tiny.queue(1, 0) == FRAMES[:2]
    r.take(tiny.world, way, 0)
    frame = tiny.world.frame[0]
    assert (frame.kind, frame.dist, frame.sq, frame.load, frame.parent) == (BEACON, 1, 40, 0, 0)
    assert tiny.queue(1, 0) == FRAMES[1:2]
    r.take(tiny.world, way, 0)
    assert (frame.dist, frame.sq, frame.load, frame.parent) == (2, 41, 1, 1)
    assert tiny.queue(1, 0) == []


@pytest.mark.parametrize(("count", "found"), [(1, w.FINE), (2, w.NO_ROOM)])
def test_one_frame_more_than_there_is_room_for_is_told(count, found):
    tiny = Tiny(updates="triggered", lean=False)
    tiny.world.at[w.CAPACITY] = 2
    tiny.queue(1, 0, *FRAMES[:count])
    r.push(tiny.world, tiny.way(1, 0), Of(dist=9, sq=9, load=1, parent=0))
    assert tiny.world.found[0] == found
    assert len(tiny.queue(1, 0)) == 2


@pytest.mark.parametrize(("one", "total", "left"), [
    (2, 2, (True, [1, 1])), (1, 3, (True, [0, 2])), (2, 1, (True, [0, 0])), (0, 2, (False, [0, 2])),
    (2, 0, (False, [2, 0])),
])  # fmt: skip
def test_a_fault_takes_from_its_own_budget_and_that_of_all(one, total, left):
    tiny = Tiny()
    at = tiny.lay.budget_at
    tiny.row[at + w.LOSS], tiny.row[at + w.TOTAL] = one, total
    assert r.has_budget(tiny.world, w.LOSS) == left[0]
    assert bool(r.spend(tiny.world, w.LOSS)) == left[0]
    assert [tiny.row[at + w.LOSS], tiny.row[at + w.TOTAL]] == left[1]


def test_a_cable_is_up_until_it_is_cut():
    tiny = Tiny().cut(0, 1)
    link = tiny.way(0, 1) // 2
    assert [bool(r.is_up(tiny.world, one)) for one in (link, 1 - link)] == [False, True]
