"""A link that is too faint to rely on is none, even if a response has crossed it by luck."""

import pytest

from innervate.networks.mesh.protocol.constants import LIST, RESPONSE, TREE
from innervate.networks.mesh.protocol.constants import WEAK as FLAG
from innervate.networks.mesh.protocol.gateway import on_response
from innervate.networks.mesh.protocol.paths import is_heard, is_known
from tests.networks.mesh.bench import Bench, Frame
from tests.networks.mesh.net import Net

SETTLED = 5_000_000
FAINT, JUST, LEAST = -96, -95, -93  # of links: too faint; not quite; loud enough to be reported
LINE = [*((i, i + 1) for i in range(7)), (7, 8)]  # the last but one hears two


def line(near, rssi):
    """Nodes in a row, and a short cut from `near` to the seventh: that request comes first."""
    both = {(near, 7): rssi, (7, near): rssi}
    bench = Net(9, [*LINE, (near, 7)], rssi=both, discovery=LIST)
    bench.run(SETTLED)
    return bench


def next_hop(bench, i, to):
    node = bench.nodes[i]
    return node.next[node.bank * bench.params.width + to]


@pytest.mark.parametrize("near", [0, 1])
def test_a_response_that_came_over_a_faint_link_does_not_make_it_one(near):
    bench = line(near, FAINT)
    up = [(i, frame.link_dst) for _, i, frame in bench.sent if frame.kind == RESPONSE]
    assert (7, near) in up, "it had no other way up when it responded"
    assert not is_known(bench.gates[0], bench.params, near, 7)
    assert is_known(bench.gates[0], bench.params, 6, 7)
    assert next_hop(bench, 0, 7) == 1
    assert next_hop(bench, near, 7) == near + 1
    assert next_hop(bench, 7, 0) == 6


@pytest.mark.parametrize("near", [0, 1])
def test_nor_one_over_a_link_that_is_faint_the_other_way(near):
    """Who sends it hears the other so: tables went that way, and came to nobody."""
    bench = Net(9, [*LINE, (near, 7)], rssi={(near, 7): FAINT, (7, near): JUST}, discovery=LIST)
    bench.run(SETTLED)
    up = {frame.flags & FLAG for _, i, frame in bench.sent
          if frame.kind == RESPONSE and (i, frame.link_dst) == (7, near)}  # fmt: skip
    assert up == {FLAG}, "it had no other way up when it responded"
    assert not is_known(bench.gates[0], bench.params, near, 7)
    assert next_hop(bench, near, 7) == near + 1


@pytest.mark.parametrize("near", [0, 1])
def test_one_that_is_just_loud_enough_is_used(near):
    bench = line(near, JUST)
    assert is_known(bench.gates[0], bench.params, near, 7)
    assert next_hop(bench, near, 7) == 7


def test_who_hears_nobody_well_has_its_faint_link():
    faint = {(1, 2): FAINT, (2, 1): FAINT}
    bench = Net(3, [(0, 1), (1, 2)], rssi=faint, discovery=LIST)
    bench.run(SETTLED)
    assert is_known(bench.gates[0], bench.params, 1, 2)
    assert (next_hop(bench, 0, 2), next_hop(bench, 2, 0)) == (1, 1)


def told(flags, rssi, listed, discovery=LIST, loud=LEAST):
    """Whether the gateway takes 2 - 1 - 0 for links after a response of 2 by way of 1."""
    bench = Bench(4, [(0, 1), (1, 2), (2, 3)], discovery=discovery)
    gate, frame = bench.gates[0], Frame()
    frame.kind, frame.flags, frame.rssi, frame.origin = RESPONSE, flags, rssi, 2
    frame.path_len, frame.path[0], frame.path[1] = 2, 2, 1
    node = bench.nodes[0]
    head = [node.epoch, node.round >> 8, node.round & 255, discovery << 4 | len(listed)]
    body = head + [byte for who in listed for byte in (who, loud & 255)]
    frame.length, frame.body[: len(body)] = len(body), body
    gate.heard = [0] * len(gate.heard)
    on_response(node, gate, bench.params, bench.now, frame, bench.out)
    for who in listed:
        assert is_heard(gate, bench.params, who, 2) or discovery != LIST
    pairs = [is_heard(gate, bench.params, *pair) for pair in ((2, 1), (1, 0), (0, 1))]
    assert len(set(pairs)) == 1
    return pairs[0]


def test_when_the_way_of_a_response_counts():
    assert told(0, JUST, [3, 1])
    assert not told(0, FAINT, [3, 1]), "the last hop was faint"
    assert not told(FLAG, JUST, [3, 1]), "one before was"
    assert not told(FLAG, LEAST, [3], loud=LEAST), "it hears one well"
    assert told(FLAG, FAINT, [3], loud=LEAST - 1), "it hears nobody well"
    assert told(FLAG, FAINT, [], TREE), "nothing but ways is told"


@pytest.mark.parametrize(("rssi", "flag"), [(FAINT, FLAG), (JUST, 0), (-20, 0)])
def test_who_passes_a_response_on_says_that_it_came_over_a_faint_link(rssi, flag):
    bench = line(1, rssi)
    (passed,) = {
        frame.flags & FLAG
        for _, i, frame in bench.sent
        if i == 1 and frame.kind == RESPONSE and frame.origin == 7
    }
    assert passed == flag
