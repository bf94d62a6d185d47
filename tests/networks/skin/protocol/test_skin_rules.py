"""The skin paper's algorithms, penalty and balancing on a single cell; quoted as printed."""

from fractions import Fraction

import pytest

from innervate.networks.skin.protocol.constants import (
    NONE,
    ONE,
    REPORT_BALANCE,
    REPORT_BROKEN,
    REPORT_PARENT,
)
from tests.networks.skin.bench import REAL, OneCell, params_of

W, E, UP, DOWN = range(4)
RULES = ("feasible", "strict", "paper", "paper-lax")


def cell_with(*neighbours, **keys):
    """A cell that has heard (port, dist, sq) of its neighbours and has ticked."""
    bench = OneCell(**keys)
    for port, dist, sq in neighbours:
        bench.hear(port, dist=dist, sq=sq)
    bench.tick()
    return bench


# [skin II-B.1] "every skin cell received one packet at every p_a, setting the port with the lowest
# distance min(H(P_a)) to its master port", "it forwards a distance H(m_p) + 1"
def test_the_nearest_port_becomes_the_parent_and_its_distance_plus_one_is_sent():
    bench = cell_with((W, 4, 9), (E, 2, 9), (UP, 3, 9))
    assert bench.parent == E
    sent = bench.sent(bench.period())
    assert {frame.dist for frame in sent.values()} == {3}


# [skin II-B.1] "If the skin cell itself and all its neighbors still have a distance of infinity,
# it can not distinguish a master port and therefore continuous forwarding infinity"
def test_without_a_route_infinity_goes_to_everyone():
    bench = cell_with((W, 255, 0), (E, 255, 0))
    sent = bench.sent(bench.period())
    assert sorted(sent) == [W, E, UP, DOWN]
    assert {frame.dist for frame in sent.values()} == {255}


# E1 Alg. 1 l. 20 "Sq(b) <- S(p_m)": Sq(p_m) is meant
def test_e1_the_parents_number_is_announced_not_its_size():
    bench = OneCell()
    bench.hear(W, dist=1, sq=77, size=40)
    frame = bench.sent(bench.tick())[E]
    assert (frame.sq, frame.size) == (77, 40)


# E3 "beacon carries 1 bit per port, 'you are my master'"
def test_e3_only_the_parent_is_told_so():
    bench = cell_with((W, 1, 1))
    sent = bench.sent(bench.period())
    assert [sent[port].parent for port in range(4)] == [1, 0, 0, 0]


# E2, E3 Alg. 1 l. 12 "P_b <- P_a/P_s": no child becomes the parent, however near it says it is
def test_e2_children_and_broken_ports_are_no_candidates():
    bench = OneCell(k=2)
    bench.hear(W, dist=3, sq=5)
    bench.hear(E, dist=1, sq=5, parent=1)
    bench.tick()
    assert bench.parent == W
    bench.hear(UP, dist=2, sq=6)
    bench.cell.pf[UP] = 2 * ONE
    bench.period()
    assert bench.parent == W
    bench.cell.pf[UP] = 0
    bench.period()
    assert bench.parent == UP


# E5 "p_m becomes empty when the master port is broken, says infinity, or says 'you are my master'"
@pytest.mark.parametrize("why", ["broken", "infinity", "child", "too deep"])
def test_e5_when_a_parent_is_lost(why):
    bench = cell_with((W, 1, 8), k=3)
    if why == "broken":
        for _ in range(3):
            bench.period(W)
    else:
        said = {"infinity": {"dist": 255}, "child": {"dist": 1, "parent": 1}}
        bench.hear(W, sq=8, **said.get(why, {"dist": bench.params.max_depth}))
        bench.tick()
    assert bench.parent == NONE
    # "Sq of the lost route is remembered (sq_own)"
    assert (bench.cell.sq_known, bench.cell.sq_own) == (1, 8)
    assert REAL.skin.distance(bench.cell) == 255


