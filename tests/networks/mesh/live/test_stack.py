"""What a node notes of who acknowledges its frames."""

import asyncio

import pytest

from innervate.dialect.outbox import SEND, put
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import ASKED, RSSI, MeshStack
from innervate.networks.mesh.protocol.constants import ACK, ALL, DATA, E2E_ACK
from innervate.networks.mesh.protocol.neighbours import hear, is_suspect, suspect, sweep
from tests.live.net import Mesh


def stack_of():
    return Mesh(2, [(0, 1)]).nodes[0].stack


def test_each_question_is_answered_once():
    stack: MeshStack = stack_of()
    what = (1, 0, 7)
    stack._note_question(what)
    stack._note_answer(what)
    stack._note_answer(what)  # a copy of it
    assert (stack.asked[1], stack.acked[1]) == (1, 1)
    stack._note_question(what)
    stack._note_question(what)  # tried again
    for _ in range(3):
        stack._note_answer(what)
    assert (stack.asked[1], stack.acked[1]) == (3, 3)


def test_answers_to_what_was_asked_long_ago_are_none():
    stack = stack_of()
    for number in range(ASKED + 1):
        stack._note_question((1, 0, number))
    stack._note_answer((1, 0, 0))
    stack._note_answer((1, 0, 1))
    assert stack.acked[1] == 1


@pytest.mark.parametrize("leaves", [40, 63])
def test_a_hub_of_live_nodes_has_all_others_as_neighbours(leaves):
    async def up():
        async with Mesh(1 + leaves, [(0, leaf) for leaf in range(1, 1 + leaves)]) as mesh:
            return len(mesh.nodes[0].stack.status(0)["neighbours"])

    assert asyncio.run(up()) == leaves


def test_who_says_nothing_in_three_rounds_and_a_tick_is_silent():
    params = mesh_parameters(3, {"period_max": 40, "tick_us": 1_000_000})
    assert MeshStack(1, -1, params, 5).silent_us == (3 * 40 + 1) * 1_000_000


@pytest.mark.parametrize(
    ("sent", "behind"),
    [
        ([(ACK, 1), (DATA, 2)], [0]), ([(ACK, 1), (E2E_ACK, 1)], []), ([(ACK, 1), (DATA, ALL)], []),
        ([(ACK, 1), (DATA, 2), (ACK, 2), (ACK, 3)], [0, 3]), ([(ACK, 1), (ACK, 2)], [0, 1]),
        ([(ACK, 1)], []),
    ],
)  # fmt: skip
def test_an_ack_leaves_behind_what_goes_to_others_and_before_what_goes_its_own_way(sent, behind):
    stack = stack_of()
    for kind, whom in sent:
        frame = stack.out.frame[put(stack.out, SEND, 0, 0, 0)]
        frame.kind, frame.link_dst = kind, whom
    assert list(stack.behind(len(sent))) == behind


def said_suspect(stack):
    return [one["node"] for one in stack.status(0)["neighbours"] if one["suspect"]]


def test_who_did_not_acknowledge_is_said_not_to_answer_until_it_is_heard_again():
    """The suspicion ends before: one transmission is made, which nobody answers either."""
    stack = stack_of()
    stack.on_start(0, 0)
    hear(stack.node, stack.params, 1, RSSI)
    suspect(stack.node, stack.params, 0, 1, 0, stack.out)
    for _ in range(2 * stack.params.suspect_us // stack.params.tick_us):
        stack.node.ticks += 1
        sweep(stack.node, stack.params)
    assert not is_suspect(stack.node, stack.params, 1)
    assert said_suspect(stack) == [1]
    hear(stack.node, stack.params, 1, RSSI)
    assert said_suspect(stack) == []


def test_a_gateway_of_which_no_request_came_for_twice_a_standbys_patience_is_silent():
    stack = stack_of()
    stack.node.leading, stack.node.quiet = 0, 2 * stack.params.dead
    assert not stack.status(0)["gateway_silent"]
    stack.node.quiet += 1
    assert stack.status(0)["gateway_silent"]
    stack.node.leading = 1
    assert not stack.status(0)["gateway_silent"]
