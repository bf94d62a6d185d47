"""What a page is told of any network over cables: nodes, cables, who is apart, what may be done.

No loop runs here: what a loop leaves in the tables is put there.
"""

import math

import pytest

from innervate import scenario as scenarios
from innervate.scenario.actions.cables import CUT, KILL, LOOSE, RESTORE, REVIVE
from innervate.sim.cables.declared import simulation
from innervate.sim.cables.world import DEAD
from innervate.web import declared_view
from innervate.web.declared_view import DeclaredView
from innervate.web.engine import Engine
from innervate.web.errors import Refused, WatchError
from innervate.web.history import History

RING = {"kind": "babel", "nodes": 4, "duration_s": 0.5}


def shown(**changes):
    plan = scenarios.plan(scenarios.from_dict(RING | changes))
    return DeclaredView(Engine(simulation(plan)), History())


def ends(view):
    return [tuple(pair) for pair in view.cables.ends.tolist()]


def cut(view, *links):
    """As the simulator leaves a cable that is cut: both ends, one reason more."""
    for link in links:
        for end in ends(view)[link]:
            view.engine.world.epoch[end] |= 1
            view.engine.world.ends["impaired"][end] += 1 << 2


def kill(view, *nodes):
    view.engine.world.alive[list(nodes)] = DEAD


def apart(view):
    told = view.arrays(False)
    assert told["apart"] == told["unconnected"]
    return told["apart"]


def test_its_nodes_and_cables():
    view = shown()
    scene = view.scene()
    assert [one["label"] for one in scene["nodes"]] == ["n0", "n1", "n2", "n3"]
    assert [one["id"] for one in scene["nodes"]] == [0, 1, 2, 3]
    joined = [(one["id"], *sorted((one["a"], one["b"]))) for one in scene["links"]]
    assert sorted(pair[1:] for pair in joined) == [(0, 1), (0, 3), (1, 2), (2, 3)]
    assert [one[0] for one in joined] == [0, 1, 2, 3]
    names = {one["name"] for one in scene["fields"]}
    assert names == set(view.arrays(False)["fields"]) >= {"parent"}
    where = [(one["x"], one["y"]) for one in scene["nodes"]]
    sides = [math.dist(where[a], where[b]) for _, a, b in joined]
    assert min(math.dist(where[0], where[2]), math.dist(where[1], where[3])) > min(sides) > 0


def test_who_is_on_and_apart_from_the_first_that_is():
    view = shown(shape="line", nodes=5)
    assert ends(view) == [(1, 4), (5, 8), (9, 12), (13, 16)]
    assert apart(view) == 0
    cut(view, 1)
    assert view.arrays(False)["link_up"].tolist() == [1, 0, 1, 1]
    assert apart(view) == 3, "2, 3, 4"
    kill(view, 3)
    assert view.arrays(False)["node_up"].tolist() == [1, 1, 1, 0, 1]
    assert apart(view) == 2, "2 and 4"
    kill(view, 0)
    assert apart(view) == 2, "1 is the first now"
    kill(view, 1)
    assert apart(view) == 1, "2 is the first"
    kill(view, *range(5))
    assert apart(view) == 0


def test_a_cable_can_be_cut_and_put_back():
    view = shown(shape="line", nodes=3)
    with pytest.raises(Refused, match="this cable is not cut"):
        view.cut(1, True)
    fault = view.make(7, 3, view.cut(1, False))
    assert (fault.at_us, fault.index, fault.action, fault.end, fault.node) == (7, 3, CUT, 5, -1)
    assert view.takes(fault)
    cut(view, 1)
    with pytest.raises(Refused, match="this cable is cut already"):
        view.cut(1, False)
    mended = view.make(8, 0, view.cut(1, True))
    assert (mended.action, mended.end, view.takes(mended)) == (RESTORE, 5, False)
    with pytest.raises(Refused, match="no link 2"):
        view.cut(2, False)


def test_a_cable_of_a_node_that_is_off_can_be_cut_besides():
    view = shown(shape="line", nodes=3)
    kill(view, 2)
    cut(view, 1)  # that the node is off is one reason
    with pytest.raises(Refused, match="its node is switched off"):
        view.cut(1, True)
    assert view.cut(1, False)["action"] == CUT
    cut(view, 1)
    assert view.cut(1, True)["action"] == RESTORE
    with pytest.raises(Refused, match="cut already"):
        view.cut(1, False)


def test_nodes_are_switched_off_and_on():
    view = shown()
    kill(view, 2)
    one, other = (view.make(1, 0, view.kill(*what)) for what in ((0, False), (2, True)))
    assert (one.action, one.node, one.end) == (KILL, 0, -1)
    assert (other.action, other.node, other.end) == (REVIVE, 2, -1)
    assert (view.takes(one), view.takes(other)) == (True, False)
    with pytest.raises(Refused, match="this node is on"):
        view.kill(0, True)
    with pytest.raises(Refused, match="off already"):
        view.kill(2, False)
    loose = [view.make(1, 0, {"action": LOOSE, "end": 1, "node": -1, "loss_q15": loss})
             for loss in (0, 1)]  # fmt: skip
    assert [view.takes(one) for one in loose] == [False, True]


def test_what_a_fault_does_in_words():
    view = shown(event=[{"at_s": 0.25, "action": "cut", "link": "n1-n2"}])
    (fault,) = view.plan.faults
    assert view.words(fault) == "cable n1 E - n2 W cut"


def test_a_network_of_too_many_nodes_is_not_drawn():
    shown(nodes=1000, shape="line")
    with pytest.raises(WatchError, match="1,001 nodes are too many to be drawn; at most 1,000"):
        shown(nodes=1001, shape="line")


def test_messages_that_may_still_come_are_not_missed(monkeypatch):
    view, asked = shown(), []
    monkeypatch.setattr(
        declared_view, "headline", lambda counts, handled, goes_on: asked.append((handled, goes_on))
    )
    view.engine.world.run["handled"][0] = 5
    for now_us in (499_999, 500_000):
        view.engine.now_us = now_us
        view.headline()
    assert asked == [(5, True), (5, False)]


def test_what_nodes_are_coloured_by_is_of_their_fields_or_of_functions_of_them():
    view = shown()
    view.own["seqno"] = ("", lambda node, params: 2 * node.seqno + 1)
    view.shown = [{"name": "seqno"}, {"name": "parent"}]
    cells = view.engine.world.cells[:4]
    cells["seqno"], cells["parent"] = [3, 4, 5, 6], [0, 1, 2, 1]
    assert view.arrays(False)["fields"] == {"seqno": [7, 9, 11, 13], "parent": [0, 1, 2, 1]}