# [skin II-B.2] "A new port p_i can only be chosen as master port if Sq(p_i) is equal or larger
# than the sequence number of the current master port"; F1 strict: larger once the parent is lost;
# F2 feasible: (Sq, dist) strictly better than fd. E6: the test holds in both branches of Alg. 2.
@pytest.mark.parametrize(
    ("rule", "dist", "sq", "chosen"),
    [
        ("paper", 9, 20, True), ("paper", 9, 19, False), ("paper", 0, 19, False),
        ("paper-lax", 9, 20, True), ("paper-lax", 9, 19, False), ("paper-lax", 0, 19, False),
        ("strict", 9, 20, False), ("strict", 9, 21, True), ("strict", 0, 20, False),
        ("feasible", 9, 20, False), ("feasible", 9, 21, True), ("feasible", 3, 20, False),
        ("feasible", 2, 20, True), ("feasible", 0, 19, False),
    ],
)  # fmt: skip
def test_e6_which_port_may_follow_a_lost_parent(rule, dist, sq, chosen):
    bench = cell_with((W, 2, 20), rule=rule)
    assert REAL.skin.distance(bench.cell) == 3  # its fd is (20, 3)
    bench.hear(W, dist=255, sq=20)
    bench.hear(E, dist=dist, sq=sq)
    bench.tick()
    assert (bench.parent == E) == chosen


# Alg. 2 l. 6 "if Sq(p_m_new) >= Sq(p_m)"; II-B.2 "the sequence number of the current master
# port": as last heard there. The laxer reading compares with the number that the cell itself
# announced last, which is older by what came from its parent since.
@pytest.mark.parametrize(
    ("rule", "sq", "chosen"),
    [
        ("paper", 21, False), ("paper", 22, True), ("paper", 23, True),
        ("paper-lax", 19, False), ("paper-lax", 20, True), ("paper-lax", 21, True),
        ("paper-lax", 22, True),
    ],
)  # fmt: skip
def test_the_printed_rule_compares_with_the_present_parents_number(rule, sq, chosen):
    bench = cell_with((W, 3, 20), rule=rule)
    assert bench.cell.sq_own == 20
    bench.hear(W, dist=3, sq=22)
    bench.hear(E, dist=1, sq=sq)
    bench.tick()
    assert (bench.parent == E) == chosen


# The same for a port that the load would move to.
@pytest.mark.parametrize(("rule", "moves"), [("paper", False), ("paper-lax", True)])
def test_so_it_is_for_balancing(rule, moves):
    bench = OneCell(rule=rule, balancing=True, balance_periods=1)
    bench.hear(W, dist=2, sq=20, size=40)
    bench.tick()
    bench.hear(W, dist=2, sq=22, size=40)
    bench.hear(E, dist=2, sq=21, size=5)
    bench.tick()
    assert (bench.parent == E) == moves


# E7 the printed "else H(p_m) <- infinity" would lose every route without an alternative
def test_e7_the_only_parent_is_kept():
    for rule in RULES:
        bench = cell_with((W, 1, 3), (E, 5, 3), rule=rule)
        for _ in range(10):
            bench.period()
            assert bench.parent == W


# E8 "ports failing the Sq test are removed before the minimum"
def test_e8_a_stale_nearer_port_does_not_hide_a_fresh_farther_one():
    for rule in RULES:
        bench = cell_with((W, 4, 50), rule=rule)
        bench.hear(W, dist=255, sq=50)
        bench.hear(E, dist=1, sq=49)
        bench.hear(UP, dist=6, sq=51)
        bench.tick()
        assert bench.parent == UP, rule


# E9 "master stays unless an allowed port is strictly nearer; the cell's own D just grows"
def test_e9_a_parent_whose_distance_grows_is_kept():
    for rule in RULES:
        bench = cell_with((W, 2, 5), (E, 4, 5), rule=rule)
        bench.hear(W, dist=4, sq=6)
        bench.hear(E, dist=4, sq=6)
        bench.tick()
        assert (bench.parent, REAL.skin.distance(bench.cell)) == (W, 5), rule
        bench.hear(W, dist=7, sq=7)
        bench.hear(E, dist=4, sq=7)
        bench.tick()
        assert bench.parent == E, rule


# E10 "it switches in the same tick; infinity only if nothing usable is left"
def test_e10_a_cell_with_another_way_never_announces_infinity():
    bench = cell_with((W, 1, 5), (E, 3, 5), k=2)
    bench.hear(E, dist=3, sq=9)
    bench.period(W)
    actions = bench.period(W)
    assert bench.reported(actions) == [(REPORT_BROKEN, W, 1), (REPORT_PARENT, W, E)]
    assert {frame.dist for frame in bench.sent(actions).values()} == {4}


# [skin II-B.1] "chooses a random node out of P_min during initialization"
def test_the_first_parent_is_any_of_the_nearest():
    chosen = {
        cell_with((W, 2, 1), (E, 2, 1), (UP, 3, 1), (DOWN, 2, 1), seed=seed).parent
        for seed in range(1, 60)
    }
    assert chosen == {W, E, DOWN}


