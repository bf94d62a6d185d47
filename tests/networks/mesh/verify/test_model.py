"""Small networks that are explored: their links, ranks, settings, and the scenario that each is."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.verify import first, local, mutants, search, story
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify.model import MeshBudget, MeshModel, parse, reach
from innervate.networks.mesh.verify.net import Nets
from innervate.prove.mutants import Mutant
from innervate.verify.errors import VerifyError

LINE, SQUARE = ((0, 1), (1, 2)), ((0, 1), (0, 2), (1, 3), (2, 3))


@pytest.mark.parametrize(("text", "links"), [
    ("1-0,2-1", LINE), ("2-1 0-1 1-0", LINE), ("square", SQUARE),
    ("0-5 1-5 2-5 3-5 4-5", ((0, 5), (1, 5), (2, 5), (3, 5), (4, 5))),
])  # fmt: skip
def test_links_are_joined_in_order_and_each_once(text, links):
    assert parse(text) == links


@pytest.mark.parametrize("text", ["", "0-1", "0-6 1-6 2-6 3-6 4-6 5-6", "0-1 1-2 2-2", "0-1 3-2",
                                  "1-2 2-3", "0-1 1-x", "0-1 x-2", "0-1-2", "0-1 1-²"])  # fmt: skip
def test_what_joins_no_small_network_is_refused(text):
    with pytest.raises(VerifyError, match=r'is no link; write "0-1 1-2"|3 to 6 of them'):
        parse(text)


@pytest.mark.parametrize(("start", "dead", "found"), [
    (0, (), {0, 1, 2, 3}), (0, (1,), {0, 2, 3}), (0, (1, 2), {0}), (3, (2,), {0, 1, 3}),
])  # fmt: skip
def test_who_is_connected_is_so_over_those_that_live(start, dead, found):
    assert reach(4, SQUARE, start, dead) == found


def test_the_gateway_is_first_and_standbys_follow_in_order():
    assert mesh_model.ranks(MeshModel(SQUARE)) == [0, -1, -1, -1]
    assert mesh_model.ranks(MeshModel(SQUARE, standby=(3, 1))) == [0, 2, -1, 1]


def test_a_network_is_a_scenario_with_its_settings():
    made = MeshModel(LINE, "random", standby=(2,), settings=(("e2e_tries", 1),))
    assert mesh_model.scenario_text(made, "some", 9.5).splitlines() == [
        'kind = "mesh"', 'name = "some"', "duration_s = 9.5", "seed = 1", "nodes = 3",
        "gateway = 0", "standby = [2]", "", "[protocol]", "jitter_s = 0.02", "listen_s = 0.1",
        "spread_s = 0.1", "collect_s = 0.4", "copies = 1", "e2e_adapt = false",
        'failover = "random"', "retry = false", "e2e_tries = 1", "",
        "[[link]]", "a = 0", "b = 1", "", "[[link]]", "a = 1", "b = 2",
    ]  # fmt: skip
    without = mesh_model.scenario_text(MeshModel(LINE), "some", 9.5, 7)
    assert "standby" not in without
    assert "retry" not in without
    assert "seed = 7" in without


def test_parameters_are_the_scenarios_in_a_class_of_its_size():
    found = mesh_model.parameters(MeshModel(LINE, reliable=False))
    assert (found["width"], found["places"], found["row"]) == (3, 3, mesh_fields.row_bytes(3))
    assert (found["reliable"], found["points"]) == (0, 0)
    watched = mesh_model.parameters(MeshModel(LINE, robot=0))
    assert (watched["reliable"], watched["points"], watched["watch"]) == (1, 4, 0)
    with pytest.raises(VerifyError, match="e2e_tries"):
        mesh_model.parameters(MeshModel(LINE, settings=(("e2e_tries", -1),)))


def test_what_may_fail_if_nobody_says():
    assert MeshBudget() == MeshBudget(deaths=1, revivals=0, frames=1, acks=1, ticks=0)
    usual = MeshModel(LINE)
    assert (usual.robot, usual.beats, usual.reliable, usual.overhear) == (-1, 0, True, True)


def test_a_first_round_without_end_is_not_waited_for_and_told(monkeypatch):
    monkeypatch.setattr(first.mesh_net, "EVENTS_MAX", 15)
    told = story.tell(search.explore(MeshModel(LINE)))
    assert told.title == "the first round has no end"
    assert len(told.sentences) == first.LAST


SHORT, TWICE = (("e2e_tries", 1), ("transmissions", 1)), (("e2e_tries", 1), ("transmissions", 2))


def test_mutants_are_tried_on_what_each_promise_is_about():
    def budget(deaths=0, revivals=0, frames=0, acks=0):
        return MeshBudget(deaths, revivals, frames, acks, 0)

    found = [(one.links, one.offers, one.robot, one.standby, one.beats, one.budget, one.settings)
             for one in mutants.models()]  # fmt: skip
    assert found == [
        (LINE, ((2, 0),), -1, (), 0, budget(acks=1), SHORT),
        (LINE, ((2, 0),), -1, (), 0, budget(frames=1), TWICE),
        (parse("0-1 1-2 2-3"), ((3, 1),), -1, (), 0, budget(), mutants.WANTED),
        (SQUARE, ((3, 0),), -1, (), 0, budget(deaths=1), SHORT),
        (LINE, (), 2, (), 0, budget(), SHORT),
        (LINE, ((2, 0), (2, 0)), -1, (), 0, budget(), TWICE),
        (LINE, (), -1, (2,), 4, budget(1, 1), mutants.QUICK),
        (LINE, (), -1, (2,), 3, budget(), mutants.ASKED),
    ]  # fmt: skip


@pytest.mark.parametrize(("broken_at", "where", "states"), [
    (0, "0-1 1-2, search, messages", 10), (3, "0-1 0-2 1-3 2-3, search, messages", 40),
    (4, "0-1 1-2, search, an alarm", 50), (6, "0-1 1-2, search, gateways", 70), (9, "", 80),
])  # fmt: skip
def test_a_mutant_is_caught_where_it_first_breaks_something(broken_at, where, states, monkeypatch):
    seen = []

    def explore(model, nets, states):
        assert (nets.model, states) == (model, 5_000)
        seen.append(model)
        return Of(tally=Of(states=10), broken=int(len(seen) > broken_at))

    monkeypatch.setattr(mutants.mesh_search, "explore", explore)
    monkeypatch.setattr(mutants.mesh_story, "tell", lambda found: Of(title="it loops"))
    monkeypatch.setattr(mutants, "Nets", lambda model, _: Of(model=model))
    some = Of(copies=lambda _: ("entry",))
    found = mutants.hunt(some)
    assert found == mutants.Catch(some, "it loops" if where else "", where, states)


START, HEAR = (
    "    node.seq = draw(node, 65_536)\n",
    "    k = hear(node, params, frame.link_src, frame.rssi)\n",
)


@pytest.mark.parametrize(("line", "more", "title", "last"), [
    (START, "    node.seq = 1 << 20\n", "a value is out of its declared range",
     "Node 1 is switched on."),
    (START, "    node.seq = node.seq // 0\n", "a handler cannot go on",
     "Node 1 is switched on."),
    (HEAR, "    node.gone = 1 << 20\n", "a value is out of its declared range",
     "Node 1 sends a discovery request to all."),
], ids=("a value as it is switched on", "no way on", "a value as a frame comes"))  # fmt: skip
def test_a_first_round_that_breaks_is_told_as_a_story(line, more, title, last):
    (entry,) = Mutant("", line, line + more).copies("innervate.networks.mesh.protocol.node")
    made = MeshModel(LINE)
    found = search.explore(made, nets=Nets(made, local.Locals(made, entry)))
    assert found.tally.ended == "broken"
    told = story.tell(found)
    assert (told.title, told.sentences[-1]) == (title, last)
