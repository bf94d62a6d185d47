"""What RFC 8966 says, sentence by sentence, of updates, requests and Hellos."""

import pytest

import innervate
from innervate.network import networks
from innervate.networks.babel.protocol import fields
from innervate.networks.babel.protocol.constants import INFINITY, LOOK, NONE, PORTS, SOON, TICK
from innervate.networks.babel.protocol.links import rxcost_of
from innervate.prove.theory import prove
from tests.networks.babel.bench import (
    HELLO_US,
    UPDATE_US,
    Bench,
    C,
    asked_for_routes,
    requests,
    routed,
    updates,
)

# 3.7: what is said.


# "Every Babel speaker MUST advertise each of its selected routes on every interface, at least
# once every Update interval." [3.7.1]
def test_3_7_1_periodic_updates():
    bench = routed(0)
    bench.tick()
    told = [updates(bench.tick()) for _ in range(8)]
    assert [set(one) for one in told] == [set(), set(), set(), {1, 2, 3}] * 2


# Without a route there is none to advertise; one that was advertised is retracted [3.7.1, 3.7.2].
def test_3_7_1_without_a_route_nothing_is_told():
    bench = Bench().up(0)
    assert updates(bench.advertise() + bench.advertise()) == {}
    bench.update(0, 5, C)
    assert {metric for _, metric in updates(bench.advertise()).values()} == {2 * C}
    bench.update(0, 5, INFINITY)
    assert {metric for _, metric in updates(bench.advertise()).values()} == {INFINITY}


# The Interval of an update is an upper bound on when the next one comes; it has 16 bits [4.6.9].
def test_4_6_9_what_a_frame_says_of_the_next_update_is_kept():
    for hello_us, hellos, beats in ((1_000_000, 64, 6), (1_000_000, 6, 6), (100_000, 64, 64),
                                    (110_000, 64, 59)):  # fmt: skip
        bench = routed(0, hello_us=hello_us, update_hellos=hellos)
        told = [bench.timer(TICK, hello_us) for _ in range(2 * beats + 1)]
        with_one = [place for place, sent in enumerate(told) if updates(sent)]
        assert with_one == [0, beats, 2 * beats]
        (said,) = {f.update for place in with_one for _, f in told[place] if f.has_update}
        assert said == beats * hello_us // 100 <= 65535


# "When a route is retracted, a node SHOULD send a triggered update and SHOULD make a reasonable
# attempt at ensuring that all neighbours receive this retraction." [3.7.2], and "repeat the
# update some reasonable number of times (say, 3 for wireless and 2 for wired links)"
def test_3_7_2_retractions_are_told_at_once_and_twice():
    bench = routed(0)
    bench.timer(SOON)
    bench.update(0, 5, INFINITY)
    copies = 0
    while SOON in bench.timers:
        assert bench.timers[SOON] - bench.now == bench.params.urgent_us
        told = updates(bench.timer(SOON, bench.params.urgent_us))
        assert {metric for _seq, metric in told.values()} == {INFINITY}
        copies += 1
    assert copies == 2


# "A node SHOULD NOT send triggered updates for other reasons, such as [...] to propagate a new
# sequence number (except to satisfy a request" [3.7.2]
def test_3_7_2_no_news_of_a_number():
    bench = routed(0)
    bench.timer(SOON)
    bench.update(0, 6, C)
    assert SOON not in bench.timers
    bench.update(0, 6, 2 * C)  # a significant change
    assert SOON in bench.timers


# "if seqno > seqno', then seqno' := seqno, metric' := metric; if seqno = seqno' and metric' >
# metric, then metric' := metric" and "the feasibility distance is not updated [...] when a
# retraction (an update with infinite metric) is sent." [3.7.3]
def test_3_7_3_the_feasibility_distance_is_the_best_ever_advertised():
    bench = routed(0, metric=3 * C)
    assert bench.fd is None
    bench.advertise()
    assert bench.fd == (5, 4 * C)
    bench.update(0, 5, C)
    assert bench.fd == (5, 4 * C)  # not yet said
    bench.advertise()
    assert bench.fd == (5, 2 * C)
    bench.update(0, 6, 8 * C)
    bench.advertise()
    assert bench.fd == (6, 9 * C)
    at = bench.node.fd_at
    bench.update(0, 6, INFINITY)
    bench.timer(SOON, 1)
    assert (bench.fd, bench.node.fd_at) == ((6, 9 * C), at)


