"""How long samples took: from the sensor to the PC, by interface port."""

import numpy as np
import pytest

from innervate.networks.skin.analysis.commands import commands_summary
from innervate.networks.skin.analysis.frames import data_summary
from innervate.networks.skin.columns import columns
from innervate.networks.skin.show import state_lines
from innervate.networks.skin.tables import RECEIVED
from innervate.sim import delays
from tests.networks.skin.runs import line, run, setup_1


def test_every_latency_is_in_the_class_that_holds_it():
    latencies = [*range(5000), *(2**k + d for k in range(12, 30) for d in (-1, 0, 1, 77))]
    for latency_us in latencies:
        number = delays.class_of(latency_us)
        longest = delays.longest_of(number)
        before = delays.longest_of(number - 1) if number else -1
        assert before < latency_us <= longest
        assert longest - latency_us <= latency_us / 256
    assert delays.class_of((1 << 30) - 1) == delays.CLASSES - 1


def test_a_sample_takes_at_least_a_hop_latency_for_every_cable():
    keys = line(5, duration_s=0.4, data={"rate_hz": 20}, timing={"hop_latency_us": [300, 300]})
    result = run(keys, plain=True, deliveries=True)
    assert set(result.deliveries["hops"].tolist()) == {0, 1, 2}
    waited = result.deliveries["latency"] - 300 * (result.deliveries["hops"] + 1)
    assert (waited >= 0).all()  # behind a beacon, or another sample
    assert np.median(waited) == 0
    data = data_summary(result)
    assert 0.6 <= data["latency_ms"]["p50"] <= 0.9 <= data["latency_ms"]["max"]


@pytest.fixture(scope="module")
def crowded():
    """Setup 1 with more samples than its ports can take: queues fill."""
    keys = setup_1(duration_s=0.12, data={"rate_hz": 800, "queue": 20})
    return run(keys, deliveries=True)


def test_percentiles_are_those_of_the_received_samples(crowded):
    data = data_summary(crowded)
    rows = columns(RECEIVED, crowded)
    assert data["lost_by"]["queue_full"] > 0
    assert len(rows["latency_us"]) == data["delivered"]
    _check(data["latency_ms"], rows["latency_us"])
    for one in data["latency_by_port"]:
        mine = rows["latency_us"][rows["interface"] == one["port"]]
        assert one["samples"] == len(mine) > 1000
        _check(one["latency_ms"], mine)


def _check(figures, latencies_us):
    """Exact mean and maximum; percentiles of the nearest rank, not too small, to 0.4 %."""
    assert figures["max"] == latencies_us.max() / 1e3
    assert figures["mean"] == pytest.approx(latencies_us.mean() / 1e3)
    for share in (50, 95, 99):
        exact_us = np.percentile(latencies_us, share, method="inverted_cdf")
        assert exact_us <= 1e3 * figures[f"p{share}"] + 1e-9
        assert 1e3 * figures[f"p{share}"] <= exact_us * (1 + 1 / 256) + 1e-9


def test_the_terminal_says_how_long_samples_took(crowded):
    summary = {
        "data": data_summary(crowded), "port_loads": [], "balance_factor": None,
        "loops": {"episodes": 0, "longest_ms": None},
        "commands": commands_summary(crowded), "lost_at_start": 0,
    }  # fmt: skip
    said = "\n".join(state_lines(summary))
    assert "From sensor to PC: half within" in said


def test_without_data_nothing_took_any_time():
    data = data_summary(run(line(3, duration_s=0.05), plain=True))
    assert data["latency_ms"] == dict.fromkeys(("mean", "p50", "p95", "p99", "max"))
    assert data["latency_by_port"] == []
