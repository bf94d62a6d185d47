"""Baselines on the event-level channel: they deliver, and agree with their closed forms."""

import numpy as np
import pytest

from innervate.networks.radio.analysis import air as radio_air
from innervate.networks.radio.analysis import airtime
from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.analysis import summary as analysis
from innervate.networks.radio.protocol.constants import REPORT_COLLISION, REPORT_STOPPED
from innervate.networks.radio.scenario.baselines import NUMBERS
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.networks.radio.sim.simulate import simulate
from innervate.networks.radio.slotted.model import slotted
from innervate.scenario.actions.channel import JOIN, KILL, LEAVE
from innervate.sim.tables import uniform
from tests.networks.radio import forms as infinite
from tests.networks.radio.baseline_runs import (
    SLOT_US,
    TAU_US,
    baseline_plan,
    run_baseline,
    saturate,
)
from tests.networks.radio.runs import START_US

MACS = sorted(NUMBERS)
CABLE = "csma-cd-d1"
WITHIN = 0.02


def close(found, exact, within=WITHIN):
    return found == pytest.approx(exact, rel=within)


@pytest.mark.parametrize("mac", MACS)
@pytest.mark.parametrize("ta", [0, 2000])
def test_everybody_is_served_in_a_disaster(mac, ta):
    for n, seed in ((2, 1), (3, 2), (10, 3), (30, 4)):
        for spread in (0, ta + TAU_US):
            chance = {"p": 1 / n}
            result = run_baseline(mac, n, 5, ta, seed, spread=spread, real=(52, 104), **chance)
            assert sorted(result.packets["node"].tolist()) == list(range(n))
            assert result.counts["silent"] == 0
            if ta == 0:
                assert result.counts["partial"] == 0  # and everybody heard everything


@pytest.mark.parametrize("mac", MACS)
def test_a_late_station_a_death_and_a_departure_stop_nobody(mac):
    at = START_US
    faults = [
        RadioFault(at, KILL, 0, 0, 0), RadioFault(at + 70_000, JOIN, 1, 0, 0),
        RadioFault(at + 90_000, JOIN, 0, 0, 0), RadioFault(at + 150_000, LEAVE, 2, 0, 0),
    ]  # fmt: skip
    result = run_baseline(
        mac, 5, 5, 0, 1, traffic="saturated", packets=10**6, duration_s=4.0, real=(52, 104),
        faults=faults, absent=[0, 1, 0, 0, 0], wanted=0, p=0.1,
    )  # fmt: skip
    late = result.packets[result.packets["end"] > at + 200_000]
    shares = np.bincount(late["node"], minlength=5)
    assert shares[2] <= 3  # what it had been given
    assert shares.sum() > 300
    if mac not in (CABLE, "csma-cd-d2", "csma-cd-d2p"):  # there one station may have it all
        assert shares[[0, 1, 3, 4]].min() > 30
    assert result.counts["silent"] == 0


@pytest.mark.parametrize("mac", [mac for mac in MACS if mac != CABLE])
def test_the_oracle_never_errs(mac):
    result = run_baseline(
        mac, 3, 5, 0, 1, traffic="saturated", packets=300, real=(52, 104), loss_q15=6000, p=0.2
    )
    assert result.counts["completed"] == 900
    assert result.counts["silent"] == result.counts["again"] == 0
    assert result.counts["partial"] > 0


def test_nobody_hears_a_lone_station():
    assert run_baseline("csma-cd-d2", 1, duration_s=2.0).counts["completed"] == 0


