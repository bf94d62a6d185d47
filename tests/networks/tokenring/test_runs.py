"""A network over cables of which no file of the toolkit knows, by the defaults of its medium."""

import numpy as np
import pytest

from innervate import scenario
from innervate.kernel import compilation
from innervate.network import networks
from innervate.running import run
from innervate.sim import taps
from innervate.sim.cables import declared
from innervate.sim.driver import InvariantBroken

REPAIRED = [("cut", 0.1), ("restore", 0.15), ("kill", 0.2), ("revive", 0.25), ("restart", 0.3),
            ("loose", 0.35), ("lose", 0.4)]  # fmt: skip


def tables(**keys):
    """A ring's scenario with an event of every kind."""
    events = [{"at_s": at, "action": action, "node": 2} for action, at in REPAIRED]
    return {"kind": "tokenring", "event": events, "loads": True, **keys}


def plan_of(**keys):
    return scenario.plan(scenario.from_dict(tables(**keys)))


def finished(plan, tap=None, **kept):
    """A simulation that was run to its end, and its rows."""
    running = declared.simulation(plan, tap=tap is not None, **kept)
    return running, running.finish(tap=tap).rows


def test_a_declared_network_runs_and_its_token_goes_round():
    done = run(tables(event=[]), plain=True)
    counts = done.result.counts
    assert counts.delivered == counts.arrived > 300
    assert sum(counts.lost_by.values()) == 0
    found = done.tables["deliveries"].collect()
    assert (found["node"].diff().drop_nulls() % 4).unique().to_list() == [1]
    assert found["latency_us"].min() > 0
    assert "4 cables" in networks()["tokenring"].describe(done.plan)


def test_what_nobody_handed_in_has_no_latency():
    done = run(tables(event=[], loads=False), plain=True)
    assert done.tables["deliveries"].collect()["latency_us"].null_count() > 300
    assert set(done.summary["messages"]["latency_ms"].values()) == {None}


def test_a_declared_network_is_mended_after_every_fault():
    _, rows = finished(plan_of(), plain=True, deliveries=True)
    made = rows["rows"]["time"][rows["rows"]["code"] == 1]
    assert len(made) >= 4  # the first token, and one after each loss
    assert rows["deliveries"]["time"][-1] > 450_000


def test_compiled_runs_of_a_declared_network_equal_plain_ones():
    plan, kept = plan_of(), {"deliveries": True, "trail": True}
    (one, rows), (other, plain) = (finished(plan, plain=p, **kept) for p in (False, True))
    assert one.fingerprint == other.fingerprint
    assert list(one.world.counters) == list(other.world.counters)
    for name in ("rows", "deliveries", "trail"):
        assert np.array_equal(rows[name], plain[name]), name


def test_a_plain_run_leaves_compiled_loops_where_they_are():
    before = compilation.open_cache()
    finished(plan_of(duration_s=0.05, event=[]), plain=True)
    assert compilation.open_cache() == before


def test_what_is_out_of_its_declared_range_is_found():
    with pytest.raises(InvariantBroken, match="a value of n0 is out of its declared range"):
        finished(plan_of(duration_s=2.0, event=[]), plain=True)


def test_frames_of_a_declared_network_are_tapped():
    seen = []
    running, _ = finished(
        plan_of(event=[]), lambda rows, frames, _now: seen.extend(rows), plain=True
    )
    arrived = [row for row in seen if row["out"] == 0 and row["why"] == taps.FINE]
    assert len(arrived) == running.counts().arrived