# [skin Alg. 3] l. 10 "S(q_i) >= S(p_m) and L < L(q_i) - L(p_m)" as printed, L of the subnetworks
# (Eq. 2); E11 "take the one q with least S, test once"
@pytest.mark.parametrize(
    ("sizes", "load", "expected"),
    [
        ((50, 52, 60), 1, E), ((50, 51, 60), 1, W), ((50, 60, 59), 9, W), ((50, 60, 61), 9, E),
        ((50, 40, 99), 1, W), ((50, 99, 98), 1, UP),
    ],
)  # fmt: skip
def test_algorithm_3_as_printed_moves_load_to_the_larger_subnetwork(sizes, load, expected):
    bench = OneCell(balancing=True, balance_periods=1, balance_rule="paper")
    bench.cell.countdown = 5
    bench.hear(DOWN, dist=9, sq=3, load=load - 1, parent=1)
    bench.hear(W, dist=2, sq=3, size=sizes[0])
    bench.tick()
    bench.hear(E, dist=2, sq=4, size=sizes[1])
    bench.hear(UP, dist=2, sq=4, size=sizes[2])
    bench.cell.countdown = 1
    bench.tick()
    assert bench.parent == expected


# [skin Alg. 3] E11 "take the one q with least S"; E12, E13 "switch iff S(p_m) - S(q) > L(i)"; the
# printed `S(q) >= S(p_m)` would move load to the larger subnetwork
@pytest.mark.parametrize(
    ("sizes", "load", "expected"),
    [
        ((50, 48, 60), 1, E), ((50, 49, 60), 1, W), ((50, 51, 99), 1, W), ((50, 40, 30), 1, UP),
        ((50, 40, 60), 9, E), ((50, 40, 60), 10, W), ((50, 10, 10), 5, E),
    ],
)  # fmt: skip
def test_e11_e12_e13_balancing_moves_load_to_the_smaller_subnetwork(sizes, load, expected):
    bench = OneCell(balancing=True, balance_periods=1)
    bench.cell.countdown = 5
    bench.hear(DOWN, dist=9, sq=3, load=load - 1, parent=1)
    bench.hear(W, dist=2, sq=3, size=sizes[0])
    bench.tick()
    assert bench.cell.own_load == load
    bench.hear(E, dist=2, sq=4, size=sizes[1])
    bench.hear(UP, dist=2, sq=4, size=sizes[2])
    bench.cell.countdown = 1
    actions = bench.tick()
    assert bench.parent == expected
    balanced = [row for row in bench.reported(actions) if row[0] == REPORT_BALANCE]
    assert balanced == ([(REPORT_BALANCE, W, expected)] if expected != W else [])
    # invariant 5 of [skin 6]: the sum of squares of the port loads shrinks
    if expected != W:
        left, right = sizes[0], sizes[expected]
        assert (left - load) ** 2 + (right + load) ** 2 < left**2 + right**2


# E14 "One attempt per cell every 8*d_max periods", and only among shortest paths [skin II-B.4]
def test_e14_balancing_waits_its_turn_and_keeps_to_shortest_paths():
    bench = OneCell(balancing=True)
    assert bench.params.balance_periods == 8 * 8
    assert 1 <= bench.cell.countdown <= 64
    bench.hear(W, dist=2, sq=3, size=90)
    bench.tick()
    bench.cell.countdown = 64
    bench.hear(E, dist=2, sq=4, size=10)
    bench.hear(UP, dist=3, sq=4, size=1)
    for _ in range(63):
        bench.period()
        assert bench.parent == W
    bench.period()
    assert bench.parent == E


# E14 leaves open what two cells do that have the same turn: whoever moved draws another one
def test_e14_a_cell_that_moved_draws_its_next_turn():
    for value in (0, 17, 63):
        bench = OneCell(balancing=True)
        bench.hear(W, dist=2, sq=3, size=90)
        bench.tick()
        bench.hear(E, dist=2, sq=4, size=10)
        bench.cell.countdown = 1
        bench.cell.choice = value
        bench.tick()
        assert bench.parent == E
        assert bench.cell.countdown == 1 + value
        bench.cell.countdown = 1
        bench.period()
        assert bench.parent == E
        assert bench.cell.countdown == 64, "nothing moved: the turn stays"


