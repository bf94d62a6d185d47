"""When messages of a mesh's flows are offered, by whom, to whom, and as what."""

import itertools

import pytest

from innervate import scenario as scenarios
from innervate.networks.mesh.protocol.constants import ALL, END_TO_END, PRIORITY

LINE = {"kind": "mesh", "nodes": 4, "duration_s": 20.0,
        "link": [{"a": k, "b": k + 1} for k in range(3)]}  # fmt: skip
SECOND = 1_000_000


def offers(*flows, **changes):
    flows = [{"from": 1, "to": 2, **flow} for flow in flows]
    return scenarios.plan(scenarios.from_dict(LINE | changes | {"flow": flows})).offers


def times(**flow):
    return [one.at_us for one in offers(flow)]


@pytest.mark.parametrize(
    ("flow", "seconds"),
    [
        ({"start_s": 3}, [3]),
        ({"start_s": 19.999999}, [19.999999]),
        ({"start_s": 3, "count": 3}, [3, 4, 5]),
        ({"start_s": 3, "every_s": 8}, [3, 11, 19]),
        ({"start_s": 4, "every_s": 8}, [4, 12]),
        ({"start_s": 3, "every_s": 2, "count": 2}, [3, 5]),
        ({"start_s": 3, "every_s": 2, "stop_s": 9}, [3, 5, 7]),
        ({"start_s": 3, "every_s": 2, "stop_s": 9.000001}, [3, 5, 7, 9]),
        ({"start_s": 3, "every_s": 8, "stop_s": 99}, [3, 11, 19]),
        ({"start_s": 18, "count": 5}, [18, 19]),
    ],
)
def test_when_messages_are_offered(flow, seconds):
    assert times(**flow) == [round(SECOND * at) for at in seconds]


def test_a_rate_is_a_mean_and_waits_are_drawn():
    at = times(start_s=2, rate_hz=200)
    assert len(at) == pytest.approx(18 * 200, rel=0.06)
    assert min(at) > 2 * SECOND
    assert max(at) < 20 * SECOND
    waits = sorted(b - a for a, b in itertools.pairwise(at))
    assert waits[len(waits) // 2] == pytest.approx(5000 * 0.693, rel=0.08), "exponential"
    assert min(waits) >= 1


def test_of_the_least_of_all_rates_nothing_comes():
    assert times(start_s=2, rate_hz=5e-324) == []


def test_jitter_comes_late_by_no_more_than_it_says():
    at = times(start_s=2, every_s=0.1, jitter_s=0.05)
    late = [one - 2 * SECOND - 100_000 * k for k, one in enumerate(at)]
    assert len(at) in (179, 180)
    assert min(late) >= 0
    assert 45_000 < max(late) <= 50_000


def test_what_would_come_late_for_the_end_is_left_out():
    at = times(start_s=2, every_s=0.001, jitter_s=1.0, stop_s=4)
    assert at == sorted(at)
    assert max(at) < 4 * SECOND
    assert 1400 < len(at) < 1600, "of the last thousand half"


@pytest.mark.parametrize(
    ("flow", "flags"),
    [
        ({}, END_TO_END),
        ({"reliable": False}, 0),
        ({"priority": True}, END_TO_END | PRIORITY),
        ({"to": "all"}, 0),
        ({"to": "all", "priority": True}, PRIORITY),
        ({"reliable": False, "priority": True}, PRIORITY),
    ],
)
def test_what_messages_are(flow, flags):
    (one, *_) = offers({"start_s": 3, "bytes": 7, **flow})
    assert (one.flags, one.length, one.flow) == (flags, 7, 0)
    assert one.dest == (ALL if flow.get("to") == "all" else 2)


def test_a_scenario_may_want_no_acknowledgements_but_a_flow_may():
    mesh = {"protocol": {"reliable": False}}
    assert [one.flags for one in offers({"start_s": 1}, **mesh)] == [0]
    assert [one.flags for one in offers({"start_s": 1, "reliable": True}, **mesh)] == [END_TO_END]


def test_all_may_send_and_flows_are_in_order_of_time():
    found = offers({"from": "all", "to": 0, "start_s": 5}, {"start_s": 5}, {"start_s": 4})
    said = [(one.at_us // SECOND, one.flow, one.node, one.dest) for one in found]
    assert said == [(4, 2, 1, 2), (5, 0, 1, 0), (5, 0, 2, 0), (5, 0, 3, 0), (5, 1, 1, 2)]
