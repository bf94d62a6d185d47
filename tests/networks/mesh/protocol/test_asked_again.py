"""Who is named by others and did not respond is asked once more, and nobody else responds."""

import binascii

import pytest

from innervate.networks.mesh import frames as wire
from innervate.networks.mesh.protocol.constants import (
    REPORT_GRAPH,
    REPORT_ROUND,
    REQUEST,
    RESPONSE,
)
from innervate.networks.mesh.protocol.gateway import ASKED, ASKED_MAX, on_response
from innervate.networks.mesh.protocol.paths import is_heard, is_known
from innervate.networks.mesh.protocol.round import REQUEST_BYTES
from tests.networks.mesh.bench import Bench, Frame

COLLECTED, PERIOD, S = 1_500_000, 10_000_000, 1_000_000
ROW = [(0, 1), (1, 2), (2, 3)]


def row(until=0, who=(3,), links=ROW, count=4, **more):
    """Nodes in a row; up to a time nobody hears the responses of some, nor what they relay."""
    bench = Bench(count, links, **{"asks": 1, **more})
    bench.lost = lambda frame, to: (
        frame.kind == RESPONSE and frame.link_src in who and bench.now < until
    )
    return bench


def requests(bench):
    """The payloads of the gateway's requests, once each: who is asked by name."""
    own = [frame for _, i, frame in bench.sent if frame.kind == REQUEST and i == frame.body[0]]
    named = {
        frame.body[2] << 8 | frame.body[3]: list(frame.body[REQUEST_BYTES : frame.length])
        for frame in own
    }
    return list(named.values())


def responders(bench, since):
    return {f.origin for at, _, f in bench.sent if f.kind == RESPONSE and at > since}


@pytest.mark.parametrize("asks", [0, 1])
def test_who_is_named_and_did_not_respond_is_asked_before_tables_are_made(asks):
    bench = row(COLLECTED, asks=asks)
    bench.run(9 * S)
    assert (bench.nodes[3].version != 0) == asks
    assert responders(bench, COLLECTED) == ({3} if asks else set())
    assert requests(bench) == [[], [3]][: 1 + asks]
    told = [code for _, i, code, *_ in bench.reports if i == 0]
    assert (told.count(REPORT_ROUND), told.count(REPORT_GRAPH)) == (1, 1)
    assert all(node.version == bench.gates[0].version for node in bench.nodes[: 3 + asks])


def test_who_does_not_respond_again_is_not_asked_a_third_time():
    bench = row(2 * COLLECTED)
    bench.run(9 * S)
    assert requests(bench) == [[], [3]]
    assert [node.version != 0 for node in bench.nodes] == [True, True, True, False]
    bench.run(PERIOD + 2 * S)
    assert requests(bench) == [[], [3], []], "a new round asks all"
    assert bench.nodes[3].version == bench.gates[0].version


def test_what_is_late_counts_while_others_are_asked_again():
    """Not only for whom it is: who responds in two packets, of which one came, is not asked."""
    bench = row(collect_us=800_000)  # sooner than a hop gives up
    first = bench.nodes[3].round + 1
    bench.lost = lambda frame, to: (
        frame.kind == RESPONSE
        and frame.origin == 3
        and (bench.now < 820_000 or frame.body[2] != first)
    )
    bench.run(9 * S)
    assert requests(bench) == [[], [3]]
    assert is_known(bench.gates[0], bench.params, 2, 3)
    assert bench.nodes[3].version == bench.gates[0].version


@pytest.mark.parametrize("late", [-1, 2])
def test_no_other_round_counts(late):
    bench = row(COLLECTED)
    bench.run(COLLECTED + S)
    node, gate, frame = bench.nodes[0], bench.gates[0], Frame()
    assert gate.step == ASKED
    frame.origin, frame.length = 3, 6
    frame.body[:6] = [node.epoch, 0, node.round - late, 3 << 4 | 1, 1, -60 & 255]
    gate.heard = [0] * len(gate.heard)
    on_response(node, gate, bench.params, bench.now, frame, bench.out)
    assert not is_heard(gate, bench.params, 1, 3)


def test_where_all_respond_nothing_changes():
    few, many = row(asks=0), row(asks=1)
    for bench in (few, many):
        bench.run(9 * S)
    said = [
        [(at, i, f.kind, f.origin, f.seq, f.length) for at, i, f in bench.sent]
        for bench in (few, many)
    ]
    assert said[0] == said[1]


def test_who_is_dead_is_named_by_nobody():
    bench = row()
    bench.dead.add(3)
    bench.run(9 * S)
    assert requests(bench) == [[]]


def test_who_died_since_is_asked_for_in_no_later_round():
    bench = row()
    bench.run(9 * S)
    bench.dead.add(3)
    bench.run(PERIOD + 9 * S)
    assert requests(bench) == [[], []]


def test_as_many_are_named_as_fit():
    star = [(0, i) for i in range(1, 32)]
    bench = row(COLLECTED, range(1, 32), star, 32)
    bench.run(4 * S)
    assert requests(bench) == [[], list(range(1, 1 + ASKED_MAX))]
    assert all(node.version for node in bench.nodes[: 1 + ASKED_MAX])
    assert not any(node.version for node in bench.nodes[1 + ASKED_MAX :])


def test_a_takeover_in_which_nobody_has_to_respond_asks_nobody():
    ring = [(i, (i + 1) % 6) for i in range(6)]
    bench = row(0, (), ring, 6, standbys=(1,), standby=1, guard_us=200_000)
    bench.run(15 * S)
    bench.dead.add(0)
    bench.run(PERIOD + 9 * S)
    assert bench.nodes[1].leading
    assert requests(bench) == [[]] * len(requests(bench))
    assert all(bench.nodes[i].version for i in range(1, 6))


@pytest.mark.parametrize("length", [6, 7, 8, 27])
def test_a_request_on_the_wire_names_any_number_of_nodes(length):
    body = bytes([0x40 | REQUEST, *[0] * (10 + length)])
    data = body + binascii.crc_hqx(body, 0xFFFF).to_bytes(2, "big")
    assert wire.decode(data, Frame()) == (wire.OK if length >= REQUEST_BYTES else wire.BAD_PAYLOAD)
