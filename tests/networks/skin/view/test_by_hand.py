"""A skin touched and commanded by hand: from which step on, whom it reaches, what is said."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.skin.scenario.orders import ALL, Order
from innervate.networks.skin.scenario.touch import STEP_US, sample
from innervate.networks.skin.view import giving
from innervate.networks.skin.view.engine import (
    CELLS_MAX,
    ORDERS_CELLS_MAX,
    takes_orders,
    unwatchable,
)
from innervate.networks.skin.view.touching import AWAY_MM, Finger
from innervate.scenario import from_dict
from innervate.topology.layout import cell_places
from innervate.web.errors import Refused
from innervate.web.history import LOG, History, Logbook
from tests.networks.skin.runs import line, plan_of

DATA = {"rate_hz": 100}


def finger(**keys):
    plan = plan_of(line(3, duration_s=0.1, data=DATA, **keys))
    return plan, Finger(plan)


def places(touch):
    return list(zip(touch.x_um.tolist(), touch.y_um.tolist(), strict=True))


@pytest.mark.parametrize(("at_us", "step"), [(0, 0), (1, 1), (STEP_US, 1), (STEP_US + 1, 2)])
def test_a_finger_is_there_from_the_next_step_on(at_us, step):
    plan, touch = finger()
    before = places(touch)
    assert set(before) == {(round(1000 * AWAY_MM), 0)}
    touch.move(at_us, 2)
    there = tuple(round(1000 * x) for x in cell_places(plan.graph)[2])
    assert places(touch) == before[:step] + [there] * (len(before) - step)
    touch.move(at_us + 2 * STEP_US, None)
    assert places(touch)[step : step + 3] == [there, there, before[0]]


@pytest.mark.parametrize("table", [None, {"path": [[0.0, 0.0, 0.0], [0.1, 28.0, 5.0]],
                                          "radius_mm": 9, "force_n": 3}])  # fmt: skip
def test_what_a_hand_did_is_a_path_that_gives_the_same_samples(table):
    plan, touch = finger(**({"touch": table} if table else {}))
    touch.move(20_000, 1)
    touch.move(20_001, 0)
    touch.move(60_000, None)
    again = from_dict(line(3, duration_s=0.1, data=DATA, touch=touch.table())).model.touch
    made = sample(again, plan.graph, 0.1)
    assert list(zip(made.x_um, made.y_um, strict=True)) == places(touch)
    assert (made.radius_um, made.force_mn, made.step_us) == tuple(touch._span.tolist())
    if table is None:
        assert len(touch.table()["path"]) == 7  # both ends of every stay


def test_the_world_has_a_copy_of_the_touch():
    from collections import namedtuple

    plan, touch = finger()
    touch.move(0, 1)
    world = touch.into(namedtuple("World", "carrier")(None))
    touch.move(0, None)
    assert world.carrier.x[0] == round(1000 * cell_places(plan.graph)[1][0])
    assert world.carrier.place.tolist() == [
        round(1000 * x) for spot in cell_places(plan.graph) for x in spot
    ]


@pytest.mark.parametrize(("node", "cell"), [(None, ALL), (0, 0), (2, 2)])
def test_a_command_is_for_a_cell_or_all(node, cell):
    given = Of(node=node, code=7, value=9)
    assert giving.order_of(given, 50, 3) == Order(50, cell, 7, 9)
    wanted = {"at_s": 5e-5, "code": 7, "value": 9}
    assert giving.table(Order(50, cell, 7, 9), {"node": "n1"}) == (
        wanted if node is None else wanted | {"node": "n1"}
    )


@pytest.mark.parametrize("node", [3, 4, -1])
def test_what_is_no_cell_gets_no_command(node):
    with pytest.raises(Refused):
        giving.order_of(Of(node=node, code=7, value=9), 50, 3)


def test_it_is_said_when_one_has_it_and_when_the_last_of_all_has():
    graph, history = plan_of(line(3)).graph, History()
    log = Logbook(history)
    every = giving.begin(log, graph, 1_000, 1, ALL)
    one = giving.begin(log, graph, 2_000, 2, 1)
    for at_us, given, number, cell in ((3_500, every, 1, 0), (4_000, one, 2, 1),
                                       (4_500, every, 1, 1), (6_000, every, 1, 2)):  # fmt: skip
        giving.reached(log, graph, given, at_us, number, cell)
    said = [(item.at_us, item.what["text"]) for item in history.after(LOG, 0, history.newest, 99)]
    assert said == [
        (1_000, "command 1 for all cells"), (2_000, "command 2 for p0 r0 c1"),
        (4_000, "command 2 came to p0 r0 c1 after 2 ms"),
        (6_000, "command 1 came to all 3 cells after 5 ms"),
    ]  # fmt: skip


def test_how_large_a_skin_may_be_watched_and_commanded():
    def skin(cells, **more):
        known = {"script": (), "orders": [], "data_period_us": 0}
        return Of(graph=Of(cells=cells), **known | more)

    assert unwatchable(skin(CELLS_MAX)) == ""
    assert unwatchable(skin(CELLS_MAX + 1)).startswith("20,001 cells are too many")
    assert "[script]" in unwatchable(skin(2, script=(1,)))
    assert takes_orders(skin(ORDERS_CELLS_MAX))
    assert not takes_orders(skin(ORDERS_CELLS_MAX + 1))
    assert takes_orders(skin(ORDERS_CELLS_MAX + 1, data_period_us=5))
    assert takes_orders(skin(ORDERS_CELLS_MAX + 1, orders=[1]))