# "When the garbage-collection timer expires, the entry is removed from the source table." [3.7.3]
def test_3_7_3_it_is_forgotten_in_the_end():
    bench = routed(0)
    bench.advertise()
    bench.update(0, 5, INFINITY)
    bench.timer(LOOK, bench.params.gc_us)
    assert bench.fd is None


# "a routing update for prefix P is not sent on the particular interface over which the selected
# route towards prefix P was learnt." [3.7.4]
def test_3_7_4_split_horizon():
    bench = routed(2)
    assert set(updates(bench.timer(SOON))) == {0, 1, 3}
    assert set(updates(bench.advertise())) == {0, 1, 3}


# 3.8: requests.


# "If such a route exists, it MUST send an update [...]; if such a route does not exist, it MUST
# send a retraction for that prefix." [3.8.1.1]
def test_3_8_1_1_a_route_request_is_always_answered():
    bench = Bench().up(0, 1)
    assert updates(bench.comes(1, 3)) == {1: (0, INFINITY)}
    bench.update(0, 5, C)
    assert updates(bench.comes(1, 3)) == {1: (5, 2 * C)}


# "If the router-id is its own, then it increases its sequence number by 1 (modulo 2^16) and sends
# an update. A node MUST NOT increase its sequence number by more than 1 in reaction to a single
# seqno request." [3.8.1.2], "A node SHOULD NOT increment its sequence number (seqno)
# spontaneously" [3.2.2]
def test_3_8_1_2_the_source_counts_up_by_one():
    pc = Bench(number=0).up(0, 1)
    pc.node.seqno = 65535
    assert updates(pc.request(0, 7)) == {0: (0, 0)}
    assert set(updates(pc.timer(SOON))) == {0, 1, 2, 3}
    assert updates(pc.request(1, 0)) == {1: (0, 0)}
    for _ in range(50):
        pc.tick()
    assert pc.node.seqno == 0


# "the entry's sequence number is no smaller (modulo 2^16) than the requested sequence number, the
# node MUST send an update for the given prefix." [3.8.1.2]
def test_3_8_1_2_who_can_answer_does():
    bench = routed(0).up(1)
    sent = bench.request(1, 5)
    assert (updates(sent), requests(sent)) == ({1: (5, 2 * C)}, {})


# "the node MUST forward the request to the next hop of one such route", "the node decrements the
# hop count", "A single request MUST NOT be duplicated" [3.8.1.2]
def test_3_8_1_2_a_request_goes_on_toward_the_source():
    bench = routed(0).up(1)
    assert requests(bench.request(1, 6)) == {0: (6, 63)}


# "a next hop that is not the requesting node", "otherwise, if the node has one or more (not
# feasible) routes [...] the node SHOULD forward the request to the next hop of one such route"
# [3.8.1.2]
def test_3_8_1_2_never_back_and_rather_over_what_is_not_feasible():
    bench = routed(0)
    bench.advertise()
    assert requests(bench.request(0, 6)) == {}
    bench.node.wanted = 0
    bench.up(1)
    bench.update(1, 5, 9 * C)
    assert requests(bench.request(0, 6)) == {1: (6, 63)}


# "If the hop count is 2 or more", "avoid forwarding it if it is redundant (i.e., if it has
# recently sent a request with the same prefix, router-id and a seqno that is not smaller modulo
# 2^16)" [3.8.1.2]
def test_3_8_1_2_hop_count_and_duplicates():
    bench = routed(0).up(1, 2)
    assert requests(bench.request(1, 6, hops=1)) == {}
    assert requests(bench.request(1, 6, hops=2)) == {0: (6, 1)}
    assert requests(bench.request(2, 6)) == {}
    assert requests(bench.request(2, 7)) == {0: (7, 63)}


# "forward the reply (an update with a seqno sufficiently large to satisfy the request) as an
# urgent TLV" [3.8.1.2]
def test_3_8_1_2_the_reply_is_urgent():
    bench = routed(0).up(1)
    bench.timer(SOON)
    bench.request(1, 6)
    bench.update(0, 6, C)
    assert SOON in bench.timers
    assert bench.node.wanted == 0


# "A node that has lost all feasible routes to a given destination but still has unexpired
# unfeasible routes to that destination MUST send a seqno request", "the requested seqno is the
# value contained in the source table plus 1", "(64 is a suitable default value)", "to
# unconditionally multicast the request over all interfaces" [3.8.2.1]
def test_3_8_2_1_starvation():
    bench = routed(0)
    bench.up(1)
    bench.advertise()
    bench.update(1, 5, 4 * C)
    assert requests(bench.update(0, 5, INFINITY)) == dict.fromkeys(range(4), (6, 64))


