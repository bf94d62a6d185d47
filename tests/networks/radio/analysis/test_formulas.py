"""Closed forms of the radio: known values, limits, and sums worked out the long way."""

from math import comb, e, exp, factorial, isclose, log

import pytest

from innervate.networks.radio.analysis import formulas as forms
from tests.networks.radio import forms as infinite


def test_reserved_round_of_five():
    # Collision 6, report and window 6, five packets of 6.
    assert forms.reserved_round_slots(5, 5) == 42
    assert forms.reserved_round_slots(5, 5, "B") == 39
    assert forms.reserved_duration_slots(5, 5) == 41
    assert forms.reserved_duration_slots(5, 5, "B") == 39


@pytest.mark.parametrize("packet_slots", [5, 25])
def test_reading_b_differs_by_three_slots_per_cycle(packet_slots):
    for n in range(2, 101):
        a, b = (forms.reserved_round_slots(n, packet_slots, reading) for reading in "AB")
        assert a - b == 3


def test_one_station_has_no_round():
    assert forms.reserved_throughput(1, 5) == 5 / 6
    assert forms.reserved_duration_slots(1, 5) == 5


def test_a_shorter_window():
    assert isclose(forms.reserved_throughput(2, 25, window=2), 50 / 81)


def test_bounds():
    assert [round(forms.slotted_bound(t), 4) for t in (5, 25)] == [0.8333, 0.9615]
    assert [round(forms.handover_bound(t), 3) for t in (5, 25)] == [0.909, 0.980]
    turned = [forms.handover_bound(t, 2000 / 208, 78 / 208) for t in (5, 25)]
    assert [round(s, 4) for s in turned] == [0.3335, 0.7145]


def test_resolved_run_is_figure_1():
    assert forms.resolved_duration_us(6448, 4, 5200, 104, 208, 208) == 32968


@pytest.mark.parametrize("linear", [False, True])
def test_pair_duration_the_long_way(linear):
    def after(k):
        """From the end of the k-th collision of two stations, T = 5, cost 6."""
        if k > 12:
            return 0.0
        values = k + 1 if linear else 2 ** min(k, 10)
        if values > 512:
            return 0.0
        total = 0.0
        for one in range(values):
            for two in range(values):
                first, second = min(one, two), max(one, two)
                if first == second:
                    total += first + 6 + rest[k + 1]
                else:
                    total += max(first + 6, second) + 5
        return total / values**2

    rest = {}
    for k in range(14, 0, -1):
        rest[k] = after(k)
    assert isclose(forms.pair_duration_slots(5, 6, linear), 6 + rest[1], rel_tol=1e-6)


def test_aloha():
    assert infinite.aloha_throughput(1) == pytest.approx(1 / e)
    assert forms.finite_aloha_throughput(1000, 1 / 1000) == pytest.approx(1 / e, rel=1e-3)
    assert forms.finite_csma_throughput(1, 5, 1.0) == 5 / 6


def test_nonpersistent_reaches_aloha_where_packets_are_slots():
    # a = 1: a collision is noticed only after it is over, at twice the cost of ALOHA's slot.
    assert infinite.nonpersistent_throughput(1, 1) == pytest.approx(exp(-1) / (2 - exp(-1)))


def test_p_persistent_of_probability_one():
    # Kleinrock and Tobagi 1975: slotted 1-persistent CSMA in closed form; its capacity is 0.531.
    def exact(load, a):
        g, b = exp(-a * load), exp(-(1 + a) * load)
        return load * b * (1 + a - g) / ((1 + a) * (1 - g) + a * b)

    for load in (0.2, 1, 3):
        assert infinite.p_persistent_throughput(load, 100, 1.0) == pytest.approx(exact(load, 0.01))
    capacity = max(infinite.p_persistent_throughput(g / 50, 100, 1.0) for g in range(30, 70))
    assert round(capacity, 3) == 0.531


def test_p_persistent_waits_are_those_of_the_paper():
    # P{t_n > k} = (1-p)^((k+1)n) exp(g (q (1 - q^k) / p - k)), summed here over all k.
    g, p = 0.3, 0.2
    joining = [exp(-g) * g**k / factorial(k) for k in range(60)]
    waits, hits = infinite._waits(joining, p, 59)
    q = 1 - p
    for n in (1, 2, 5):
        tail = [q ** ((k + 1) * n) * exp(g * (q * (1 - q**k) / p - k)) for k in range(200)]
        assert waits[n] == pytest.approx(sum(tail))
        assert 0 < hits[n] <= 1


def test_dcf_one_station_never_collides():
    tau, collide = forms.dcf_attempt(1, 32, 5)
    assert (tau, collide) == (pytest.approx(2 / 33), 0)


def test_dcf_solves_bianchis_equations():
    for n, window, stages in ((2, 16, 6), (10, 32, 3), (50, 128, 3)):
        tau, p = forms.dcf_attempt(n, window, stages)
        assert p == pytest.approx(1 - (1 - tau) ** (n - 1))
        doubled = (1 - 2 * p) * (window + 1) + p * window * (1 - (2 * p) ** stages)
        assert tau == pytest.approx(2 * (1 - 2 * p) / doubled)


def test_dcf_at_its_best_reaches_bianchis_maximum():
    # Eqs. 27-29: with tau at its optimum the throughput is 0.823 (basic) whatever n is.
    k = (8713 / 50 / 2) ** 0.5
    best = 8184 / (8982 + 50 * k + 8713 * (k * (exp(1 / k) - 1) - 1))
    found = max(
        forms.dcf_throughput(50, w, 0, payload=8184 / 50, success=8982 / 50, collision=8713 / 50)
        for w in range(600, 1400, 10)
    )
    assert found == pytest.approx(best, rel=5e-3)


def test_tree_by_hand():
    assert [forms.tree_slots(n) for n in (0, 1, 2)] == [1, 1, 5]
    assert forms.tree_slots(3) == pytest.approx(23 / 3)
    n = 9
    parts = [comb(n, i) / 2**n for i in range(n + 1)]
    whole = sum(s * (forms.tree_slots(i) + forms.tree_slots(n - i)) for i, s in enumerate(parts))
    assert forms.tree_slots(n) == pytest.approx(1 + whole)


def test_tree_needs_2_885_slots_per_station():
    assert round(infinite.TREE_SLOTS_PER_STATION, 3) == 2.885
    assert isclose(infinite.TREE_SLOTS_PER_STATION, 2 / log(2))
    slope = (forms.tree_slots(200) - forms.tree_slots(100)) / 100
    assert slope == pytest.approx(infinite.TREE_SLOTS_PER_STATION, abs=2e-3)
    assert forms.tree_throughput(1) == 1
