"""The radio's one source, compiled and plain: the same rows, states and fingerprint."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from innervate.networks.radio.protocol import fields as radio_fields
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.networks.radio.sim.simulate import simulate
from innervate.networks.radio.sim.stacks import PROTOCOLS
from innervate.scenario.actions.channel import FADE, GARBLE, JOIN, KILL, LEAVE
from innervate.sim.driver import InvariantBroken
from tests.networks.radio.runs import START_US, radio_plan
from tests.networks.skin.sim.test_parity import assert_same

PRACTICAL, PAPER = "csma-cd-r/practical", "csma-cd-r/paper"
QUIET = settings(deadline=None, suppress_health_check=list(HealthCheck))


@st.composite
def plans(draw, protocol):
    """Small networks in every kind of trouble, for a fraction of a second."""
    n = draw(st.integers(1, 7))
    moments = st.integers(0, START_US + 60_000)
    node = st.integers(0, n - 1)
    action = st.sampled_from([KILL, LEAVE, GARBLE, FADE, JOIN])
    told = draw(st.lists(st.tuples(moments, action, node, st.integers(1, 3)), max_size=4))
    seed = draw(st.integers(0, 2**32))
    ta = draw(st.sampled_from([0, 0, 300, 2000]))
    low = draw(st.integers(1, 104))
    more = {
        "faults": [RadioFault(at, what, i, value, 0) for at, what, i, value in sorted(told)],
        "loss_q15": draw(st.sampled_from([0, 1000, 10_000])),
        "absent": draw(st.lists(st.sampled_from([0, 0, 0, 1]), min_size=n, max_size=n)),
    }
    if protocol == PAPER:
        more |= {
            "forced": draw(st.booleans()),
            "tail_rule": draw(st.booleans()),
            "overlap_rule": draw(st.booleans()),
            "window_slots": draw(st.sampled_from([0, 0, 2])),
            "dilate": draw(st.sampled_from([1, 1, 4])),
            "wait_us": draw(st.sampled_from([0, 103, 5000])),
        }
    plan = radio_plan(
        n,
        packet_slots=draw(st.sampled_from([5, 25])),
        ta=ta,
        seed=seed,
        traffic=draw(st.sampled_from(["disaster", "saturated"])),
        spread=draw(st.sampled_from([0, 103, 2000, 30_000])),
        duration_s=0.2,
        packets=draw(st.integers(1, 9)),
        real=(low, draw(st.integers(low, 104))),
        protocol=protocol,
        **more,
    )
    if draw(st.booleans()) and n > 2:
        plan.delays_us[0][n - 1] = plan.delays_us[n - 1][0] = -1
    return plan


def states(result):
    """All words of all stations at the end."""
    stations = result.world.stations
    plain = isinstance(stations, list)
    found = []
    for name, length, *_ in radio_fields.STATION + PROTOCOLS[result.plan.protocol].fields:
        for station in stations:
            value = getattr(station, name) if plain else station[name]
            found.append([int(item) for item in value] if length else int(value))
    return found


def outcome(plan, plain):
    """Everything that a run leaves."""
    try:
        result = simulate(plan, plain=plain, trail=True)
    except InvariantBroken as error:
        return {"broken": str(error)}
    kept = ("rows", "sent", "packets", "trail", "counts", "ended_us", "fingerprint")
    return {name: getattr(result, name) for name in kept} | {"states": states(result)}


def check(plan):
    compiled = outcome(plan, plain=False)
    assert "broken" not in compiled, compiled
    assert_same(compiled, outcome(plan, plain=True), f"compiled / plain, {plan}")


@given(plans(PAPER))
@settings(QUIET, max_examples=24)
def test_the_paper_mode_compiled_equals_plain(plan):
    check(plan)


@given(plans(PRACTICAL))
@settings(QUIET, max_examples=24)
def test_the_practical_mode_compiled_equals_plain(plan):
    check(plan)


@pytest.mark.slow
@pytest.mark.parametrize("protocol", [PAPER, PRACTICAL])
def test_many_compiled_runs_equal_plain_ones(protocol):
    @given(plans(protocol))
    @settings(QUIET, max_examples=400)
    def many(plan):
        check(plan)

    many()
