import json
from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.skin.analysis.summary import broken_ports, summarize
from innervate.networks.skin.protocol.constants import ONE, REPORT_BROKEN
from innervate.sim.cables.world import ALIVE, DEAD
from innervate.sim.tables import ROW, row_dtype
from tests.networks.skin.runs import line as cells_in_a_line
from tests.networks.skin.runs import plan_of

KEYS = {
    "kind", "name", "seed", "duration_s", "events", "events_per_s", "wall_s", "fingerprint",
    "cells", "depth_max", "recoveries", "loops", "balance_factor", "port_loads", "data",
    "beacon_share", "broken",
}  # fmt: skip


@pytest.fixture(scope="module")
def result(go):
    return go("setup-3", "data.rate_hz=100", seconds=2.5)


def test_has_all_names(result):
    summary = summarize(result)
    assert set(summary) >= KEYS
    assert "interrupted_at_s" not in summary
    assert (summary["cells"], summary["depth_max"], summary["seed"]) == (35, 6, 1)
    assert summary["loops"] == {"episodes": 0, "longest_ms": None}
    assert set(summary["data"]) >= {"sent", "delivered", "lost", "loss_ratio"}
    assert summary["events"] == result.handled + result.arrived


def test_is_plain_json(result):
    summary = summarize(result)
    assert json.loads(json.dumps(summary, allow_nan=False)) == summary


def test_names_the_broken_cable(result):
    (broken,) = broken_ports(result)
    assert broken["to"] == "pc.1"
    assert broken["cell"] == "p0 r6 c2"
    assert broken["port"] == "down"
    recovery = summarize(result)["recoveries"][0]
    since_cut_ms = 1e3 * (broken["since_s"] - recovery["at_s"])
    assert since_cut_ms == pytest.approx(recovery["detected_ms"])


def test_a_mended_cable_is_not_broken(line, go):
    events = [
        {"at_s": 1.0, "action": "cut", "interface": 1},
        {"at_s": 1.5, "action": "restore", "interface": 1},
    ]
    assert broken_ports(go(line(3, event=events))) == []


def test_neighbours_of_a_dead_cell_are_broken_and_it_is_not_listed(line, go):
    event = {"at_s": 1.0, "action": "kill", "cell": {"row": 0, "column": 1}}
    result = go(line(3, event=[event]))
    found = [(broken["cell"], broken["port"], broken["to"]) for broken in broken_ports(result)]
    assert found == [("p0 r0 c0", "E", "p0 r0 c1 W"), ("p0 r0 c2", "W", "p0 r0 c1 E")]


def test_a_port_is_broken_from_the_last_time_it_was_found_so():
    """Three cells in a row; who is off finds nothing, and a port without a cable is none."""
    rows = [(100, 0, REPORT_BROKEN, 1, 1), (200, 0, REPORT_BROKEN, 1, 0),
            (300, 0, REPORT_BROKEN, 1, 1), (400, 1, REPORT_BROKEN, 0, 1)]  # fmt: skip
    penalties = [(ONE - 1, ONE, ONE, 0), (ONE, 0, 0, 0), (2 * ONE, 0, 0, 0)]
    result = Of(
        plan=plan_of(cells_in_a_line(3)), rows=np.array(rows, row_dtype(ROW)),
        world=Of(cells=[Of(pf=pf) for pf in penalties], alive=[ALIVE, DEAD, ALIVE, ALIVE]),
    )  # fmt: skip
    assert broken_ports(result) == [
        {"cell": "p0 r0 c0", "port": "E", "since_s": 0.0003, "to": "p0 r0 c1 W"},
        {"cell": "p0 r0 c2", "port": "W", "since_s": None, "to": "p0 r0 c1 E"},
    ]


def test_unobserved_runs_have_a_summary_too(line, go):
    seen = summarize(go(line(3), checks=False))
    unseen = summarize(go(line(3), checks=False, observe=False))
    assert unseen["recoveries"] == []
    assert unseen["start_up"] == {"converged_ms": None, "routed_ms": None}
    for name in ("fingerprint", "port_loads", "balance_factor", "data", "beacon_share"):
        assert unseen[name] == seen[name]


def test_same_uncompiled(line, go):
    compiled, plain = (summarize(go(line(3, duration_s=1.2), plain=p)) for p in (False, True))
    for name in ("wall_s", "events_per_s"):
        del compiled[name], plain[name]
    assert compiled == plain