# "a node SHOULD repeat such a request a small number of times if no route becomes feasible within
# a short time" [3.8.2.1], "doubled every time a request is resent, up to a maximum of three
# times" [B]
def test_3_8_2_1_requests_are_repeated():
    bench = routed(0)
    bench.advertise()
    bench.update(0, 5, INFINITY)
    at, waits = bench.now, []
    while bench.node.wanted:
        sent = bench.timer(LOOK, bench.node.wanted_at - bench.now)
        if requests(sent):
            waits.append(bench.now - at)
            at = bench.now
    first = bench.params.request_us
    assert waits == [first, 2 * first, 4 * first]


# "a node SHOULD send a unicast seqno request when it receives an unfeasible update for a route
# that is currently selected." and "from a currently unselected neighbour that is preferable to
# the currently selected route" [3.8.2.2]
def test_3_8_2_2_unfeasible_updates():
    bench = routed(0, metric=3 * C).up(1)
    bench.advertise()
    assert requests(bench.update(0, 5, 4 * C)) == {0: (6, 64)}
    other = routed(0).up(1)
    other.advertise()
    other.update(0, 6, 9 * C)  # newer, and farther
    assert requests(other.update(1, 4, C)) == {1: (6, 64)}


# "shortly before a selected route expires, a Babel node SHOULD send a unicast route request to
# the neighbour that advertised this route" [3.8.2.3]
def test_3_8_2_3_before_a_route_expires():
    bench = routed(0, up_least=1, up_of=16)
    asked = []
    for _ in range(13):
        bench.now += HELLO_US
        bench.hello(0)
        if asked_for_routes(bench.timer(LOOK)):
            asked.append(bench.now)
    assert asked == [3 * UPDATE_US]  # half an interval before 3.5
    assert bench.node.parent == 0


# Appendix A: what Hellos say of a link.


# "adds (nr - ne) 0 bits to the Hello history (we "fast-forward")", "removes the last (ne - nr)
# entries from this neighbour's Hello history (we "undo history")" [A.1]
def test_a_1_history():
    bench = Bench().up(0)
    assert bench.node.history[0] == 0b111
    bench.hello(0, skip=2)
    assert bench.node.history[0] == 0b111001
    bench.hello(0, skip=-3)
    assert bench.node.history[0] == 0b1111
    assert bench.node.hello_next[0] == 5


def test_a_1_sixteen_hellos_that_are_missed_leave_none_of_those_before():
    bench = Bench().up(0)
    bench.hello(0, skip=15)
    assert bench.node.history[0] == 0b111 << 16 & 0xFFFF | 1
    bench.hello(0, skip=16)
    assert (bench.node.history[0], bench.node.neighbour[0]) == (1, 10)
    bench.hello(0)
    assert bench.node.history[0] == 0b11


@pytest.mark.parametrize("ahead", range(-18, 19))
def test_a_1_history_bit_by_bit(ahead):
    """As text, newest last; beyond 16 either way it begins anew."""
    bench = Bench().up(0)
    for _ in range(15):
        bench.hello(0)
    bench.hello(0, skip=1)
    heard = "1" * 14 + "01"
    bench.hello(0, skip=ahead)
    kept = heard[:ahead] if ahead < 0 else heard + "0" * ahead
    wanted = "1" if abs(ahead) > 16 else kept + "1"
    assert f"{bench.node.history[0]:016b}" == wanted[-16:].rjust(16, "0")


# "if the two differ by more than 16 (modulo 2^16), then the sending node has probably rebooted
# [...]; the whole associated neighbour table entry is flushed and a new one is created" [A.1]
def test_a_1_a_neighbour_that_rebooted():
    bench = routed(0)
    bench.hello(0, skip=17)
    assert (bench.node.history[0], bench.node.known[0], bench.node.parent) == (1, 0, NONE)


