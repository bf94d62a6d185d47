"""What the explorer hands to nodes: the items of GIVEN, each as it is written and no more."""

from types import SimpleNamespace

import pytest

from innervate.verify import declared
from innervate.verify.graphs import graph_of

STATE = (("number", 0, 0, 9, "node", ""), ("kind", 0, 0, 9, "", ""), ("value", 0, 0, 9, "", ""),
         ("most", 0, 0, 9, "", ""), ("path", 2, 0, 9, "", ""))  # fmt: skip
FRAME = (("value", 0, 0, 9, "", ""), ("most", 0, 3, 9, "", ""), ("path", 2, 0, 9, "", ""))


def on_start(node, params, now, cause, out):
    """Nothing happens by itself."""


def on_frame(node, params, now, port, frame, out):
    """No frame is sent."""


def on_input(node, params, now, kind, item, out):
    """Keep what was handed in, and spoil what it came in."""
    node.kind, node.value, node.most, node.path = kind, item.value, item.most, list(item.path)
    item.value, item.most, item.path = 9, 9, [9, 9]


@pytest.fixture
def net():
    protocol = SimpleNamespace(on_start=on_start, on_frame=on_frame, on_input=on_input, TIMERS=1)
    given = ((2, {"value": 7}), (5, {"path": (1, 2), "most": 4}), (1, {}))
    fields = SimpleNamespace(STATE=STATE, FRAME=FRAME, PARAMS=(), GIVEN=given)
    return declared.Net(protocol, fields, graph_of("pair"), {})


def test_each_item_is_handed_to_each_node_and_nothing_of_another(net):
    state = net.begin(declared.Budget(loss=0, restart=0, input=2)).state
    steps = list(net.steps(state))
    assert [step.words for step in steps] == [
        f"n{node} is given {kind} by its user" for node in range(2) for kind in (2, 5, 1)
    ]
    told = [(step.state.nodes[k // 3].values[1:], step.state.left) for k, step in enumerate(steps)]
    kept = [(2, 7, 3, (0, 0)), (5, 0, 4, (1, 2)), (1, 0, 3, (0, 0))]
    assert told == [(one, (0, 0, 1)) for one in 2 * kept]
    again = list(net.steps(steps[0].state))
    assert [step.state.nodes[1].values[1:] for step in again[3:]] == kept
    assert list(net.steps(again[0].state)) == []


def test_the_oldest_frame_comes_in_as_it_was_sent(net):
    """Not as the last one that a node worked on."""
    seen = []
    net.do.on_frame = lambda node, params, now, port, frame, out: seen.append(
        (node.number, port, frame.value, frame.most, tuple(frame.path))
    )
    state = net.begin(declared.Budget()).state
    way = net.graph.end(0, 0)
    sent = state._replace(ways=tuple(((4, 5, (6, 7)), (1, 3, (0, 0))) if end == way else ()
                                     for end in range(len(state.ways))))  # fmt: skip
    after, broken = net.arrive(sent, way)
    peer = net.graph.peer[way]
    assert seen == [(net.graph.node_of(peer), net.graph.port_of(peer), 4, 5, (6, 7))]
    assert (after.ways[way], broken) == (((1, 3, (0, 0)),), "")
