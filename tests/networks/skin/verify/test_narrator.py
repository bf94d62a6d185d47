"""A story plays what the search did, event by event: states, words and steps, on random walks."""

import random
from itertools import pairwise, product

import pytest

from innervate import scenario
from innervate.networks.skin.protocol.constants import NONE
from innervate.networks.skin.sim.simulate import simulate
from innervate.networks.skin.verify import graphs, story
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.narrator import Narrator
from innervate.networks.skin.verify.row import WAS_PARENT
from innervate.networks.skin.verify.system import Budget, SkinModel, system_of
from innervate.verify.twin import Event, Twin

EVENTS = 60
BUDGET = Budget(ticks=20, counts=8, loss=3, cut=3, heal=3, false=2, restart=2, faults=12)
SEEDS = range(12)
MODELS = {
    "taken in by ticks": {"updates": "periodic"},
    "at once": {"updates": "periodic", "prompt": True},
    "triggered": {"updates": "triggered"},
}


def heads(twin):
    """All that is known of a state but what is under way, and what was said last."""
    lay, row = twin.lay, twin.row()
    spans = [(at, w.SENT_DIST) for at in lay.cell_at] + [(at + w.WAIT, 2) for at in lay.cell_at]
    spans += [(at, w.SAYS) for at in lay.port_at if at >= 0]
    spans += [(lay.pc_at, w.PC_BYTES), (lay.link_at, len(lay.links))]
    says = [row[at + w.SAYS] & ~WAS_PARENT for at in lay.port_at if at >= 0]
    return [*(row[at : at + size] for at, size in spans), says]


class Walk:
    """A random walk of a search, told as it goes."""

    def __init__(self, seed, budget=BUDGET, graph="triangle", **keys):
        model = SkinModel(graphs.parse(graph), "paper", budget=budget, keep=True,
                          symmetric=False, capacity=8, **keys)  # fmt: skip
        self.chance = random.Random(seed)
        self.found = Twin(model, system_of())
        whole = model.changed(merge=False, unreduced=True, capacity=story.ROOM)
        self.real = Twin(whole, system_of())
        self.story = story.Story("", graph=model.graph)
        self.narrator, self.events = Narrator(self.real, self.story), []

    def step(self):
        """One of all events: of every kind that can be as often."""
        kinds = {}
        for move, variant, choice, asked in self.found.successors():
            kind, arg = self.found.moves[move]
            kinds.setdefault(kind, []).append(Event(kind, arg, variant, choice, asked))
        self.take(self.chance.choice(kinds[self.chance.choice(sorted(kinds))]))

    def take(self, event):
        """One event, told and made."""
        self.narrator.play(self.found, event)
        move = self.found.moves.index((event.kind, event.arg))
        self.found.system.step(self.found.world, move, event.variant, event.choice)
        self.events.append(event)


def walked(seed, **keys):
    walk = Walk(seed, **keys)
    for _ in range(EVENTS):
        walk.step()
        assert heads(walk.real) == heads(walk.found), walk.story.sentences[-1]
    return walk


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("how", MODELS)
def test_what_is_told_is_played_and_ends_alike(how, seed):
    walk = walked(seed, **MODELS[how])
    told, graph = walk.story, walk.story.graph
    assert len(told.sentences) == len(told.steps) == len(told.scenes) == EVENTS
    plan = scenario.plan(scenario.loads(story._scenario(walk.found.model, told)))
    cells = simulate(plan, plain=True).world.cells
    label, node_of, peer = plan.graph.label, plan.graph.node_of, plan.graph.peer
    ends = {label(c): peer[4 * c + cell.parent] for c, cell in enumerate(cells) if cell.parent >= 0}
    assert {name: label(node_of(end)) for name, end in ends.items()} == {
        graph.label(c): graph.label(parent)
        for c, parent in enumerate(told.scenes[-1].parents)
        if parent != NONE
    }


def sentence(walk, event, before, after):
    """How a sentence begins, and ends, from the event and the scenes alone."""
    graph, lay = walk.story.graph, walk.real.lay
    name = [*(graph.label(c) for c in range(graph.cells)), "the PC"]
    ends = [graph.node_of(end) for end in lay.way_end]
    turned, actor = "", after.actor
    if actor not in (NONE, graph.sink):
        old, new = before.parents[actor], after.parents[actor]
        taken = f"takes {name[new]} as its parent"
        turned = (
            (f"; it stays with {name[new]}" if new != NONE else "") if new == old
            else f"; it leaves {name[old]} and has no way left" if new == NONE
            else f"; it leaves {name[old]} and {taken}" if old != NONE
            else f"; it {taken}"
        )  # fmt: skip
    if event.kind in (w.CUT_LINK, w.HEAL_LINK):
        a, b = sorted((ends[2 * event.arg], ends[2 * event.arg + 1]), key=lambda n: n != graph.sink)
        what = "is cut" if event.kind == w.CUT_LINK else "works again"
        names = {
            f"the cable between {name[a]} and {name[b]} {what}",
            f"the cable between {name[b]} and {name[a]} {what}" if a != graph.sink else "",
        }
        return names, ""
    if event.kind == w.RESTART_PC:
        return {"the PC restarts and has forgotten its number"}, ""
    if event.kind in (w.DELIVER, w.LOSE):
        here, there = name[ends[event.arg]], name[ends[event.arg ^ 1]]
        lost = f'lost on its way to {here}: the beacon of {there} "'
        return {lost if event.kind == w.LOSE else f'{here} hears from {there} "'}, turned
    return {name[graph.sink if event.kind == w.PC_TICK else event.arg]}, turned


