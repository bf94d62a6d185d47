"""What becomes of a message when the router says something of it, and what that says of others."""

from collections import Counter

import pytest

from innervate.live.receipts import ACCEPTED, DELIVERED, EXPIRED, HOP_ACKED, REFUSED, Receipt
from innervate.networks.mesh.live.outgoing import HANDLES, Outgoing
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from innervate.networks.mesh.protocol.constants import (
    IDS,
    REPORT_ACCEPTED,
    REPORT_ARRIVED,
    REPORT_EXPIRED,
    REPORT_FULL,
    REPORT_HOP,
)


@pytest.fixture
def outgoing():
    stack = MeshStack(0, 0, mesh_parameters(3, {}), 5)
    made = Outgoing(stack, lambda item: None, lambda number, data: None, Counter())
    made.ended = []
    made.turns.ended = lambda handle, is_there: made.ended.append((handle, is_there))
    made.receipts[300] = Receipt()
    return made


@pytest.mark.parametrize(
    ("code", "detail", "state", "reason", "is_there"),
    [
        (REPORT_ACCEPTED, 77, ACCEPTED, "", "goes on"), (REPORT_HOP, 0, HOP_ACKED, "", "goes on"),
        (REPORT_ARRIVED, 0, DELIVERED, "", True),
        (REPORT_EXPIRED, 1, EXPIRED, "no route", False),
        (REPORT_EXPIRED, 2, EXPIRED, "no acknowledgement", False),
        (REPORT_EXPIRED, 3, EXPIRED, "path full", None), (REPORT_EXPIRED, 9, EXPIRED, "", None),
        (REPORT_FULL, 4, REFUSED, "no room", None),
    ],
)  # fmt: skip
def test_what_the_router_says_of_a_message(outgoing, code, detail, state, reason, is_there):
    receipt = outgoing.receipts[300]
    outgoing.told(code, 300, detail)
    assert (receipt.state, receipt.reason) == (state, reason)
    assert receipt.seq == (77 if code == REPORT_ACCEPTED else -1)
    if is_there == "goes on":
        assert (outgoing.ended, list(outgoing.receipts)) == ([], [300])
    else:
        assert (outgoing.ended, outgoing.receipts) == ([(300, is_there)], {})
        assert outgoing._outcomes == {f"messages {state}": 1}
    outgoing.told(REPORT_ARRIVED, 301, 0)  # of none of ours
    assert len(outgoing.ended) == (is_there != "goes on")


def test_handles_are_none_of_robots_and_none_twice(outgoing):
    assert outgoing._take_handle(Receipt()) == IDS
    outgoing._handle = 300
    assert outgoing._take_handle(Receipt()) == 301, "that one is under way"
    outgoing._handle = HANDLES - 1
    assert [outgoing._take_handle(Receipt()) for _ in range(2)] == [HANDLES - 1, IDS + 1]
    outgoing.turns._total, outgoing.turns._count = 2, Counter({7: 2})
    assert outgoing.status() == {"backlog": 2, "waiting": {"7": 2}, "under_way": 3}