@pytest.mark.parametrize("packet_slots", [5, 25])
@pytest.mark.parametrize("mac", ["csma-cd-d1", "csma-cd-d2", "csma-cd-d2p"])
@pytest.mark.few(3)
def test_csma_cd_agrees_with_the_slotted_level(mac, packet_slots):
    # Delays of half a slot put all stations on a grid of slots. One station at a time has the
    # channel for long: means settle slowly.
    for n in (2, 10):
        found = airtime.throughput(saturate(mac, n, packet_slots, 20_000))
        exact = slotted(mac, n, packet_slots, "saturated", packets=20_000 // n).throughput
        assert close(found, exact, 0.03), n


@pytest.mark.parametrize(("mac", "packet_slots", "published"), [
    ("csma-cd-d2", 5, 0.785), ("csma-cd-d2p", 5, 0.499),
])  # fmt: skip
def test_capture_and_its_absence(mac, packet_slots, published):
    # [radio F3]
    result = saturate(mac, 5, packet_slots, 20_000)
    assert close(airtime.throughput(result), published)
    if mac == "csma-cd-d2":
        assert close(analysis.jain_round(result), 0.20)


@pytest.mark.parametrize("mac", ["csma-cd-d1", "csma-cd-d2", "csma-cd-d2p"])
@pytest.mark.few(2)  # where two collide, D2 and D2' are the same
def test_two_stations_after_a_disaster(mac):
    cost = 1 if mac == CABLE else 6
    plans = [baseline_plan(mac, 2, 5, seed=seed) for seed in range(400)]
    ended = [simulate(plan, checks=False, observe=False).ended_us for plan in plans]
    found = (np.mean(ended) - START_US - TAU_US) / SLOT_US  # its sender knows a tau later
    assert close(found, forms.pair_duration_slots(5, cost))


def test_backoff_slots_longer_than_the_turnaround_keep_stations_apart():
    near, far = (
        airtime.throughput(saturate("csma-cd-d2p", 10, 25, 8000, ta=2000, backoff_slots=slots))
        for slots in (1, 11)
    )
    assert far > 1.1 * near


@pytest.mark.parametrize(("n", "packet_slots"), [(2, 5), (10, 5), (20, 25)])
def test_dcf_agrees_with_bianchi(n, packet_slots):
    for least, most, stages in ((16, 1024, 6), (32, 256, 3)):
        result = saturate("dcf", n, packet_slots, 10_000, cw_min=least, cw_max=most)
        # T_s: a slot to hear its end and wait, two for the answer. T_c: without the answer.
        exact = forms.dcf_throughput(
            n, least, stages, payload=packet_slots, success=packet_slots + 3,
            collision=packet_slots + 1,
        )  # fmt: skip
        assert close(airtime.throughput(result), exact)


def aloha(result):
    """(G, S): transmissions and successes per slot, which is longer than a packet by tau."""
    slots = result.ended_us / result.plan.params["period_us"]
    return len(result.sent) / slots, result.counts["completed"] / slots


@pytest.mark.parametrize("load", [0.25, 0.5, 1.0, 1.5, 2.0])
@pytest.mark.few(3)
def test_slotted_aloha_in_saturation(load):
    n = 60
    found_load, found = aloha(saturate("slotted-aloha", n, 5, 6000, p=load / n))
    assert close(found_load, load)
    assert close(found, infinite.aloha_throughput(found_load))


@pytest.mark.parametrize("carried", [0.1, 0.2, 0.3])
def test_slotted_aloha_with_poisson_offers(carried):
    # Many stations that try again late and at random: transmissions are Poisson, too.
    n, duration_s = 60, 40.0
    plan = baseline_plan("slotted-aloha", n, 5, duration_s=duration_s, p=0.01, wanted=0)
    period = plan.params["period_us"]
    for i in range(n):
        gaps = -np.log1p(-uniform(1, f"offers/{i}", 4000, 1 << 30) / (1 << 30))
        times = np.cumsum(gaps * n * period / carried).astype(np.int64) + 1
        plan.arrivals[i] = times[times < duration_s * 1e6].tolist()
    result = simulate(plan, checks=False)
    load, found = aloha(result)
    assert close(found, carried, 0.03)
    assert close(found, infinite.aloha_throughput(load))


@pytest.mark.parametrize(("mac", "packet_slots"), [
    ("nonpersistent", 5), ("nonpersistent", 25), ("p-persistent", 25),
    pytest.param("p-persistent", 5, marks=pytest.mark.slow),
])  # fmt: skip
def test_csma(mac, packet_slots):
    n = 50
    for per_slot in (0.1, 0.5):
        result = saturate(mac, n, packet_slots, 6000, p=per_slot / n)
        found = airtime.throughput(result)
        p = result.plan.params["p_q15"] / 32768
        assert close(found, forms.finite_csma_throughput(n, packet_slots, p))
        # Who tries by chance in each slot makes Poisson traffic of load a G = n p.
        exact = infinite.nonpersistent_throughput(n * p * packet_slots, packet_slots)
        assert close(found, exact)


@pytest.mark.parametrize("n", [2, 10, 40])
def test_splitting(n):
    result = saturate("tree", n, 5, 7000)
    steps = result.ended_us / result.plan.params["period_us"] / result.counts["completed"]
    assert close(steps, forms.tree_slots(n) / n)
    if n == 40:
        assert close(steps, infinite.TREE_SLOTS_PER_STATION)


@pytest.mark.parametrize("packet_slots", [5, 25])
def test_tdma(packet_slots):
    result = saturate("tdma", 7, packet_slots, 2100)
    assert airtime.throughput(result) == pytest.approx(forms.slotted_bound(packet_slots))
    assert analysis.order(result)[:7] == list(range(7))
    slow = airtime.throughput(saturate("tdma", 7, packet_slots, 2100, ta=2000))
    bound = forms.handover_bound(packet_slots, 2000 / SLOT_US, TAU_US / SLOT_US)
    assert slow == pytest.approx(bound)


def test_a_cable_breaks_collisions_off():
    result = run_baseline(CABLE, 5)
    stopped = result.rows[result.rows["code"] == REPORT_STOPPED]
    collided = result.rows[result.rows["code"] == REPORT_COLLISION]
    assert len(stopped) == len(collided) >= 5
    air = radio_air.air(result)
    short = air.end - air.start < 5 * SLOT_US
    assert short.sum() == len(stopped)
    assert ((air.end - air.start)[short] <= TAU_US).all()
    found = radio_air.groups(result)
    assert not found.collision[found.of[~short]].any()


def test_the_common_clock_outlasts_the_wrap_of_a_stations_own():
    # Clocks of stations have 30 bits, 1,074 s, and start anywhere.
    for mac in ("tdma", "slotted-aloha"):
        plan = baseline_plan(mac, 3, 5, duration_s=1200.0, p=0.3, wanted=0)
        moments = np.arange(100_000, 1_199_000_000, 3_000_017)
        plan.arrivals = [(moments + 1000 * i).tolist() for i in range(3)]
        result = simulate(plan, checks=False)
        assert result.counts["completed"] == result.counts["offers"] == 3 * len(moments)
        assert len(np.unique(result.sent["time"] % plan.params["period_us"])) == 1
