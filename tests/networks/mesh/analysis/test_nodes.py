"""Each node at the end of a run: what it knew and sent, of a run of five nodes made by hand."""

from types import SimpleNamespace as Of

from innervate.networks.mesh.analysis.nodes import Node, nodes
from innervate.networks.mesh.protocol.constants import (
    ACK,
    ACTIVATE,
    ALARM,
    DATA,
    REPORT_EXPIRED,
    REPORT_SUSPECT,
    REQUEST,
    TABLE,
)
from innervate.scenario.actions.field import CUT, KILL
from tests.networks.mesh.analysis.test_network import sent
from tests.networks.mesh.analysis.test_summary import S, fault, made

UNKNOWN = 255


def test_a_node_is_what_it_knew_and_sent_by_the_end():
    frames = [
        sent(0, S, 0, REQUEST, size=10), sent(S, 3 * S, 1, TABLE, origin=0, seq=4, size=20),
        sent(3 * S, 4 * S, 2, ACK, origin=0, seq=4, size=5), sent(4 * S, 5 * S, 1, ACTIVATE),
        sent(5 * S, 7 * S, 3, DATA, origin=3, seq=5), sent(7 * S, 8 * S, 2, DATA, origin=3, seq=5),
        sent(8 * S, 9 * S, 2, DATA, origin=4, seq=6), sent(9 * S, 9 * S, 2, ALARM, origin=3),
        sent(9 * S, 10 * S, 1, ACK, origin=3, seq=5, size=7),
    ]  # fmt: skip
    rows = [(S, 1, REPORT_SUSPECT, 3), (2 * S, 2, REPORT_SUSPECT, 3), (3 * S, 3, REPORT_SUSPECT, 2),
            (4 * S, 0, REPORT_EXPIRED, 1)]  # fmt: skip
    result = made(
        rows, frames, ended_us=10 * S, faults=[fault(S, CUT, 0, 1), fault(2 * S, KILL, 4)]
    )
    knows = ((1, 0, 7), (2, 0, 7), (3, 0, 6), (UNKNOWN, UNKNOWN, 0), (1, 3, 1))
    result.world = Of(nodes=[Of(depth=d, gateway=g, version=v) for d, g, v in knows])
    assert nodes(result) == [
        Node(0, True, 0, 0, 0, 7, 10, 0, 0.1, 0),
        Node(1, True, 1, 1, 0, 7, 30, 0, 0.4, 0),
        Node(2, True, 2, 2, 0, 6, 5, 2, 0.3, 1),
        Node(3, True, 1, None, None, 0, 0, 0, 0.2, 2),
        Node(4, False, 0, 0, 3, 1, 0, 0, 0.0, 0),
    ]
