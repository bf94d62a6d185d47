"""Any network on the air, explored: what others are handed, and when one's own frame has ended."""

from types import SimpleNamespace

import pytest

from innervate.dialect.outbox import send
from innervate.verify import declared
from innervate.verify.graphs import graph_of

COUNTED = (("number", 0, 0, 9, "node", ""), ("count", 0, 0, 3, "number", ""))
FIELDS = SimpleNamespace(STATE=COUNTED, FRAME=(("kind", 0, 0, 15, "type", ""),), PARAMS=())


@pytest.mark.parametrize(("field", "broken"), [("kind", True), ("rssi", False)])
def test_a_receiver_leaves_the_frame_as_it_is_on_the_air(field, broken):
    """Others are handed the same one; a run says so, too. How loud it was is each one's own."""

    def on_frame(node, params, now, port, frame, out):
        setattr(frame, field, 3)

    def on_start(node, params, now, cause, out):
        send(out, 0, 0, 0)

    frame = (*FIELDS.FRAME, ("rssi", 0, 0, 15, "dBm", ""))
    fields = SimpleNamespace(STATE=COUNTED, FRAME=frame, PARAMS=())
    protocol = SimpleNamespace(on_start=on_start, on_frame=on_frame, TIMERS=1, OUTBOX=2)
    made = declared.Net(protocol, fields, graph_of("pair"), {})
    made.on_air = True
    _, found = made.arrive(made.begin(declared.Budget()).state, 0)
    said = "a receiver changed the frame that the others are handed, too"
    assert found == (said if broken else "")


def talks(has_carrier=True, is_told=False):
    """Node 0 of a pair says something, and once more when it has ended; it counts both."""

    def say(node, out):
        node.count += 1
        send(out, 0, 0, 0)

    def on_start(node, params, now, cause, out):
        if node.number == 0:
            say(node, out)

    def on_carrier(node, params, now, cd, voc, out):
        if node.number == 0 and cd == 0 and node.count < 2:
            say(node, out)

    parts = {"on_start": on_start, "on_frame": lambda *_: None, "TIMERS": 1, "OUTBOX": 2}
    parts |= {"on_carrier": on_carrier} if has_carrier else {}
    parts |= {"on_sent": lambda *_: None} if is_told else {}
    made = declared.Net(SimpleNamespace(**parts), FIELDS, graph_of("pair"), {})
    made.on_air = True
    made.own = {"it says nothing twice": lambda node, params, now: node.count < 2}
    return declared.explore(made, declared.Budget(0, 0, 0), 50, lambda *_: False, "a pair")


ENDED = "A frame of n0 has ended: count 1 to 2."


@pytest.mark.parametrize(("keys", "sentences"), [
    ({}, [ENDED]), ({"is_told": True}, ["A frame of n0 goes out.", ENDED]),
])  # fmt: skip
def test_who_has_sent_on_the_air_is_told_when_its_own_frame_has_ended(keys, sentences):
    tally, story = talks(**keys)
    assert (tally.ended, story.title) == ("broken", "it says nothing twice")
    assert story.sentences == sentences


def test_who_does_not_listen_is_not_told():
    tally, story = talks(has_carrier=False)
    assert (tally.states, story.title) == (2, declared.STUCK)
    assert story.sentences == ["n1 hears a frame of n0."]


@pytest.mark.parametrize(("graph", "ways"), [
    ("pair", [(0, 1), (1, 0)]), ("line", [(0, 1), (1, 0), (1, 2), (2, 1)]),
    ("n0-n1 n0-n1 n0-n2", [(0, 1), (0, 2), (1, 0), (2, 0)]),
])  # fmt: skip
def test_a_frame_on_the_air_comes_once_to_each_who_hears_it(graph, ways):
    def on_start(node, params, now, cause, out):
        send(out, 0, 0, 0)

    protocol = SimpleNamespace(on_start=on_start, TIMERS=1, OUTBOX=2)
    made = declared.Net(protocol, FIELDS, graph_of(graph), {})
    made.on_air = True
    state = made.begin(declared.Budget()).state
    graph = made.graph
    assert [len(frames) for frames in state.ways if frames] == [1] * len(ways)
    assert sorted((end // 4, graph.node_of(graph.peer[end]))
                  for end, frames in enumerate(state.ways) if frames) == ways  # fmt: skip


@pytest.mark.parametrize(("graph", "said"), [
    ("pair", "n0 - n1"), ("line", "n0 - n1, n1 - n2"), ("ring", "n0 - n1, n0 - n2, n1 - n2"),
])  # fmt: skip
def test_on_the_air_a_graph_is_who_hears_whom(graph, said):
    assert declared.hearing(graph_of(graph)) == said
