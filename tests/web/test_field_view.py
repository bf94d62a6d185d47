"""What a page is told of a network over a field: places, who is on, links that carry.

No loop runs here: what a loop leaves in the tables is put there.
"""

import math

import pytest

from innervate import scenario as scenarios
from innervate.scenario.actions.field import CUT, JAM, KILL, QUIET, RESTART, RESTORE, REVIVE
from innervate.sim.field.declared import simulation
from innervate.sim.field.states import ALIVE, DEAD, OFF
from innervate.web.engine import Engine
from innervate.web.errors import Refused
from innervate.web.field_view import FieldView
from innervate.web.history import History

LINE = {"kind": "flooding", "nodes": 4, "absent": [3], "duration_s": 0.5,
        "layout": "line", "spacing_m": 20}  # fmt: skip
LINKS = [{"nodes": [0, 1]}, {"nodes": [1, 2]}]


def shown(**changes):
    plan = scenarios.plan(scenarios.from_dict(LINE | changes))
    return FieldView(Engine(simulation(plan)), History())


def up(view):
    links = zip(view.plan.good, view.arrays(False)["link_up"].tolist(), strict=True)
    return [link for link, is_up in links if is_up]


def places(view):
    return [(one["x"], one["y"]) for one in view.scene()["nodes"]]


def test_places_are_in_units_of_half_the_reach():
    assert places(shown()) == [(0, 0), (1.333, 0), (2.667, 0), (4, 0)]
    lies = places(shown(positions_m=[[3, 6], [0, 0], [15, 0], [0, 30]], nodes=4))
    assert lies == [(0.2, 0.4), (0, 0), (1, 0), (0, 2)]


def test_nodes_without_places_lie_as_links_join_them():
    first, middle, last = places(shown(link=LINKS, nodes=3, absent=[]))
    assert math.dist(first, last) > max(math.dist(first, middle), math.dist(middle, last)) > 0.5


def test_a_link_carries_while_both_its_nodes_are_on_and_it_is_not_cut():
    view = shown()
    world, count = view.engine.world, view.plan.nodes
    assert view.plan.good == [(0, 1), (1, 2), (2, 3)]
    assert up(view) == [(0, 1), (1, 2)], "node 3 is absent at first"
    world.run["handled"][0] = 1
    assert up(view) == [], "nobody was switched on"
    world.radios["state"][:count] = ALIVE
    assert up(view) == view.plan.good
    world.radios["state"][0] = ALIVE + 1
    assert up(view) == [(1, 2), (2, 3)]
    world.cut[1 * count + 2] = 1
    assert up(view) == [(2, 3)]


def test_what_is_cut_can_be_restored_and_nothing_else():
    view = shown()
    count = view.plan.nodes
    with pytest.raises(Refused, match="this link is not cut"):
        view.cut(1, True)
    fault = view.make(7, 4, view.cut(1, False))
    assert (fault.at_us, fault.index, fault.action) == (7, 4, CUT)
    assert (fault.node, fault.other) == (1, 2)
    assert view.takes(fault)
    view.engine.world.cut[1 * count + 2] = 1
    with pytest.raises(Refused, match="this link is cut already"):
        view.cut(1, False)
    mended = view.make(8, 0, view.cut(1, True))
    assert (mended.action, view.takes(mended)) == (RESTORE, False)
    with pytest.raises(Refused, match="no link 3; they are numbered 0 to 2"):
        view.cut(3, False)


def test_who_is_yet_to_come_is_not_among_those_that_are_switched_off():
    view = shown()
    view.plan.absent = [0, 1, 1, 0, *view.plan.absent[4:]]
    view.engine.world.run["handled"][0] = 1
    view.engine.world.radios["state"][: view.plan.nodes] = ALIVE
    view.engine.world.radios["state"][1:4] = OFF, DEAD, DEAD  # the second came, and was killed
    told = view.arrays(False)
    assert told["absent"].tolist()[:4] == [0, 1, 0, 0]
    assert (told["unconnected"], told["away"]) == (2, 1)


def test_who_is_on_can_be_switched_off_and_who_is_off_on():
    view = shown()
    view.engine.world.run["handled"][0] = 1
    view.engine.world.radios["state"][:4] = ALIVE, ALIVE, ALIVE, 0
    faults = [view.make(9, 0, view.kill(*one)) for one in ((0, False), (3, True))]
    assert [(one.action, one.node) for one in faults] == [(KILL, 0), (REVIVE, 3)]
    assert [view.takes(one) for one in faults] == [True, False]
    for node, is_revived in ((0, True), (3, False)):
        with pytest.raises(Refused):
            view.kill(node, is_revived)


@pytest.mark.parametrize(
    ("action", "takes"),
    [(KILL, True), (REVIVE, False), (CUT, True), (RESTORE, False), (JAM, True), (QUIET, False),
     (RESTART, False)],
)  # fmt: skip
def test_what_takes_something_away_and_what_gives_it_back(action, takes):
    view = shown()
    assert view.takes(view.make(7, 0, {"action": action, "node": 1})) == takes
