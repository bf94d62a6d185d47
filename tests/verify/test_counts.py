"""What an exploration says of itself: how many states, successors, events deep, how it ended.

Two nodes that have nothing to flood count their own ticks, each round a ring of 64 states: what a
search of them finds is known beforehand.
"""

from types import SimpleNamespace

import pytest

from innervate.network import networks
from innervate.topology.free import free_graph
from innervate.verify import cases
from innervate.verify.cases import USUAL, Story, extent, lines_of
from innervate.verify.declared import Net, explore
from innervate.verify.states import Budget
from innervate.verify.tally import Tally

RING = 64  # states of a node that is left alone
ALONE = "loss=0,restart=0,input=0"


def explored(states, tell=lambda *_: False, graph="pair"):
    asked = SimpleNamespace(**USUAL | {"graph": graph, "budget": ALONE, "states": states})
    network = networks()["flooding"]
    (one,) = network.verify.explorations(network, asked)
    return one(tell)


def test_all_states_of_two_that_do_not_meet():
    told = []
    case = explored(0, lambda *said: bool(told.append(said)))
    pairs = RING**2
    expected = {
        "states": pairs, "expanded": pairs, "generated": 2 * pairs, "left_out": 0,
        "depth": 2 * (RING - 1), "ended": "complete", "broken": None, "story": None,
        "draws": {"every": [], "some": [], "left_out": 0}, "readings": [], "past": [],
    }  # fmt: skip
    assert case.record == {"graph": case.record["graph"], **expected}
    assert case.is_complete
    assert [said[1:] for said in told] == [(0, 0)] * (pairs // 500)
    # Of the first 63 levels, level d has d + 1 states.
    events = [int(what.split()[-3]) for what, _, _ in told]
    assert events[:4] == [31, 44, 54, 62]


@pytest.mark.parametrize("limit", [2, 10, 300])
def test_a_search_ends_with_the_state_that_is_one_too_many(limit):
    found = explored(limit)
    record = found.record
    assert (record["ended"], found.is_complete) == ("limit", False)
    assert limit <= record["states"] <= limit + 1
    assert record["generated"] == 2 * record["expanded"]
    # So many levels are whole; who stands on the next has been found from the one before.
    depth = record["depth"]
    assert depth * (depth + 1) // 2 < record["expanded"] <= (depth + 1) * (depth + 2) // 2


def test_a_search_that_is_ended_early_says_so():
    case = explored(0, lambda *_: True)
    assert (case.record["ended"], case.record["expanded"]) == ("interrupted", 500)
    assert not case.is_complete
    assert not case.is_broken


def net_of(**budget):
    """A pair that floods, as it is explored, with something that may happen."""
    network = networks()["flooding"]
    params = {**network.fields.DEFAULTS, **getattr(network.fields, "EXPLORED", {}),
              **getattr(network.protocol, "EXPLORED", {})}  # fmt: skip
    net = Net(network.protocol, network.fields, free_graph([("n0.E", "n1.W")]), params)
    net.on_air, net.has_carrier = True, hasattr(network.protocol, "on_carrier")
    return net, Budget(**{"loss": 0, "restart": 0, "input": 0, **budget})


def is_full(state):
    waiting = [*state.ways, *(node.down for node in state.nodes)]
    return max(len(frames) for frames in waiting) == 4


def test_successors_with_a_fourth_frame_under_way_are_left_out_and_counted():
    net, budget = net_of(input=5)
    tally, story = explore(net, budget, 1_500, lambda *_: False, "a pair")
    known = {net.begin(budget).state: 0}
    queue, generated, left_out, expanded = [*known], 0, 0, 0
    while expanded < tally.expanded:
        state = queue[expanded]
        expanded += 1
        for step in net.steps(state):
            generated += 1
            if is_full(step.state):
                left_out += 1
            elif step.state not in known:
                known[step.state] = known[state] + 1
                queue.append(step.state)
    assert (tally.states, tally.generated) == (len(known), generated)
    assert tally.left_out == left_out > 0
    assert tally.depth == known[queue[expanded - 1]]
    assert (tally.ended, story.title) == ("limit", "")
    assert 0 < tally.wall_s < 100


def test_what_is_broken_from_the_start_is_one_state():
    net, budget = net_of()
    net.own = {"nobody is": lambda *_: False}
    tally, story = explore(net, budget, 100, lambda *_: False, "a pair")
    assert (tally.states, tally.expanded, tally.ended) == (1, 0, "broken")
    assert (story.title, story.sentences) == ("nobody is", ["n0 is switched on."])


def test_what_holds_of_all_nodes_is_looked_at_before_the_first_event():
    net, budget = net_of()
    net.of_all = {"nobody is": lambda nodes, *_: False}
    tally, story = explore(net, budget, 100, lambda *_: False, "a pair")
    assert (story.title, story.sentences) == ("nobody is", ["All nodes are switched on."])
    assert (tally.states, tally.expanded, tally.ended) == (1, 0, "broken")


def test_what_holds_of_all_nodes_is_looked_at_behind_each_event():
    net, budget = net_of()
    seen = []
    net.of_all = {"no node ticks": lambda nodes, *_: not seen and not seen.append(1)}
    tally, story = explore(net, budget, 100, lambda *_: False, "a pair")
    assert (story.title, tally.ended) == ("no node ticks", "broken")
    assert len(story.sentences) == 1
    assert (tally.states, tally.expanded) == (1, 1)


@pytest.mark.parametrize(("states", "successors", "words"), [
    (1, 1, "1 state 1 successor"), (2, 3_000, "2 states 3,000 successors"),
])  # fmt: skip
def test_one_of_a_thing_is_told_as_one(states, successors, words):
    tally = Tally(states=states, expanded=states, generated=successors, depth=1, ended="limit")
    assert " ".join(cases.many(tally).split()) == words
    assert extent(tally).startswith(f"first {words.split(' state')[0]} state")
    assert extent(tally).endswith(", to 1 event, as asked")
    assert lines_of("head", Story("closed loop", ["one"]), str)[0] == "head  BROKEN after 1 event"