@pytest.mark.parametrize("how", MODELS)
def test_who_acts_on_what_is_named_in_each_sentence(how):
    kinds = set()
    for seed in SEEDS:
        walk = walked(seed, **MODELS[how])
        scenes = [story.Scene((NONE,) * walk.story.graph.cells, frozenset(), NONE)]
        told = zip(walk.events, walk.story.sentences,
                   pairwise([*scenes, *walk.story.scenes]), strict=True)  # fmt: skip
        for event, text, (before, after) in told:
            kinds.add(event.kind)
            begins, ends = sentence(walk, event, before, after)
            begins = {one[0].upper() + one[1:] if one.startswith("the ") else one for one in begins}
            assert any(one and text.startswith(one) for one in begins), (text, begins)
            assert text.endswith(f"{ends}."), (text, ends)
            assert ends or "; it " not in text
    never = {w.SOON} if how != "triggered" else set()
    never |= {w.DELIVER, w.LOSE} if how == "taken in by ticks" else set()
    every = {w.TICK, w.PC_TICK, w.SOON, w.DELIVER, w.LOSE, w.CUT_LINK, w.HEAL_LINK, w.RESTART_PC}
    assert kinds == every - never


@pytest.mark.parametrize("is_cut", [False, True])
@pytest.mark.parametrize("false", [0, 1, 2, 3])
def test_a_tick_is_told_with_what_it_takes_in_and_finds_broken(false, is_cut):
    """In every way that there is; what may be found broken gets less with each that wrongly is."""
    walk = Walk(0, Budget(loss=0, cut=is_cut, heal=0, false=false, restart=0, faults=4))
    cells = ((w.TICK, c, 1) for c in range(3))
    for kind, arg, variant in ((w.PC_TICK, 0, 0), *cells, (w.PC_TICK, 0, 0)):
        walk.take(Event(kind, arg, variant, 0, 1))  # n1 may hear of all three now
    if is_cut:
        walk.take(Event(w.CUT_LINK, 0, 0, 0, 1))
    rows, told = (walk.found.row(), walk.real.row()), set()
    for move, variant, choice, asked in list(walk.found.successors()):
        if walk.found.moves[move] == (w.TICK, 0):
            walk.found.put(rows[0])
            walk.real.put(rows[1])
            walk.take(Event(w.TICK, 0, variant, choice, asked))
            assert heads(walk.real) == heads(walk.found), walk.story.sentences[-1]
            told.add(walk.story.sentences[-1].partition(" ticks")[0])
    says = {"the PC": '"0 hops, number 2"', "n2": '"2 hops, number 1, you are my parent"',
            "n3": '"2 hops, number 1, you are my parent"'}  # fmt: skip
    ways = [["", f"hears from {name} {says[name]},", f"finds, wrongly, its cable to {name} broken,"]
            for name in says]  # fmt: skip
    if is_cut:
        ways[0] = ["", "finds its cable to the PC broken,"]
    wanted = ([one for one in way if one] for way in product(*ways))
    assert told == {
        " ".join(["n1", *way]) for way in wanted if " ".join(way).count("wrongly") <= false
    }


@pytest.mark.parametrize("choice", [0, 1])
def test_a_draw_falls_in_the_story_as_in_the_search(choice):
    """Of two neighbours as near as each other, for n3; the script says which it is, too."""
    walk = Walk(0, graph="pc-1 pc-2 1-3 2-3", updates="periodic")
    port = next(p for p in range(4) if walk.found.lay.in_way[8 + p] >= 0)
    assert port == 0  # its two cables are its first ports: one frame of each is taken in
    for kind, arg, variant in ((w.PC_TICK, 0, 0), (w.TICK, 0, 1), (w.TICK, 1, 1)):
        walk.take(Event(kind, arg, variant, 0, 1))
    both = 1 + 3 * 1  # of 3 ways that each port has: nothing, a beacon, broken
    walk.take(Event(w.TICK, 2, both, choice, 2))
    assert heads(walk.real) == heads(walk.found)
    name = ("n1", "n2")[choice]
    assert walk.story.sentences[-1].endswith(f"; it takes {name} as its parent.")
    assert walk.story.steps[-1][-2:] == [f"draw {choice}", "tick n3"]
