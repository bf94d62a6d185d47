"""What RFC 8966 says, sentence by sentence, of links and routes."""

import pytest

import innervate
from innervate.networks.babel.protocol.common import is_feasible
from innervate.networks.babel.protocol.constants import INFINITY, LOOK, NONE
from tests.networks.babel.bench import HELLO_US, UPDATE_US, Bench, C, routed

# 2 and 3.5: why there are no loops.


# "Since D(C) = 1 < FD(A), the alternate route through C is feasible for A, although its metric
# C(A, C) + D(C) = 5 is larger than that of the currently selected route" [2.4]
def test_2_4_a_route_is_feasible_though_its_metric_is_larger_than_ours():
    a = routed(0, metric=1, nominal=1)
    a.advertise()
    for _ in range(3):
        a.hello(1, rxcost=4)
    a.update(1, 5, 1)
    assert (a.fd, a.metric(0), a.metric(1)) == ((5, 2), 2, 5)
    assert is_feasible(a.node, 5, 1)
    a.update(0, 5, INFINITY)
    assert a.node.parent == 1


# "After S increases its sequence number, and the new sequence number is propagated to B [...] the
# route through B becomes feasible again." [2.5]
def test_2_5_starvation_is_solved_by_the_source():
    cables = ["n0-n1", "n0-n2", "n2-n3", "n1-n3"]  # S is n0, A n1, B n3, one hop farther
    cut = {"at_s": 0.2, "action": "cut", "link": "n0-n1"}
    tables = {"kind": "babel", "cables": cables, "duration_s": 0.4, "event": [cut]}
    nodes = innervate.run(tables, plain=True).result.world.cells
    assert [node.parent >= 0 for node in nodes] == [False, True, True, True]
    assert nodes[0].seqno == 1
    assert [(node.fd_seq, node.fd_metric) for node in nodes[1:]] == [(1, 3 * C), (1, C), (1, 2 * C)]


# "feasible if one of the following conditions holds: metric is infinite; or no entry exists in
# the source table [...]; or [...] seqno' < seqno or seqno = seqno' and metric < metric'." [3.5.1]
@pytest.mark.parametrize(
    ("seq", "metric", "feasible"),
    [(5, 2 * C - 1, 1), (5, 2 * C, 0), (6, 9 * C, 1), (4, 1, 0), (5 + 32768, 1, 0),
     (4, INFINITY, 1)],
)  # fmt: skip
def test_3_5_1_the_feasibility_condition(seq, metric, feasible):
    bench = routed(0)
    assert is_feasible(bench.node, seq, metric)  # nothing was advertised yet
    bench.advertise()
    assert bench.fd == (5, 2 * C)
    assert bool(is_feasible(bench.node, seq, metric)) == bool(feasible)


# "a fluctuation in a neighbour's cost cannot render a selected route unfeasible" [3.5.1]
def test_3_5_1_a_neighbours_cost_does_not_matter():
    bench = routed(0, etx=1, up_of=6)
    bench.advertise()
    before = bench.metric(0)
    for _ in range(2):
        bench.hello(0, skip=1, rxcost=1024)
    assert bench.metric(0) > before
    assert bench.node.parent == 0


# "if c is infinite, then M(c, m) is infinite; M is strictly monotonic: M(c, m) > m." [3.5.2]
def test_3_5_2_metrics_are_added():
    bench = routed(0, metric=3 * C)
    assert bench.metric(0) == 4 * C
    bench.hello(0, rxcost=INFINITY)
    assert bench.metric(0) is None
    top = routed(0, metric=INFINITY - 1)
    assert top.metric(0) is None


# "if the metric is infinite (the update is a retraction of a route we do not know about), the
# update is ignored" [3.5.3]
def test_3_5_3_an_unknown_route_is_not_retracted():
    bench = Bench().up(0)
    assert bench.update(0, 5, INFINITY) == []
    assert bench.node.known == [0, 0, 0, 0]


# "if the entry is currently selected, the update is unfeasible, and the router-id of the update
# is equal to the router-id of the entry, then the update MAY be ignored" [3.5.3]
def test_3_5_3_an_unfeasible_update_of_the_selected_route():
    bench = routed(0)
    bench.advertise()
    bench.update(0, 5, 7 * C)
    assert (bench.node.parent, bench.metric(0)) == (0, 2 * C)


