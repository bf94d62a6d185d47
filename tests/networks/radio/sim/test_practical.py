"""Practical CSMA/CD-R on the event-level channel: every packet arrives, and its sender knows."""

import numpy as np
import pytest

from innervate.networks.radio.protocol.constants import DATA, REPORT_BOUNDS
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.scenario.actions.channel import FADE, GARBLE, JOIN, KILL, LEAVE
from innervate.sim.tables import uniform
from tests.networks.radio.runs import START_US, run

SIZES = (2, 3, 5, 10, 20, 50, 100)
SLOT_US = 208


def duration_slots(result):
    """T_D: first offer to the end of the last packet."""
    packets = result.packets
    return (packets["end"].max() - packets["offered"].min()) / SLOT_US


def assert_nothing_lost(result, wanted, what):
    counts = result.counts
    assert counts["completed"] >= wanted, f"{what}: {counts['completed']} of {wanted} delivered"
    assert counts["silent"] == 0, f"{what}: {counts['silent']} lost silently"


def disasters(packet_slots, ta, spread, seeds, sizes=SIZES):
    """Mean T_D for each number of stations; every one complete, everybody heard every packet."""
    means = []
    for n in sizes:
        found = []
        for seed in seeds:
            result = run(n, packet_slots, ta, seed, spread=spread, checks=seed <= 3)
            what = f"n={n} T={packet_slots} ta={ta} spread={spread} seed={seed}"
            assert_nothing_lost(result, n, what)
            assert result.counts["partial"] == 0, f"{what}: some did not hear a packet"
            assert not (result.rows["code"] == REPORT_BOUNDS).any(), f"{what}: bounds are true"
            found.append(duration_slots(result))
        means.append(np.mean(found))
    return np.array(means)


def line_through(means, sizes=SIZES):
    """Slope and R^2 of the straight line nearest to the means."""
    slope, start = np.polyfit(sizes, means, 1)
    residue = means - (slope * np.array(sizes) + start)
    return slope, 1 - (residue**2).sum() / ((means - means.mean()) ** 2).sum()


@pytest.mark.parametrize("packet_slots", [5, 25])
@pytest.mark.parametrize("ta", [0, 2000])
@pytest.mark.parametrize("together", [True, False])
@pytest.mark.few(4)
def test_every_disaster_completes_in_linear_time(packet_slots, ta, together):
    means = disasters(packet_slots, ta, 0 if together else ta + 104, range(1, 6))
    slope, fit = line_through(means)
    assert fit > 0.99, f"T_D {means} is not affine in n"
    if ta == 0:
        assert slope <= packet_slots + 6.5


@pytest.mark.slow
@pytest.mark.parametrize("packet_slots", [5, 25])
@pytest.mark.parametrize("ta", [0, 2000])
@pytest.mark.parametrize("together", [True, False])
def test_a_thousand_disasters_of_every_size(packet_slots, ta, together):
    means = disasters(packet_slots, ta, 0 if together else ta + 104, range(1, 1001))
    slope, fit = line_through(means)
    assert fit > 0.99
    if ta == 0:
        assert slope <= packet_slots + 6.5


