"""The slotted level compiled and plain: the same rows, whatever the protocol and the traffic."""

import warnings
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.kernel import compilation
from innervate.networks.radio.slotted import draws as draws
from innervate.networks.radio.slotted.drive import BY_CHANCE, MACS, loop
from innervate.networks.radio.slotted.model import slotted
from tests.networks.radio.forms import BIANCHI_BASIC

OPTIONS = {
    "csma-cd-r": [{}, {"reading": "B"}, {"window": 2}, {"turnaround_slots": 2000 / 208}],
    "csma-cd-d1": [{}, {"backoff": "linear"}],
    "csma-cd-d2": [{}, {"turnaround_slots": 2000 / 208, "backoff_slots": 11}],
    "csma-cd-d2p": [{}, {"turnaround_slots": 2000 / 208, "return_slots": 0}],
    "dcf": [{}, {"dcf": BIANCHI_BASIC}],
    "p-persistent": [{}, {"p": 0.03}],
}
CASES = [(mac, options) for mac in sorted(MACS) for options in OPTIONS.get(mac, [{}])]
TRAFFIC = [("saturated", None), ("disaster", None), ("poisson", 0.4)]


def same(one, two):
    assert np.array_equal(one.delay_slots, two.delay_slots)
    assert one.order == two.order
    for name in ("elapsed_slots", "throughput", "duration_slots", "successes", "collisions"):
        assert getattr(one, name) == getattr(two, name), name


def both(*arguments, **named):
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # an overflow of plain integers is a warning
        plain = slotted(*arguments, plain=True, **named)
    compiled = slotted(*arguments, **named)
    same(plain, compiled)
    return compiled


@pytest.mark.parametrize(("traffic", "load"), TRAFFIC)
@pytest.mark.parametrize(("mac", "options"), CASES)
def test_finite_populations(mac, options, traffic, load):
    result = both(mac, 6, 5, traffic, packets=8, seed=3, load=load, **options)
    assert result.order


@pytest.mark.parametrize("mac", sorted(BY_CHANCE))
def test_infinite_populations(mac):
    both(mac, 0, 5, "poisson", packets=100, load=1.5)


@cache
def compiled():
    return loop(draws.exponential, plain=False), compilation.compiled(draws.draw)


@settings(deadline=None)  # the first call loads compiled code
@given(st.integers(0, 2**40), st.integers(1, draws.UNIT), st.integers(1, draws.MEAN_MAX))
def test_draws(seed, n, mean):
    exponential, draw = compiled()
    one, two = draws.generator(seed, "a"), draws.generator(seed, "a")
    assert draws.exponential(one, mean) == exponential(two, mean)
    assert 0 <= draws.draw(one, n) == draw(two, n) < n
    assert one.tolist() == two.tolist()