# [skin II-B.3] "whether it received the last k consecutive beacon packets at any port. If none of
# the k packets arrived on port p_i, it sets p_i as broken"
@pytest.mark.parametrize("k", [*range(1, 31), 32, 33, 34, 35, 40, 42, 60, 84])
def test_e16_a_port_is_broken_after_exactly_k_missed_beacons(k):
    bench = cell_with((W, 1, 1), k=k)
    assert bench.params.k == k
    for missed in range(1, k + 1):
        reports = bench.reported(bench.period(W))
        assert ((REPORT_BROKEN, W, 1) in reports) == (missed == k), f"after {missed} of {k}"


# E16 "broken <=> p_f >= 1, fixed point, so k = ceil(1/r_f)"
@pytest.mark.parametrize("r_f", [0.2, 0.25, 0.3, 0.34, 0.4, 0.5, 0.7, 1.0, 1.5, 0.125, 0.05])
def test_e16_k_follows_from_r_f(r_f):
    exact = Fraction(str(r_f))
    assert params_of(r_f=r_f).k == -(-1 // exact)
    bench = cell_with((W, 1, 1), r_f=r_f)
    missed = 0
    while bench.cell.pf[W] < ONE:
        bench.period(W)
        missed += 1
    assert missed == -(-1 // exact)


# E18 "once per own period: any beacon since my last tick?"
def test_e18_two_beacons_in_a_period_count_once():
    bench = cell_with((W, 1, 1), k=4)
    bench.period(W)
    bench.period(W)
    assert bench.cell.pf[W] == 2 * bench.params.r_f
    bench.hear(W, dist=1, sq=1)
    bench.period()
    assert bench.cell.pf[W] == 2 * bench.params.r_f - bench.params.r_r


# [skin II-B.3] "p_f can only have values in the range of [0, 2]"
def test_the_penalty_stays_between_0_and_2():
    bench = cell_with((W, 1, 1), r_f=0.7, r_r=0.3)
    for _ in range(9):
        bench.period(W)
    assert bench.cell.pf[W] == 2 * ONE
    for _ in range(19):
        bench.period()
    assert bench.cell.pf[W] == 0


# E19 "from the cap a port works again after floor((2-1)/r_r)+1 beacons (k+1 for r_r=1/k; 2k+1 for
# 1/(2k)). No hysteresis: just at 1.0, one beacon re-admits"
@pytest.mark.parametrize("k", [2, 3, 4, 5, 7])
@pytest.mark.parametrize("slower", [1, 2])
def test_e19_replugging(k, slower):
    r_r = Fraction(1, k * slower)
    bench = cell_with((W, 1, 1), r_f=1 / k, r_r=float(r_r))
    for _ in range(3 * k):
        bench.period(W)
    assert bench.cell.pf[W] == 2 * ONE
    needed = 0
    while bench.cell.pf[W] >= ONE:
        actions = bench.period()
        needed += 1
    assert needed == k * slower + 1
    assert (REPORT_BROKEN, W, 0) in bench.reported(actions)


def test_e19_there_is_no_hysteresis():
    bench = cell_with((W, 1, 1), k=4)
    for _ in range(4):
        bench.period(W)
    assert bench.cell.pf[W] == ONE
    bench.period()
    assert bench.cell.pf[W] < ONE
    assert bench.parent == NONE or bench.parent == W


# [skin Fig. 6] "a) r_f similar to r_r, whereby it does not detect the loose connection, since
# beacon misses are too rare. If r_f is increased and r_r is reduced, the connection is detected"
@pytest.mark.parametrize(
    ("r_f", "r_r", "misses"), [(0.2, 0.2, None), (0.4, 0.1, 4), (0.5, 0.1, 3), (0.2, 0.1, None)]
)
def test_figure_6_a_loose_connection(r_f, r_r, misses):
    bench = cell_with((W, 1, 1), r_f=r_f, r_r=r_r)
    missed = 0
    for period in range(90):
        silent = period % 3 == 0  # every third beacon is lost
        bench.period(*((W,) if silent else ()))
        missed += silent
        if bench.cell.pf[W] >= ONE:
            break
    # p_f peaks at r_f + (n-1) * (r_f - 2 r_r) with the n-th miss, if that grows
    assert (missed if bench.cell.pf[W] >= ONE else None) == misses


# E33 "255"; "usable(p) = dist<MAXD"
def test_e33_routes_deeper_than_maxd_are_refused():
    assert cell_with((W, 63, 1)).parent == W
    assert cell_with((W, 64, 1)).parent == NONE
    assert cell_with((W, 64, 1), max_depth=65).parent == W
