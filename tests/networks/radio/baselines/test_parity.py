"""The baselines, compiled and plain: the same rows, states and fingerprint."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.networks.radio.scenario.baselines import NUMBERS, Draws, baseline
from tests.networks.radio.sim.test_parity import PRACTICAL, QUIET, check, plans


@st.composite
def baseline_plans(draw):
    """The plans of CSMA/CD-R, and another protocol."""
    plan = draw(plans(PRACTICAL))
    plan.protocol = draw(st.sampled_from(sorted(NUMBERS)))
    least = draw(st.sampled_from([1, 4, 32]))
    plan.params = baseline(
        plan.protocol,
        plan.stations,
        plan.params,
        Draws(
            p=draw(st.sampled_from([0.01, 0.3, 1.0])),
            cw_min=least,
            cw_max=draw(st.sampled_from([32, 1024, 32_768])),
            backoff_slots=draw(st.sampled_from([1, 1, 11])),
        ),
    )
    return plan


@pytest.mark.parametrize("examples", [24, pytest.param(300, marks=pytest.mark.slow)])
def test_baselines_compiled_equal_plain(examples):
    settings(QUIET, max_examples=examples)(given(baseline_plans())(check))()
