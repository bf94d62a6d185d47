"""What nodes draw while they are explored: every outcome where there are few, and what is said."""

from types import SimpleNamespace

import pytest

from innervate.cli.options import VerifyOptions
from innervate.dialect import plain, rng
from innervate.dialect.outbox import send, set_timer
from innervate.verify import declared, draws
from innervate.verify.cases import verdict
from innervate.verify.graphs import graph_of

TOP = 1073741823
GENERATOR = (("rng", 0, 0, TOP, "raw", ""), ("choice", 0, -1, TOP, "raw", ""),
             ("asked", 0, 0, TOP, "raw", ""))  # fmt: skip
STATE = (("number", 0, 0, 9, "node", ""), *GENERATOR, ("wait", 0, 0, TOP, "slots", ""))
FIELDS = SimpleNamespace(STATE=STATE, FRAME=(("kind", 0, 0, 3, "type", ""),), PARAMS=())
ALONE = "loss=0,restart=0,input=0"


def nothing(*_):
    """Nothing happens."""


def protocol(**handlers):
    """A protocol of these handlers; others do nothing, but that a timer is set at the start."""

    def on_start(node, params, now, cause, out):
        set_timer(out, 0, now + 1)

    usual = {"on_start": on_start, "on_frame": nothing, "on_input": nothing,
             "on_timer": nothing, "TIMERS": 1, "OUTBOX": 4}  # fmt: skip
    return SimpleNamespace(**usual | handlers)


def explored(made, rules=None, *, budget=ALONE, states=3_000, graph="pair"):
    """The case of a protocol, and what of it must hold of both nodes' waits."""
    invariants = SimpleNamespace(**{f"network_{i}": rule for i, rule in enumerate(rules or ())})
    parts = {"protocol": made, "fields": FIELDS, "invariants": invariants}
    network = SimpleNamespace(name="dice", medium="cables", has=parts.__contains__,
                              **parts)  # fmt: skip
    asked = VerifyOptions(graph=graph, budget=budget, states=states)
    (one,) = declared.explorations(network, asked)
    return one(lambda *_: False)


def never(*waits):
    def rule(nodes, count, params):
        """these waits meet"""
        return tuple(node.wait for node in nodes) != waits

    return rule


@pytest.mark.parametrize(("graph", "ends"), [
    ("n0.E-n1.W", {(0, 1): (1, 0)}), ("n0.up-n1.W", {(0, 2): (1, 0)}),
])  # fmt: skip
def test_a_rule_of_all_nodes_may_ask_who_is_joined(graph, ends):
    def is_joined(nodes, count, params, peer):
        """no cable where one is"""
        both = {**ends, **{far: near for near, far in ends.items()}}
        return all(
            peer[4 * node + port] == 4 * both.get((node, port), (0, 0))[0]
            + both[node, port][1] if (node, port) in both else peer[4 * node + port] == -1
            for node in range(count) for port in range(4)
        )  # fmt: skip

    def is_alone(nodes, count, params, peer):
        """somebody is joined"""
        return max(peer) < 0

    assert not explored(throws(2), [is_joined], graph=graph, states=20).is_broken
    broken = explored(throws(2), [is_joined, is_alone], graph=graph, states=20)
    assert broken.story.title == "somebody is joined"


def throws(size):
    """Each node draws when its timer fires, again and again."""

    def on_timer(node, params, now, timer, out):
        node.wait = rng.draw(node, size)
        set_timer(out, 0, now + 1)

    return protocol(on_timer=on_timer)


def starts(size, times=1):
    """Each node draws when it is switched on, and never again."""

    def on_start(node, params, now, cause, out):
        for _ in range(times):
            node.wait = rng.draw(node, size)
        set_timer(out, 0, now + 1)

    def on_timer(node, params, now, timer, out):
        set_timer(out, 0, now + 1)

    return protocol(on_start=on_start, on_timer=on_timer)


@pytest.mark.parametrize(("made", "sentences"), [
    (starts(8), ["All nodes are switched on, n0 draws 3 out of 8, n1 draws 5 out of 8."]),
    (throws(8), ["Timer 0 of n0 fires, n0 draws 3 out of 8: wait 0 to 3.",
                 "Timer 0 of n1 fires, n1 draws 5 out of 8: wait 0 to 5."]),
])  # fmt: skip
def test_what_breaks_for_certain_draws_is_found_and_they_are_told(made, sentences):
    case = explored(made, [never(3, 5)])
    assert (case.story.title, case.story.sentences) == ("these waits meet", sentences)
    assert case.record["draws"] == {"every": [8], "some": [], "left_out": 0}


@pytest.mark.parametrize("made", [starts(8), throws(8)])
def test_all_is_said_where_every_outcome_was_tried(made):
    case = explored(made, [never(3, 8)])
    assert (case.is_broken, case.is_complete) == (False, True)
    assert case.record["states"] >= 64
    assert case.lines[0].endswith("all states")


def test_a_story_that_drew_at_the_start_tells_it_first():
    def on_timer(node, params, now, timer, out):
        node.wait += 1
        set_timer(out, 0, now + 1)

    made = starts(4)
    made.on_timer = on_timer
    case = explored(made, [never(3, 4)])
    assert case.story.sentences == [
        "All nodes are switched on, n0 draws 3 out of 4, n1 draws 3 out of 4.",
        "Timer 0 of n1 fires: wait 3 to 4.",
    ]


