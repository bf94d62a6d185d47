"""One source, many ways to run it: compiled = plain = with every frame as bytes, row for row."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from innervate.networks.skin import frames as wire
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.networks.skin.sim import stack as skin_stack
from innervate.networks.skin.sim import static_stack
from innervate.networks.skin.sim.simulate import simulate
from innervate.sim.driver import InvariantBroken
from tests.networks.skin.runs import (
    EVERYTHING,
    free,
    keys_of,
    patch,
    plain_stack,
    plan_of,
    random_events,
)

RULES = ["feasible", "strict", "paper", "paper-lax", "static"]
SHAPES = [
    patch(3, 3, (0, 1), (2, 1)),
    patch(4, 2, (0, 0)),
    patch(2, 5, (0, 0), (4, 1), (2, 0)),
    free([("pc.0", "a.2"), ("a.3", "b.0"), ("b.1", "c.0"), ("c.3", "pc.1"), ("a.0", "c.2")]),
    keys_of(patch=[{"columns": 2, "rows": 2, "count": 3, "interfaces_every": 2, "wiring": "S"}]),
]
TOUCH = {"path": [[0.0, 0.0, 0.0], [0.1, 40.0, 30.0]], "radius_mm": 25, "force_n": 3}
QUIET = settings(deadline=None, suppress_health_check=list(HealthCheck))


@st.composite
def scenarios(draw):
    """Small skins of every kind, in trouble of every kind, for a few hundred milliseconds."""
    seed = draw(st.integers(0, 2**32))
    loss = draw(st.sampled_from([0.0, 0.1, 0.6]))
    events, last = random_events(
        draw(st.integers(0, 2**16)), draw(st.integers(0, 6)), EVERYTHING,
        start_s=0.03, gap_s=0.01, most=2,
    )  # fmt: skip
    protocol = {
        "rule": draw(st.sampled_from(RULES)),
        "updates": draw(st.sampled_from(["periodic", "triggered", "wave"])),
        "beacon_hz": draw(st.sampled_from([100, 250, 500])),
        "k": draw(st.integers(1, 6)),
        "m": draw(st.integers(1, 4)),
        "balance_periods": draw(st.integers(1, 9)),
        "balance_rule": draw(st.sampled_from(["even", "paper"])),
        "restart_s": 0.02,
        "gap_us": draw(st.sampled_from([0, 300, 500])),
    }
    low = draw(st.integers(1, 200))
    timing = {
        "loss": loss,
        "drift_ppm": draw(st.sampled_from([0, 1000, 50_000])),
        "hop_latency_us": [low, low + draw(st.integers(0, 200))],
        "latency": draw(st.sampled_from(["per_link", "per_frame"])),
        "lock_step": draw(st.booleans()),
    }
    keys = dict(draw(st.sampled_from(SHAPES)), seed=seed, event=events, protocol=protocol)
    keys |= {"timing": timing, "duration_s": last + 0.05}
    if draw(st.booleans()):
        rate = draw(st.sampled_from([50, 700, 3000]))
        keys["data"] = {"rate_hz": rate, "queue": draw(st.integers(1, 8))}
        if "patch" in keys and draw(st.booleans()):
            keys["touch"] = TOUCH
    if draw(st.booleans()):
        rate = draw(st.sampled_from([0, 20, 900]))
        whom = draw(st.sampled_from([{}, {"random": True}]))
        at_s = draw(st.integers(0, 1000)) * keys["duration_s"] / 1001
        keys["command"] = [{"at_s": at_s, "rate_hz": rate, "code": 7, "value": 65_535, **whom}]
    return keys


def states(result):
    """All words of all cells and of the PC at the end."""
    world, plain = result.world, isinstance(result.world.cells, list)
    found = [[int(size) for size in world.pc.size]]
    for name, length, *_ in skin_fields.CELL:
        for cell in world.cells:
            value = getattr(cell, name) if plain else cell[name]
            found.append([int(item) for item in value] if length else int(value))
    own = world.pc.own[0]
    return found + [int(getattr(own, f[0]) if plain else own[f[0]]) for f in skin_fields.SINK]


def outcome(plan, *, plain=False, checks=True):
    """Everything that a run leaves."""
    try:
        result = simulate(plan, plain=plain, checks=checks, deliveries=True, trail=True)
    except InvariantBroken as error:
        return {"broken": str(error)}
    kept = ("rows", "trail", "deliveries", "counters", "handled", "arrived", "fingerprint")
    return {name: getattr(result, name) for name in kept} | {"states": states(result)}


def assert_same(one, other, what):
    """Fail with the first difference."""
    assert one.keys() == other.keys(), f"{what}: {one.get('broken')} / {other.get('broken')}"
    for name in one:
        a, b = one[name], other[name]
        if isinstance(a, np.ndarray):
            least = min(len(a), len(b))
            differ = np.flatnonzero(a[:least] != b[:least])
            at = int(differ[0]) if len(differ) else least
            same = len(differ) == 0 and len(a) == len(b)
            assert same, f"{what}: {name}[{at}] {a[at : at + 1]} / {b[at : at + 1]}"
        else:
            assert a == b, f"{what}: {name} differ"


def check_compiled_equals_plain(keys, checks):
    plan = plan_of(keys)
    compiled = outcome(plan, checks=checks)
    plain = outcome(plan, plain=True, checks=checks)
    assert_same(compiled, plain, f"compiled / plain, {keys}")


@given(scenarios(), st.booleans())
@settings(QUIET, max_examples=16)
def test_compiled_runs_equal_plain_ones_row_for_row(keys, checks):
    check_compiled_equals_plain(keys, checks)


@pytest.mark.slow
@given(scenarios(), st.booleans())
@settings(QUIET, max_examples=250)
def test_many_compiled_runs_equal_plain_ones(keys, checks):
    check_compiled_equals_plain(keys, checks)


def through_the_wire(stack):
    """The same stack, but every frame that is copied goes through its bytes."""

    def copy_frame(to, frm):
        reason = wire.decode(wire.encode(frm), to)
        assert reason == wire.OK, wire.REASONS[reason]
        to.made_at = frm.made_at  # the run's own note

    return SimpleNamespace(**{**vars(stack), "copy_frame": copy_frame})


def check_wire(keys):
    plan = plan_of(keys)
    stack = static_stack if plan.params["rule"] == 3 else skin_stack
    as_records = outcome(plan, plain=True)
    with plain_stack(through_the_wire(stack)):
        as_bytes = outcome(plan, plain=True)
    assert_same(as_records, as_bytes, f"records / bytes, {keys}")


@given(scenarios())
@settings(QUIET, max_examples=6)
def test_frames_as_bytes_change_nothing(keys):
    check_wire(keys)


@pytest.mark.slow
@given(scenarios())
@settings(QUIET, max_examples=120)
def test_frames_as_bytes_change_nothing_in_many_runs(keys):
    check_wire(keys)


@pytest.mark.parametrize("rule", RULES)
def test_a_busy_scenario_equals_plain_under_every_rule(rule):
    events, last = random_events(11, 8, EVERYTHING, start_s=0.05)
    keys = patch(
        4, 4, (0, 1), (3, 2),
        seed=5, event=events, duration_s=last + 0.05, touch=TOUCH,
        data={"rate_hz": 300, "queue": 2}, timing={"loss": 0.05},
        protocol={"rule": rule, "restart_s": 0.05, "balance_periods": 4},
    )  # fmt: skip
    plan = plan_of(keys)
    compiled, plain = outcome(plan, checks=False), outcome(plan, plain=True, checks=False)
    assert_same(compiled, plain, f"compiled / plain under {rule}")
    assert len(compiled["deliveries"]) > 50
    assert len(compiled["rows"]) > 20
