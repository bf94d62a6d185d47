"""The file of a story has its network, its settings and its steps; what a ring is, and is not."""

import tomllib
from pathlib import Path

import pytest

from innervate import scenario
from innervate.networks.skin.verify import graphs, story
from innervate.networks.skin.verify import row as r
from innervate.networks.skin.verify.mutants import copy_of
from innervate.networks.skin.verify.system import ANY, Budget, SkinModel
from innervate.prove.mutants import Mutant
from innervate.verify.explore import Result, Tally, explore
from innervate.verify.twin import Event
from tests.networks.skin.verify.tiny import PC, Tiny

WHOLE = Path(__file__).with_name("stories.txt")
SHORTEST = [("pair", {}), ("triangle", {"prompt": True}), ("triangle", {"updates": "triggered"})]
FORGETS = "# Found with feasible distances that are forgotten after"


def told(graph, steps=(), **keys):
    model = SkinModel(graphs.parse(graph), **keys)
    made = story.Story("a ring", ["One.", "Two."], graph=model.graph, steps=list(steps))
    return model, story._scenario(model, made)


@pytest.mark.parametrize("graph", ["pair", "triangle", "pc-1 1-2 2-3 pc-3"])
def test_a_story_is_played_on_its_own_network(graph):
    model, text = told(graph, rule="paper", updates="triggered")
    tables = tomllib.loads(text)
    ends = [(a, b) for a, b in model.graph.links()]
    label, node, port = model.graph.label, model.graph.node_of, model.graph.port_of
    assert [(link["a"], link["b"]) for link in tables["link"]] == [
        tuple(f"{label(node(end))}.{port(end)}" for end in pair) for pair in ends
    ]
    assert tables["protocol"] == {
        "rule": "paper", "updates": "triggered", "k": 1, "m": 1, "gap_us": 1_000_000,
        "balancing": False,
    }  # fmt: skip
    plan = scenario.plan(scenario.loads(text))
    assert {plan.graph.label(c) for c in range(plan.graph.cells)} == {
        label(c) for c in range(model.graph.cells)
    }
    assert text.startswith("# 1. One.\n# 2. Two.\n# So: a ring\nkind = ")


def test_steps_of_each_event_are_a_line_with_its_number():
    _, text = told("pair", [["tick n1", "tick n2"], [], ["cut n1.0"]])
    assert text.endswith('\n  "tick n1", "tick n2",  # 1\n    # 2\n  "cut n1.0",  # 3\n]\n')
    assert tomllib.loads(text)["script"] == {
        "keepalive": True, "steps": ["tick pc", "tick n1", "tick n2", "cut n1.0"],
    }  # fmt: skip


@pytest.mark.parametrize(("ticks", "forgets"), [(8, False), (9, True), (ANY, True)])
def test_that_a_run_forgets_later_is_said_where_it_matters(ticks, forgets):
    model, text = told("pair", budget=Budget(ticks=ticks))
    assert story.skin_system.hold_periods(model) == 9
    assert (f"{FORGETS} 9 periods\n# without a route; a run keeps" in text) == forgets


@pytest.mark.parametrize(("parents", "ring"), [
    ({}, []), ({0: PC}, []), ({0: PC, 1: 0}, []), ({0: 1}, []), ({0: 1, 1: 0}, [0, 1]),
])  # fmt: skip
def test_a_ring_is_of_cells_that_lead_back_to_where_they_began(parents, ring):
    tiny = Tiny()
    for c, other in parents.items():
        tiny.port(c, other, 1, 0, r.IS_PARENT)
    assert story._ring(tiny.twin) == ring


@pytest.mark.parametrize(("events", "words"), [(0, "0 events"), (3, "3 events")])
def test_in_short_it_is_told_after_how_many_events(events, words):
    model = SkinModel(graphs.parse("pair"))
    result = Result(model, Tally(), broken=story.w.BROKEN_ORDER, path=[b""] * events)
    assert story.in_short(result).title == (
        f"a feasible distance is not worse than that of the parent, after {words} or a few more"
    )


def test_stories_share_nothing():
    one, two = (story.Story("", graph=graphs.parse("pair")) for _ in range(2))
    for name in ("sentences", "steps", "scenes", "ring"):
        getattr(one, name).append(1)
        assert getattr(two, name) == []


