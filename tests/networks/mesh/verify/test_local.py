"""What nodes of an explored mesh draw is theirs alone, and another after every start."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify.local import COLLECTING, NEVER, Locals
from innervate.networks.mesh.verify.model import MeshModel


@pytest.mark.parametrize("count", [1 << 16, 254])
def test_draws_out_of_many_differ_between_nodes_and_starts(count):
    made = Locals(MeshModel(mesh_model.parse("spare")))
    drawn = []
    for made.boots in range(2):
        drawn += [made._who(number, count) for number in range(made.model.nodes)]
    assert all(0 <= one < count for one in drawn)
    assert len(set(drawn)) == len(drawn)


def test_the_fence_is_a_square_of_ten_metres_round_which_one_comes_back():
    fence = mesh_model.FENCE
    corners = list(zip(fence["px"], fence["py"], strict=True))
    assert corners[: fence["points"]] == [(0, 0), (1000, 0), (1000, 1000), (0, 1000)]
    assert fence["after"][: fence["points"]] == [1, 2, 3, 0]
    unused = mesh_fields.POINTS - fence["points"]
    assert corners[4:] == [(0, 0)] * unused
    assert fence["after"][4:] == [0] * unused


def usual(**more):
    """A node with a frame to send, one that waits, a retry and a round, and that does not lead."""
    return Of(**{"q_state": [0, 1, 3], "busy": -1, "wait_kind": [0, 2], "due": 1, "leading": 0,
                 "rank": 0} | more)  # fmt: skip


TIMERS = (const.TX, const.ACK_WAIT, const.RETRY, const.ROUND, const.JOBS)


@pytest.mark.parametrize(("node", "gate", "guard_us", "kept"), [
    (usual(), None, 1, {const.TX, const.RETRY, const.ROUND, const.JOBS}),
    (usual(busy=2), None, 1, {const.ACK_WAIT, const.RETRY, const.ROUND, const.JOBS}),
    (usual(busy=1), None, 1, {const.RETRY, const.ROUND, const.JOBS}),
    (usual(q_state=[0, 3]), None, 1, {const.RETRY, const.ROUND, const.JOBS}),
    (usual(wait_kind=[0, 0]), None, 1, {const.TX, const.ROUND, const.JOBS}),
    (usual(due=0), None, 1, {const.TX, const.RETRY, const.JOBS}),
    (usual(due=0, leading=1), None, 1, {const.TX, const.RETRY, const.JOBS}),
    (usual(due=0, leading=1), Of(step=COLLECTING), 1,
     {const.TX, const.RETRY, const.ROUND, const.JOBS}),
    (usual(due=0, leading=0), Of(step=COLLECTING), 1, {const.TX, const.RETRY, const.JOBS}),
    (usual(due=0, leading=1), Of(step=COLLECTING + 1), 1, {const.TX, const.RETRY, const.JOBS}),
    (usual(rank=-1), None, 1, {const.TX, const.RETRY, const.ROUND}),
    (usual(), None, 0, {const.TX, const.RETRY, const.ROUND}),
    (usual(leading=1, rank=-1), None, 0, {const.TX, const.RETRY, const.ROUND, const.JOBS}),
])  # fmt: skip
def test_timers_that_find_nothing_to_do_tell_no_states_apart(node, gate, guard_us, kept):
    made = Locals(MeshModel(mesh_model.parse("spare")))
    made.params.guard_us = guard_us
    timers = [7] * (max(TIMERS) + 1)
    made._drop_idle(node, gate, timers)
    assert {timer for timer in TIMERS if timers[timer] == 7} == kept
    assert {timers[timer] for timer in TIMERS if timer not in kept} == {NEVER}