def test_a_story_plays_again_with_the_draws_that_it_names():
    """Handlers that are called as the story says, each with its draw as `choice`."""
    made = throws(8)
    case = explored(made, [never(6, 2)])
    nodes = [plain.make("Node", STATE)() for _ in range(2)]
    out = plain.Outbox(plain.make("Frame", FIELDS.FRAME), 4)
    for said in case.story.sentences:
        words = said.replace(",", "").split()
        node = nodes[int(words[3][1:])]
        node.choice = int(words[words.index("draws") + 1])
        made.on_timer(node, None, 0, int(words[1]), out)
        assert (node.asked, node.wait) == (8, node.choice)
    assert [node.wait for node in nodes] == [6, 2]


@pytest.mark.parametrize(("wait", "found"), [(0, True), (1, True), (500, True), (999, True),
                                             (2, False), (700, False)])  # fmt: skip
def test_of_a_wide_draw_some_outcomes_are_tried_and_that_is_said(wait, found):
    def rule(nodes, count, params):
        """nobody has drawn it"""
        return wait == 0 or nodes[1].wait != wait

    case = explored(starts(1_000), [rule])
    assert case.is_broken == (found and wait > 0)
    assert case.record["draws"] == {"every": [], "some": [1_000], "left_out": 0}
    if not case.is_broken:
        assert not case.is_complete
        assert case.lines[0].endswith(
            "all states; of draws out of 1,000 only the first, second, middle and last were tried"
        )
        assert verdict([case]) == "Nothing broken in one exploration, only in part."


def test_of_an_event_with_too_many_ways_the_first_are_tried_and_that_is_said():
    case = explored(starts(8, times=2))  # 8^4 ways to begin
    assert case.record["draws"] == {"every": [], "some": [8], "left_out": 1}
    assert not case.is_complete
    assert case.lines[0].endswith(f"of 1 event only {draws.OUTCOMES} ways to draw were tried")


def test_who_draws_until_it_differs_comes_to_an_end():
    def on_timer(node, params, now, timer, out):
        node.wait = rng.draw(node, 2)
        while node.wait == 0:
            node.wait = rng.draw(node, 2)
        set_timer(out, 0, now + 1)

    case = explored(protocol(on_timer=on_timer), graph="pair")
    assert not case.is_broken
    assert case.record["ended"] == "complete"
    assert (case.is_complete, case.record["draws"]["some"]) == (False, [2])
    assert case.lines[0].endswith("of events with more than 16 draws only the first 16 were tried")


def test_where_there_is_one_to_draw_nothing_is_told_of_it():
    case = explored(throws(1), [never(1, 1)])
    assert case.record["draws"] == {"every": [], "some": [], "left_out": 0}
    assert (case.is_complete, case.record["states"]) == (True, 1)


def test_a_draw_out_of_nothing_is_told_with_its_line():
    def on_timer(node, params, now, timer, out):
        rng.draw(node, node.wait)

    line = on_timer.__code__.co_firstlineno + 1
    said = explored(protocol(on_timer=on_timer)).story.title
    assert said.endswith(f"test_draws.py:{line}: ValueError: a draw out of 0: "
                         "there is nothing to draw")  # fmt: skip


def test_every_kind_of_event_draws():
    """On the air: a frame comes, is lost, goes out, finds no room, ends; a start, an input."""

    def on_any(node, *_):
        node.wait = rng.draw(node, 3)

    def on_input(node, params, now, kind, item, out):
        on_any(node)
        out.frame[send(out, 0, 0, 0)].kind = 1

    made = protocol(on_frame=on_any, on_carrier=on_any, on_sent=on_any, on_input=on_input,
                    on_timer=on_any, on_start=on_any)  # fmt: skip
    fields = SimpleNamespace(**vars(FIELDS), GIVEN=((1, {}),))
    net = declared.Net(made, fields, graph_of("pair"), {})
    net.on_air, net.ends_of = True, lambda number, port: [net.graph.end(number, 0)]
    state, seen = net.begin(declared.Budget(2, 1, 1)).state, []
    for kind in ("is given", "goes out", "has ended", ""):
        seen += [step.words for step in net.steps(state)]
        state = next(step.state for step in net.steps(state)
                     if kind in step.words and "n0 draws 0" in step.words)  # fmt: skip
    kinds = {words.partition(", ")[0] for words in seen}
    for value in range(3):
        drew = {words.partition(", ")[0] for words in seen if f"draws {value} out of 3" in words}
        assert drew == kinds
    assert {words.replace("n1", "n0") for words in kinds} == {
        "n0 does not hear a frame of n0", "A frame of n0 finds the channel busy and is given up",
        "A frame of n0 goes out", "A frame of n0 has ended", "n0 hears a frame of n0",
        "n0 is given 1 by its user", "n0 loses its memory",
    }  # fmt: skip


def test_a_network_that_declares_no_generator_is_as_it_was():
    plainly = plain.make("Node", (("number", 0, 0, 9, "node", ""),))
    assert draws.Draws().node(plainly) is plainly
