"""What a state of a skin has room for, which moves there are, and what is compared of states."""

import pytest

from innervate.networks.skin.verify import graphs
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.layout import hold_periods
from innervate.networks.skin.verify.system import Budget, SkinModel

LINE = "pc-1 1-2"
NONE = dict.fromkeys(("loss", "cut", "heal", "false", "restart"), 0)


def model(graph=LINE, ticks=3, budget=(), **keys):
    return SkinModel(graphs.parse(graph), budget=Budget(ticks, **NONE | dict(budget)), **keys)


@pytest.mark.parametrize(("graph", "hold", "periods"), [
    ("pc-1", 0, 5), (LINE, 0, 9), ("pc-1 1-2 2-3", 0, 13), (LINE, 2, 2), (LINE, 40, 40),
])  # fmt: skip
def test_feasible_distances_are_held_four_periods_a_cell_and_one(graph, hold, periods):
    """docs/verify.md: 1 + 4 periods a cell, in place of 1 + 128."""
    assert hold_periods(model(graph, hold=hold)) == periods


@pytest.mark.parametrize(("ticks", "keys", "held"), [
    (3, {"keep": True, "lean": True}, 4), (6, {"keep": True, "lean": True}, 7),
    (7, {"keep": True, "lean": True}, 0),  # they reach FD_HOLD less three periods: it is known
    (3, {"lean": True}, 0), (3, {"keep": True}, 0), (3, {"keep": True, "lean": True, "hold": 6}, 4),
    (4, {"keep": True, "lean": True, "hold": 6}, 0), (w.ANY, {"keep": True, "lean": True}, 7),
    (3, {"keep": True, "lean": True, "unreduced": True}, 0),
    (3, {"keep": True, "lean": True, "prompt": True}, 0),
])  # fmt: skip
def test_how_long_without_a_route_is_forgotten_where_ticks_cannot_reach_it(ticks, keys, held):
    made = model(ticks=ticks, updates="triggered", **keys)
    assert made.layout()._held() == held


TICKS = [(w.TICK, 0), (w.TICK, 1), (w.PC_TICK, 0)]
SOON = [(w.SOON, 0), (w.SOON, 1)]
DELIVER, LOSE = ([(kind, way) for way in range(4)] for kind in (w.DELIVER, w.LOSE))
BOTH = [0, 1]


@pytest.mark.parametrize(("budget", "keys", "moves"), [
    ({}, {}, TICKS), ({}, {"merge": False}, TICKS + DELIVER),
    ({"loss": 1}, {}, TICKS), ({"loss": 1}, {"merge": False}, TICKS + DELIVER + LOSE),
    ({}, {"prompt": True}, TICKS + DELIVER),
    ({}, {"updates": "triggered"}, TICKS + SOON + DELIVER),
    ({"cut": 1}, {}, TICKS + [(w.CUT_LINK, link) for link in BOTH]),
    ({"heal": 1}, {}, TICKS + [(w.HEAL_LINK, link) for link in BOTH]),
    ({"restart": 1}, {}, [*TICKS, (w.RESTART_PC, 0)]),
])  # fmt: skip
def test_what_can_happen_is_what_there_is_a_budget_for(budget, keys, moves):
    assert model(budget=budget, **keys).layout().moves() == moves


@pytest.mark.parametrize("lean", [False, True])
def test_lean_states_are_the_same_whatever_more_may_happen(lean):
    lay = model(lean=lean).layout()
    left_out = {at for at, mask in enumerate(lay.body()) if mask == 0}
    may_happen = {at + w.TICKS for at in lay.cell_at} | {lay.pc_at + w.PC_COUNTS}
    may_happen |= set(range(lay.budget_at, lay.budget_at + w.BUDGETS))
    assert left_out == (may_happen if lean else set())
    assert set(lay.body()) <= {0, 255}
    assert len(lay.body()) == lay.width


@pytest.mark.parametrize(("graph", "keys", "count"), [
    (LINE, {}, 1), ("pc-1 1-2 2-pc", {}, 2), ("pc-1 1-2 2-pc", {"symmetric": False}, 1),
    ("pc-1 1-2 2-pc", {"prompt": True}, 1),
])  # fmt: skip
def test_states_have_as_many_images_as_the_graph_has_symmetries(graph, keys, count):
    lay = model(graph, **keys).layout()
    images = lay.images()
    assert len(images) == count * lay.width
    for k in range(count):
        assert sorted(images[k * lay.width : (k + 1) * lay.width]) == list(range(lay.width))


@pytest.mark.parametrize(("ticks", "counts", "keys", "room"), [
    (3, 2, {}, 3), (2, 5, {}, 5), (3, 2, {"prompt": True}, 2), (3, 2, {"capacity": 7}, 7),
    (w.ANY, 2, {}, 2), (w.ANY, 2, {"lean": True}, 10), (3, 2, {"updates": "triggered"}, 2),
    (3, 2, {"updates": "triggered", "lean": True}, 10),
])  # fmt: skip
def test_so_many_frames_can_be_under_way_each_way(ticks, counts, keys, room):
    budget = Budget(ticks, counts, **NONE)
    lay = SkinModel(graphs.parse(LINE), budget=budget, **keys).layout()
    assert (lay.capacity, lay.queue_bytes) == (room, 1 + room * w.FRAME_BYTES)


def test_everything_in_a_row_has_a_place_of_its_own():
    lay = model("pc-1 1-2 2-3 3-pc").layout()
    parts = [(at, w.HEAD_BYTES) for at in lay.cell_at]
    parts += [(at, w.PORT_BYTES) for at in lay.port_at if at >= 0]
    parts += [(lay.pc_at, w.PC_BYTES), (lay.link_at, 4), (lay.budget_at, w.BUDGETS)]
    parts += [(at, lay.queue_bytes) for at in lay.queue_at]
    taken = [at + k for at, size in parts for k in range(size)]
    assert sorted(taken) == list(range(len(taken)))
    assert len(taken) <= lay.width < len(taken) + 8
    assert lay.width % 8 == 0
    assert sum(at >= 0 for at in lay.port_at) == 6  # of three cells; the PC keeps none
    graph = lay.model.graph
    for way, end in enumerate(lay.way_end):
        assert (lay.in_way[end], lay.out_way[graph.peer[end]]) == (way, way)