# "it resets the neighbour's hello timer to 1.5 times the advertised Interval", "adds a 0 bit to
# the corresponding Hello history, and increments the expected Hello number", "(they contain 0
# bits only), the neighbour entry is flushed" [A.1]
def test_a_1_missing_hellos():
    bench = Bench().up(0)
    assert bench.node.hello_at[0] - bench.now == HELLO_US * 3 // 2
    bench.timer(LOOK, HELLO_US * 3 // 2)
    assert (bench.node.history[0], bench.node.hello_next[0]) == (0b1110, 5)
    for _ in range(15):
        assert bench.node.neighbour[0] == 10
        bench.timer(LOOK, HELLO_US)
    assert bench.node.neighbour[0] == NONE


# "if k or more of those have been correctly received, the link is assumed to be up, and the
# rxcost is set to C; otherwise [...] the rxcost is set to infinity." "cost = FFFF hexadecimal if
# rxcost = FFFF hexadecimal; cost = txcost otherwise." [A.2.1]
def test_a_2_1_k_out_of_j():
    bench = Bench()
    bench.hello(0, rxcost=7)
    assert bench.node.cost[0] == INFINITY
    bench.hello(0, rxcost=7)
    assert (rxcost_of(bench.node, bench.params, 0), bench.node.cost[0]) == (C, 7)
    bench.hello(0, skip=1, rxcost=7)
    assert bench.node.cost[0] == 7  # 2 of 3
    bench.hello(0, skip=2, rxcost=7)
    assert bench.node.cost[0] == INFINITY


# "Let rxcost be 256 / beta." "cost = (MAX(txcost, 256) * rxcost) / 256" [A.2.2]
def test_a_2_2_etx():
    bench = Bench(etx=1, up_of=6, up_least=1)
    for _ in range(6):
        bench.hello(0, rxcost=256)
    assert (rxcost_of(bench.node, bench.params, 0), bench.node.cost[0]) == (256, 256)
    bench.hello(0, skip=1, rxcost=512)
    assert (rxcost_of(bench.node, bench.params, 0), bench.node.cost[0]) == (307, 614)
    bench.hello(0, rxcost=1)
    assert bench.node.cost[0] == 307


# "Multicast Hello Interval: 4 seconds", "Update Interval: 4 times the Multicast Hello interval",
# "Request timeout: initially 2 seconds", "Urgent timeout: 0.2 seconds", "Source GC time: 3
# minutes", "2-out-of-3 with C=96 on wired links" [B]
def test_b_times_are_those_of_appendix_b_in_proportion():
    of = fields.DEFAULTS
    seconds = {name: of[name] * 4 / of["hello_us"] for name in of if name.endswith("_us")}
    assert seconds == {"hello_us": 4, "urgent_us": 0.2, "request_us": 2, "gc_us": 180}
    assert (of["update_hellos"], of["up_least"], of["up_of"], of["nominal"]) == (4, 2, 3, 96)


# "an outage or a mobility event is detected within 1.5 to 3.5 Hello intervals" [B]
def test_b_an_outage_is_detected():
    cut = {"at_s": 0.2003, "action": "cut", "link": "n0-n1"}
    tables = {"kind": "babel", "nodes": 3, "shape": "line", "duration_s": 0.3, "event": [cut]}
    for seed in range(5):
        rows = innervate.run(tables, plain=True, seed=1 + seed).result.rows["rows"]
        down = rows["time"][(rows["code"] == 3) & (rows["b"] == 0)] - 200_300
        assert len(down) == 2
        assert all(1.5 * HELLO_US <= time <= 3.5 * HELLO_US + 100 for time in down)


# A feasibility distance that was forgotten decides nothing any more, whatever it was [3.7.3].
@pytest.mark.parametrize(("known", "before", "after"), [
    (0, (9, 1), (5, 2 * C)), (1, (4, 1), (5, 2 * C)), (1, (5, 1), (5, 1)),
    (1, (5, 999), (5, 2 * C)), (1, (6, 1), (6, 1)),
])  # fmt: skip
def test_3_7_3_what_is_told_becomes_part_of_the_feasibility_distance(known, before, after):
    bench = routed(0)
    bench.node.fd_known = known
    bench.node.fd_seq, bench.node.fd_metric = before
    bench.advertise()
    assert bench.fd == after


@pytest.mark.slow
def test_all_stays_in_range_whatever_comes_in_and_every_branch_is_taken():
    babel = networks()["babel"]
    (theory,) = babel.prove.theories(babel)
    came = prove(theory)
    assert [(one.name, bad.goal) for one in came.checked for bad in one.refuted] == []
    assert came.is_as_expected


def test_a_node_has_an_entry_for_each_of_its_ports():
    assert {length for _, length, *_ in fields.STATE if length} == {PORTS}