def saturation(n, packet_slots, ta, packets, **more):
    result = run(
        n, packet_slots, ta, 1, "saturated", packets=packets, duration_s=1e4, checks=n < 20, **more
    )
    sent = np.sort(result.packets, order="end")
    sent = sent[len(sent) // 10 :]
    elapsed = sent["end"].max() - sent["end"].min()
    return result, (len(sent) - 1) * packet_slots * SLOT_US / elapsed, sent


def jain(counts):
    return counts.sum() ** 2 / (len(counts) * (counts**2).sum())


@pytest.mark.parametrize("packet_slots", [5, 25])
@pytest.mark.parametrize("ta", [0, 2000])
@pytest.mark.parametrize("n", [2, 3, 4, 5, 8, 13, 30, 60, 100])
def test_saturated_stations_fill_the_channel_in_turn(n, packet_slots, ta):
    # [radio 10] the limit is the hand-over: T / (T + ta + d), d = 78 us the mean pair delay.
    result, share, sent = saturation(n, packet_slots, ta, packets=max(40, 400 // n))
    bound = packet_slots / (packet_slots + (ta + 78) / SLOT_US)
    assert share >= (0.97 if ta == 0 else 0.92) * bound, f"{share / bound:.4f} of the bound"
    assert result.counts["silent"] == result.counts["partial"] == 0
    rounds = sent["node"][: len(sent) // n * n].reshape(-1, n)
    fair = [jain(np.bincount(row, minlength=n)) for row in rounds]
    assert np.mean(fair) >= 0.99


def test_several_packets_in_a_turn_pass_the_bound_of_one():
    # radio-practical 4 (b): k packets give kT / (kT + ta + d).
    _, one, _ = saturation(5, 5, 2000, 60)
    _, four, sent = saturation(5, 5, 2000, 60, per_turn=4)
    assert four > 0.92 * 20 / (20 + 2078 / SLOT_US) > one
    assert jain(np.bincount(sent["node"])) > 0.99


@pytest.mark.parametrize("ta", [0, 2000])
@pytest.mark.parametrize("share", [0.01, 0.05, 0.1])
def test_frame_errors_lose_nothing_silently(ta, share):
    for n in (2, 3, 10):
        for seed in (1, 2):
            result = run(
                n,
                25,
                ta,
                seed,
                "saturated",
                packets=10**6,
                duration_s=2,
                loss_q15=round(share * 2**15),
            )
            what = f"n={n} ta={ta} loss={share} seed={seed}"
            assert_nothing_lost(result, 100, what)
            gaps = np.diff(np.sort(result.packets["end"]))
            assert gaps.max() < 250_000, f"{what}: standstill of {gaps.max() / 1000:.0f} ms"


def comings_and_goings(seed, n, duration_s):
    """Stations die and return at random moments, at most half of them at once away."""
    draws = uniform(seed, "churn", 2000, 10**6)
    events, gone, at, i = [], set(), 300_000, 0
    while at < duration_s * 1e6 and i < 1998:
        at += 50_000 + int(draws[i]) // 8
        node = int(draws[i + 1]) % n
        i += 2
        if node in gone:
            gone.remove(node)
            events.append(RadioFault(at, JOIN, node, 0, 0))
        elif len(gone) < n // 2:
            gone.add(node)
            events.append(RadioFault(at, KILL, node, 0, 0))
    return events


@pytest.mark.parametrize("ta", [0, 2000])
@pytest.mark.parametrize("n", [3, 5, 10])
def test_robots_that_die_and_return_stop_nobody(n, ta):
    for seed in (1, 2, 3):
        faults = comings_and_goings(seed, n, 4)
        result = run(n, 5, ta, seed, "saturated", packets=10**6, duration_s=4, faults=faults)
        assert_nothing_lost(result, 500, f"n={n} ta={ta} seed={seed}")
        gaps = np.diff(np.sort(result.packets["end"]))
        assert gaps.max() < 250_000


@pytest.mark.parametrize("ta", [0, 2000])
@pytest.mark.parametrize("n", [3, 10, 20])
def test_deaths_and_late_joiners_in_a_disaster(n, ta):
    # Regression: a station that died in the last 52 us of a frame left a carrier behind for ever.
    for seed in range(1, 31):
        draws = uniform(seed, "disaster", 3 * n, 10**6)
        dead = sorted({int(x) % n for x in draws[: n // 3]})
        late = [i for i in range(n) if i not in dead][: n // 3]
        span = n * 32 * SLOT_US + 2 * ta * n
        moments = START_US + draws[n:] * span // 10**6
        faults = [RadioFault(int(at), KILL, i, 0, 0) for at, i in zip(moments, dead, strict=False)]
        faults += [
            RadioFault(int(at), JOIN, i, 0, 0) for at, i in zip(moments[n:], late, strict=False)
        ]
        faults.sort(key=lambda fault: fault.at_us)
        absent = [int(i in late) for i in range(n)]
        result = run(
            n, 5, ta, seed, spread=ta + 104, duration_s=10, faults=faults, absent=absent, wanted=0
        )
        done = set(result.packets["node"].tolist())
        assert result.counts["silent"] == 0, f"seed {seed}"
        missing = [i for i in range(n) if i not in done and i not in dead]
        assert not missing, f"seed {seed}: nothing from {missing}"


@pytest.mark.parametrize("ta", [0, 2000])
def test_packets_of_any_length(ta):
    for seed in range(1, 31):
        sizes = [[3 + int(x)] for x in uniform(seed, "sizes", 10, 23)]
        result = run(10, 25, ta, seed, spread=ta + 104, sizes=sizes, duration_s=10)
        assert_nothing_lost(result, 10, f"seed {seed}")
        assert result.counts["partial"] == 0


@pytest.mark.parametrize("ta", [0, 2000])
@pytest.mark.parametrize("action", [GARBLE, FADE])
def test_spoilt_reservations_cost_time_only(ta, action):
    for seed in range(1, 21):
        faults = [RadioFault(START_US, action, node, 3, 0) for node in range(10)]
        result = run(10, 25, ta, seed, faults=faults, duration_s=20)
        assert_nothing_lost(result, 10, f"seed {seed}")


def test_a_station_that_leaves_sends_what_it_has():
    faults = [RadioFault(1_000_000, LEAVE, 2, 0, 0)]
    result = run(5, 25, 0, 1, "saturated", packets=10**6, duration_s=2, faults=faults)
    sent = np.sort(result.packets, order="end")
    last = sent[sent["node"] == 2]["end"].max()
    assert 1_000_000 < last < 1_200_000
    assert (sent[sent["end"] > last]["node"] != 2).all()
    assert result.counts["silent"] == 0


@pytest.mark.parametrize("real", [(52, 120), (1, 104), (52, 208)])
@pytest.mark.parametrize("ta", [0, 2000])
def test_wrong_delay_bounds_are_noticed(real, ta):
    # A disaster that cannot be resolved because the bounds are wrong is never silent about it.
    for seed in range(1, 21):
        result = run(10, 25, ta, seed, real=real, duration_s=3)
        noticed = (result.rows["code"] == REPORT_BOUNDS).any()
        assert noticed or result.counts["completed"] == 10, f"seed {seed}"
        assert result.counts["silent"] == 0


def test_a_lone_station_never_believes_in_a_listener():
    result = run(1, 25, 0, 1, duration_s=3)
    assert result.counts["completed"] == 0
    starts = result.sent["time"]
    assert len(starts) > 5
    assert np.diff(starts)[-1] > np.diff(starts)[:3].max()  # it tries ever more rarely


def test_one_turn_for_each_reservation():
    # Between two data frames of a station all others with a place have had their turn, or a window
    # was open.
    for seed in (1, 2, 3):
        result = run(6, 5, 0, seed, "saturated", packets=100, duration_s=100)
        data = result.sent[result.sent["kind"] == DATA]
        since = {}
        for row in data:
            node, pos = int(row["node"]), int(row["pos"])
            if since.get(node):
                others = {int(other["node"]) for other in since[node]}
                opened = any(
                    int(other["next"]) in (int(other["pos"]), 127) for other in since[node]
                )
                assert others - {node} or opened, f"seed {seed}: two turns in a row for {node}"
            for known in since:
                since[known].append(row)
            since[node] = []
            assert 0 <= pos < 120