def test_a_story_is_told_of_a_network_of_which_nothing_is_left_out(monkeypatch):
    """The search has one of several mirror images, beacons in ticks alone, and little room."""
    seen = []

    class Noting(story.Twin):
        def __init__(self, model, system):
            seen.append(model)
            super().__init__(model, system)

    monkeypatch.setattr(story, "Twin", Noting)
    found = explore(SkinModel(graphs.parse("pair"), rule="paper"))
    story.tell(found)
    searched, told = seen
    assert searched is found.model
    assert (told.merge, told.symmetric, told.keep, told.unreduced) == (False, False, True, True)
    assert told.capacity == story.ROOM >= 40 > found.model.capacity
    assert told.changed(merge=True, symmetric=True, keep=False, unreduced=False,
                        capacity=0) == searched  # fmt: skip


def in_full(name, keys):
    """The shortest way to a ring: sentences, each with its steps and the network after it."""
    found = explore(SkinModel(graphs.parse(name), **{"rule": "paper"} | keys))
    made = story.tell(found)
    yield f"{name} {keys}: {made.title}; ring {made.ring}"
    for said, steps, scene in zip(made.sentences, made.steps, made.scenes, strict=True):
        yield said
        yield f"    {', '.join(steps)}"
        yield f"    parents {scene.parents}, cut {sorted(scene.cut)}, by {scene.actor}"


def test_stories_are_told_word_for_word():
    lines = [line for name, keys in SHORTEST for line in in_full(name, keys)]
    assert lines == WHOLE.read_text(encoding="utf-8").splitlines()


SILENT = Mutant("who has no route is silent", "    if not silent:\n        announce(",
                "    if not silent and cell.parent != NONE:\n        announce(")  # fmt: skip
NEWER = Mutant("a newer number is said", "    cell.sent_sq = cell.sq_own\n    cell.sent_at",
               "    cell.sent_sq = cell.sq_own + 1\n    cell.sent_at")  # fmt: skip
SHORT = Mutant("it is as near as its parent", "return min(cell.dist[cell.parent] + 1, INFINITY)",
               "return min(cell.dist[cell.parent], INFINITY)")  # fmt: skip
PERIODIC = ("feasible", "periodic", "pc-1 1-2", Budget(restart=0, heal=0))
ONCE = Budget(ticks=1, counts=1, loss=0, cut=0, heal=0, restart=0, faults=1)


@pytest.mark.parametrize(("fault", "what", "at", "sentences"), [
    (SHORT, PERIODIC, 1, [
        'n1 hears from the PC "0 hops, number 1", ticks and says "0 hops, number 1"; it takes '
        "the PC as its parent.",
        'n2 hears from n1 "0 hops, number 1", ticks and says "0 hops, number 1"; it takes n1 as '
        "its parent."]),
    (NEWER, PERIODIC, 1, [
        'n1 hears from the PC "0 hops, number 1", ticks and says "1 hop, number 2"; it takes the '
        "PC as its parent.",
        'n2 hears from n1 "1 hop, number 2", ticks and says "2 hops, number 3"; it takes n1 as '
        "its parent."]),
    (SILENT, ("paper", "triggered", "triangle", ONCE), 2, [
        "n1 finds, wrongly, its cable to the PC broken, ticks; it leaves the PC and has no way "
        "left."]),
], ids=lambda one: getattr(one, "name", ""))  # fmt: skip
def test_what_a_cell_says_is_what_it_has_sent(fault, what, at, sentences):
    """Not what it should have, where the protocol is wrong; and nothing where it sent nothing."""
    rule, updates, graph, budget = what
    changed = copy_of(fault)
    model = SkinModel(graphs.parse(graph), rule, updates, budget)
    told = story.tell(explore(model, plain=True, system=changed, states=2_000), changed)
    assert told.sentences[at : at + len(sentences)] == sentences


@pytest.mark.parametrize(("is_cut", "sent"), [(False, True), (True, False)])
def test_news_are_told_where_there_are_any(is_cut, sent):
    tiny = Tiny(faults={"cut": 1})
    tiny.cell(0, FLAGS=r.IS_SOON)
    tiny.port(0, PC, 0, 7, r.IS_PARENT)
    twin = tiny.twin
    if is_cut:
        for link in range(len(tiny.lay.links)):
            tiny.row[tiny.lay.link_at + link] = 1
    made = story.Story("", graph=tiny.model.graph)
    story.Narrator(twin, made).play(twin, Event(story.w.SOON, 0, 0, 0, 1))
    said = 'sends its news: "1 hop, number 0"' if sent else "comes to send news"
    assert made.sentences == [f"n1 {said}; it stays with the PC."]
    assert made.steps == [["soon n1"]]
