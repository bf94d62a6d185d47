"""Random networks under random histories: no interleaving closes a loop or disorders distances."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.networks.skin.checks import UPDATES, WITH_DETECT, check_network, check_random_network
from tests.networks.skin.net import Broken, Net

SAFE = ("feasible", "strict")
LINE = [("pc", "n1"), ("n1", "n2"), ("n2", "n3"), ("pc", "n3")]
TRIANGLE = [("pc", "n1"), ("n1", "n2"), ("n2", "n3"), ("n3", "n1")]
SQUARE = [("pc", "n1"), ("n1", "n2"), ("n2", "n4"), ("n4", "n3"), ("n3", "n1")]
GRID = [("pc", "a"), ("a", "b"), ("b", "c"), ("d", "e"), ("e", "f"), ("a", "d"), ("b", "e"),
        ("c", "f"), ("f", "pc")]  # fmt: skip
HISTORY = st.lists(st.tuples(st.sampled_from(WITH_DETECT), st.integers(0, 63)), max_size=150)


@given(
    st.sampled_from([LINE, TRIANGLE, SQUARE, GRID]),
    HISTORY,
    st.sampled_from(SAFE),
    st.sampled_from(UPDATES),
    st.integers(1, 3),
    st.integers(1, 3),
)
@settings(max_examples=100, deadline=None)
def test_no_history_breaks_an_invariant(links, history, rule, updates, k, m):
    check_network(links, history, rule=rule, updates=updates, k=k, m=m)


@pytest.mark.parametrize("updates", UPDATES)
@pytest.mark.parametrize("rule", SAFE)
def test_random_networks_keep_the_invariants(rule, updates):
    for seed in range(4):
        check_random_network(seed, rule=rule, updates=updates, steps=WITH_DETECT)


@pytest.mark.slow
@pytest.mark.parametrize("updates", UPDATES)
@pytest.mark.parametrize("rule", SAFE)
def test_many_random_networks_keep_the_invariants(rule, updates):
    for seed in range(400):
        check_random_network(
            seed, rule=rule, updates=updates, steps=WITH_DETECT, cells=3 + seed % 8, count=600
        )


def test_the_paper_rule_closes_loops_in_such_histories():
    for updates in UPDATES:
        assert any(
            check_random_network(seed, rule="paper", updates=updates, steps=WITH_DETECT).rings
            for seed in range(40)
        ), updates


def test_the_checker_sees_a_ring():
    net = Net(TRIANGLE)
    for name, there in (("n1", "n2"), ("n2", "n3"), ("n3", "n1")):
        net.cells[net.node(name)].parent = net.graph.port_of(net.end(name, there))
    assert sorted(net.ring()) == ["n1", "n2", "n3"]
    with pytest.raises(Broken, match="closed loop"):
        net.check()
    net.cut(net.end("n2", "n3"))
    assert net.ring() == []


def test_the_checker_sees_a_disorder_and_a_value_out_of_range():
    net = Net(LINE)
    for _ in range(12):
        net.period()
    net.check()
    cell = net.cells[net.node("n2")]
    cell.fd_dist = 1
    with pytest.raises(Broken, match=r"n2 .* is not worse than"):
        net.check()
    net = Net(LINE)
    net.cells[1].pf[2] = 1681
    with pytest.raises(Broken, match="n2: pf"):
        net.check()


def test_the_checker_sees_a_distance_that_gets_worse():
    net = Net(LINE)
    for _ in range(12):
        net.period()
    net.check()
    net.cells[0].fd_sq -= 1
    with pytest.raises(Broken, match="got worse"):
        net.check()