# "If the metric is finite, it is set to infinity and the expiry timer is reset. If the metric is
# already infinite, the route is flushed from the route table." [3.5.3]
def test_3_5_3_routes_expire_in_two_steps():
    bench = routed(0, gc_us=10_000_000)
    bench.node.route_us[0] = UPDATE_US
    hold = UPDATE_US * 7 // 2  # "Route Expiry Time: 3.5 times the advertised update interval" [B]
    assert bench.node.route_at[0] == hold
    for _ in range(hold // HELLO_US):
        bench.now += HELLO_US
        bench.hello(0)
        bench.timer(LOOK)
    assert (bench.node.metric[0], bench.node.known[0]) == (INFINITY, 1)
    assert bench.node.parent == NONE
    for _ in range(hold // HELLO_US + 1):
        bench.now += HELLO_US
        bench.hello(0)
        bench.timer(LOOK)
    assert bench.node.known[0] == 0


# 3.2 and 3.4: who is there.


# "Each Hello TLV carries an increasing (modulo 2^16) sequence number and an upper bound on the
# time interval until the next Hello" [3.4.1]
def test_3_4_1_hellos_are_numbered_and_promise_the_next():
    bench = Bench()
    bench.node.hello_no = 65534
    told = [{(f.hello_no, f.hello) for _, f in bench.tick()} for _ in range(3)]
    assert told == [{(number, HELLO_US // 100)} for number in (65535, 0, 1)]


# "When a neighbour's IHU timer expires, the neighbour's txcost is set to infinity." [3.4.2]
def test_3_4_2_an_ihu_says_our_rxcost_and_runs_out():
    bench = routed(0)
    assert [f.rxcost for port, f in bench.tick()] == [C, INFINITY, INFINITY, INFINITY]
    # "the advertised IHU interval is always 3 times the Multicast Hello interval" and
    # "IHU Hold Time: 3.5 times the advertised IHU interval" [B]
    heard = bench.now
    bench.hello(0)
    assert bench.node.ihu_at[0] - heard == 3.5 * 3 * HELLO_US
    bench.node.hello_at[0] += 100 * HELLO_US  # its Hellos come, without an IHU
    bench.timer(LOOK, bench.node.ihu_at[0] - bench.now)
    assert (bench.node.txcost[0], bench.node.cost[0], bench.node.parent) == (
        INFINITY, INFINITY, NONE,
    )  # fmt: skip


# "the cost is strictly positive; if no Hello TLVs of either kind were received recently, then the
# cost is infinite; if the txcost is infinite, then the cost is infinite." [3.4.3]
def test_3_4_3_costs():
    bench = Bench()
    assert bench.node.cost == [INFINITY] * 4
    bench.up(0, 1)
    bench.hello(1, rxcost=INFINITY)
    assert bench.node.cost == [C, INFINITY, INFINITY, INFINITY]


# 3.6: the choice.


# "a route with infinite metric (a retracted route) is never selected; an unfeasible route is
# never selected." [3.6]
def test_3_6_what_is_never_selected():
    bench = routed(0)
    bench.up(1)
    bench.advertise()
    bench.update(1, 5, 4 * C)
    bench.update(0, 5, INFINITY)
    assert bench.metric(1) == 5 * C
    assert bench.node.parent == NONE


# "a route MUST NOT be preferred just because it carries a higher (more recent) seqno" [3.6]
def test_3_6_the_least_metric_and_no_newer_seqno():
    bench = routed(0).up(1)
    bench.update(1, 6, 2 * C)
    assert bench.node.parent == 0
    bench.update(1, 6, C - 1)
    assert bench.node.parent == 1


# "a route selection strategy SHOULD include some form of hysteresis" [3.6]
def test_3_6_hysteresis():
    bench = routed(0, margin=10).up(1)
    bench.update(1, 5, C - 10)
    assert bench.node.parent == 0
    bench.update(1, 5, C - 11)
    assert bench.node.parent == 1
