"""The slotted level: its arguments, its bookkeeping, and every baseline against its closed form."""

import numpy as np
import pytest

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.slotted import chance
from innervate.networks.radio.slotted import draws as draws
from innervate.networks.radio.slotted.drive import MACS, dcf_here
from innervate.networks.radio.slotted.model import jain, slotted
from innervate.networks.radio.slotted.recorder import COLLISIONS, DONE, POISSON, new_recorder
from tests.networks.radio import forms as infinite
from tests.networks.radio.forms import BIANCHI_BASIC, BIANCHI_RTS

WITHIN = 0.02


def saturated(mac, stations, packet_slots=5, **options):
    return slotted(mac, stations, packet_slots, "saturated", **options)


def disasters(mac, stations, packet_slots, count, **options):
    """Mean duration, in slots."""
    runs = [
        slotted(mac, stations, packet_slots, "disaster", seed=seed, **options)
        for seed in range(count)
    ]
    return np.mean([run.duration_slots for run in runs])


@pytest.mark.parametrize("reading", ["A", "B"])
@pytest.mark.parametrize("packet_slots", [5, 25])
def test_reservation_is_exact(packet_slots, reading):
    for n in range(1, 101):
        found = saturated("csma-cd-r", n, packet_slots, packets=20, reading=reading).throughput
        assert abs(found - forms.reserved_throughput(n, packet_slots, reading)) < 1e-9
        run = slotted("csma-cd-r", n, packet_slots, "disaster", reading=reading)
        assert run.duration_slots == forms.reserved_duration_slots(n, packet_slots, reading)


def test_reservation_serves_everybody_once_a_round_in_a_free_order():
    run = saturated("csma-cd-r", 4, packets=300, warmup=0)
    rounds = np.reshape(run.order, (300, 4))
    assert all(sorted(order) == [0, 1, 2, 3] for order in rounds.tolist())
    assert len({tuple(order) for order in rounds.tolist()}) == 24
    assert run.collisions == 300
    assert run.jain == run.jain_round == 1


def test_reservation_with_a_shorter_window_or_a_turnaround():
    assert saturated("csma-cd-r", 2, 25, window=2).throughput == pytest.approx(50 / 81)
    turned = saturated("csma-cd-r", 3, 5, turnaround_slots=9).throughput
    assert turned == pytest.approx(15 / (12 + 2 * 9 + 3 * (6 + 9)))


@pytest.mark.parametrize("load", [0.5, 1.0, 2.0])
def test_slotted_aloha(load):
    found = slotted("slotted-aloha", 0, 5, "poisson", packets=40_000, load=load).throughput
    assert found == pytest.approx(infinite.aloha_throughput(load), rel=WITHIN)


@pytest.mark.parametrize("stations", [2, 10, 50])
def test_finite_populations_that_send_by_chance(stations):
    packets = 40_000 // stations
    found = saturated("slotted-aloha", stations, packets=packets).throughput
    exact = forms.finite_aloha_throughput(stations, 1 / stations)
    assert found == pytest.approx(exact, rel=WITHIN)
    exact = forms.finite_csma_throughput(stations, 25, 0.5 / stations)
    for mac in ("nonpersistent", "p-persistent"):
        found = saturated(mac, stations, 25, packets=packets, p=0.5 / stations).throughput
        assert found == pytest.approx(exact, rel=WITHIN)


@pytest.mark.parametrize("packet_slots", [5, 25, 100])
def test_csma_of_infinite_populations(packet_slots):
    for load in (0.5, 2, 8):
        run = slotted("nonpersistent", 0, packet_slots, "poisson", packets=30_000, load=load)
        exact = infinite.nonpersistent_throughput(load, packet_slots)
        assert run.throughput == pytest.approx(exact, rel=WITHIN)
    for load, p in ((0.5, 0.1), (2, 0.1), (1, 1.0), (5, 0.03)):
        run = slotted("p-persistent", 0, packet_slots, "poisson", packets=30_000, load=load, p=p)
        exact = infinite.p_persistent_throughput(load, packet_slots, p)
        assert run.throughput == pytest.approx(exact, rel=WITHIN)


@pytest.mark.parametrize("stations", [2, 5, 10, 30, 50])
@pytest.mark.parametrize(
    "dcf", [BIANCHI_BASIC, BIANCHI_RTS, dcf_here(5), dcf_here(25)], ids=["basic", "rts", "5", "25"]
)
def test_dcf_agrees_with_bianchi(dcf, stations):
    found = saturated("dcf", stations, dcf=dcf, packets=60_000 // stations).throughput
    exact = forms.dcf_throughput(
        stations, dcf.window, dcf.stages, payload=dcf.payload_us / dcf.slot_us,
        success=dcf.success_us / dcf.slot_us, collision=dcf.collision_us / dcf.slot_us,
    )  # fmt: skip
    assert found == pytest.approx(exact, rel=WITHIN)


def test_bianchis_table_2():
    # His T_s and T_c from the table's lengths in bits = us, SIFS 28, DIFS 128, delay 1.
    header, payload, answer, request = 128 + 272, 8184, 128 + 112, 128 + 160
    success = header + payload + 28 + 1 + answer + 128 + 1
    assert success == BIANCHI_BASIC.success_us
    assert header + payload + 128 + 1 == BIANCHI_BASIC.collision_us
    assert request + 28 + 1 + answer + 28 + 1 + success == BIANCHI_RTS.success_us
    assert request + 128 + 1 == BIANCHI_RTS.collision_us


@pytest.mark.parametrize("stations", [1, 2, 3, 10, 100])
def test_tree_splitting(stations):
    found = saturated("tree", stations, packets=40_000 // stations).throughput
    assert found == pytest.approx(forms.tree_throughput(stations), rel=WITHIN)


@pytest.mark.parametrize("packet_slots", [5, 25])
def test_tdma(packet_slots):
    run = saturated("tdma", 7, packet_slots)
    assert run.throughput == pytest.approx(forms.slotted_bound(packet_slots), abs=1e-12)
    assert run.order[:7] == list(range(7))
    assert slotted("tdma", 7, 5, "disaster").order == list(range(7))


@pytest.mark.parametrize("backoff", ["binary", "linear"])
@pytest.mark.parametrize("packet_slots", [5, 25])
def test_backoff_of_two_stations(packet_slots, backoff):
    for mac, cost in (("csma-cd-d1", 1), ("csma-cd-d2", packet_slots + 1)):
        found = disasters(mac, 2, packet_slots, 2500, backoff=backoff)
        exact = forms.pair_duration_slots(packet_slots, cost, backoff == "linear")
        assert found == pytest.approx(exact, rel=WITHIN)


def test_one_station_alone_is_never_disturbed():
    for mac in ("csma-cd-r", "csma-cd-d1", "csma-cd-d2", "tdma"):
        run = saturated(mac, 1, packets=50)
        assert run.throughput == pytest.approx(5 / 6)
        assert (run.collisions, run.jain) == (0, 1)


def test_a_turnaround_costs_csma_cd_two_switches_a_packet_or_one():
    alone = {"packets": 50, "turnaround_slots": 9.5}
    assert saturated("csma-cd-d2", 1, **alone).throughput == pytest.approx(5 / 24)
    free = saturated("csma-cd-d2", 1, return_slots=0, **alone)
    assert free.throughput == pytest.approx(5 / 15.5)


def test_backoff_slots_longer_than_the_turnaround_keep_stations_apart():
    near, far = (
        saturated("csma-cd-d2", 10, turnaround_slots=2000 / 208, backoff_slots=slots).throughput
        for slots in (1, 11)
    )
    assert far > 1.5 * near


@pytest.mark.parametrize("mac", sorted(MACS))
def test_poisson_traffic_below_capacity_is_carried(mac):
    p = {"p": 0.05} if mac in ("slotted-aloha", "nonpersistent", "p-persistent") else {}
    run = slotted(mac, 10, 25, "poisson", packets=2000, load=0.15, **p)
    assert run.throughput == pytest.approx(0.15, rel=0.04)
    assert run.jain > 0.95
    assert run.delay_slots.min() >= 25


@pytest.mark.parametrize("mac", sorted(MACS))
def test_a_disaster_ends_with_everybody_served(mac):
    run = slotted(mac, 8, 5, "disaster")
    assert sorted(run.order) == list(range(8))
    assert run.successes == [1] * 8
    assert run.duration_slots == max(run.delay_slots)
    assert run.airtime_slots == 40


def test_of_a_disaster_all_is_measured():
    run = slotted("tdma", 20, 5, "disaster", warmup=0.5, packets=7, plain=True)
    assert run.order == list(range(20))


def test_streams_of_one_seed_differ_by_name_and_never_begin_with_0():
    one, same, other = (draws.generator(3, name).tolist() for name in ("a", "a", "b"))
    assert one == same != other
    drawn = np.array([draws.generator(seed, "a") for seed in range(200)])
    assert drawn.min() >= 1
    assert drawn.max() <= draws.UNIT


def test_warm_up_is_not_measured():
    whole = saturated("csma-cd-d2", 3, packets=100, warmup=0)
    later = saturated("csma-cd-d2", 3, packets=100)
    assert whole.order[30:] == later.order
    assert whole.duration_slots == later.duration_slots
    assert sum(later.successes) == len(later.order) == 270
    assert later.airtime_slots == 270 * 5
    assert later.throughput == later.airtime_slots / later.elapsed_slots
    assert later.collisions <= whole.collisions


def test_streams_differ_by_seed_and_repeat_with_it():
    one, again, other = (saturated("csma-cd-d2", 5, packets=50, seed=s) for s in (7, 7, 8))
    assert one.order == again.order
    assert one.order != other.order


def test_numbers_of_one_seed_stay_what_they_are():
    run = saturated("csma-cd-d2", 5, packets=1000)
    assert (run.collisions, run.elapsed_slots) == (231, 28513)
    assert run.successes == [2537, 832, 0, 0, 1131]  # capture: two stations got nothing


def test_jain():
    assert jain([1, 1, 1]) == 1
    assert jain([5, 0, 0, 0, 0]) == pytest.approx(0.2)
    assert jain([0, 0]) == 1


def test_exponential_intervals():
    state = draws.generator(1, "test")
    sample = np.array([draws.exponential(state, 1000) for _ in range(20_000)])
    assert sample.mean() == pytest.approx(1000, rel=0.03)
    assert sample.std() == pytest.approx(1000, rel=0.03)
    assert (sample > 2000).mean() == pytest.approx(np.exp(-2), rel=0.05)


def test_intervals_are_in_steps_of_a_millionth_of_the_mean():
    steps = draws.RANGE // draws.COARSE
    assert 1_000_000 < steps < 1_100_000
    state, one = draws.generator(1, "test"), np.array([1, 2], np.int64)
    apart = np.diff(np.sort([draws.exponential(state, steps) for _ in range(2_000)]))
    assert apart[apart > 0].min() < 20
    draws.exponential(one, draws.MEAN_MAX)  # in 64 bits
    assert draws.MEAN_MAX * steps * 2 > 1 << 62 > draws.MEAN_MAX * (steps - 1)


def test_a_table_that_ends_early_gives_its_last_place():
    state = draws.generator(1, "test")
    assert {draws.choose(state, [0, 0, 0]) for _ in range(5)} == {2}


def test_the_generator_is_lecuyers():
    state = np.array([1, 2], np.int64)
    assert draws.step(state) == 2147483562 - (2 * 40692 - 40014)
    assert state.tolist() == [40014, 2 * 40692]
    assert draws.step(state) == (40014**2 % 2147483563 - 2 * 40692**2 % 2147483399) % 2147483562


ALWAYS = [[draws.UNIT], [0, draws.UNIT], [0, 0, draws.UNIT]]  # so many come, whatever is drawn


def of_a_pool(play, *arguments):
    """A recorder of eight packets, after an infinite population was played plain."""
    recorder = new_recorder(POISSON, 1, 8, draws.generator(1, "pool"))
    play(recorder, *arguments)
    return recorder


def test_who_comes_alone_gets_through_and_all_others_collide():
    alone = of_a_pool(chance.pool, ALWAYS[1], 10, 50, 10)
    assert alone.end.tolist() == [60 * k + 50 for k in range(8)]
    for play, *given in ((chance.pool, ALWAYS[2], 10, 50, 10),
                         (chance.persist, ALWAYS[2], ALWAYS[0], draws.UNIT, 10, 50)):  # fmt: skip
        together = of_a_pool(play, *given)
        assert together.counts[[DONE, COLLISIONS]].tolist() == [0, 8 * chance.STEPS_PER_PACKET]


def test_of_a_finite_population_whoever_has_a_packet_sends_it():
    recorder = new_recorder(POISSON, 3, 1, draws.generator(1, "three"))
    recorder.arrivals[:] = recorder.offer[:] = [900, 7, 300]
    chance.attempt(recorder, draws.UNIT, 10, 50, 10)
    assert (recorder.station[0], recorder.offered[0], recorder.end[0]) == (1, 7, 60)


def test_who_waits_sends_in_the_next_slot_that_the_draw_allows():
    at_once = of_a_pool(chance.persist, ALWAYS[0], ALWAYS[1], draws.UNIT, 10, 50)
    assert at_once.end.tolist() == [60 * k + 50 for k in range(8)]
    after_a_slot = of_a_pool(chance.persist, ALWAYS[1], ALWAYS[0], draws.UNIT, 10, 50)
    assert after_a_slot.end.tolist() == [70 * k + 60 for k in range(8)]
    half = of_a_pool(chance.persist, ALWAYS[0], ALWAYS[1], draws.UNIT // 2, 10, 50)
    waited = (np.diff(half.end) - 60) / 10
    assert set(waited) <= set(range(10))
    assert waited.sum() > 0


@pytest.mark.parametrize(
    ("arguments", "named", "word"),
    [
        (("csma", 2, 5, "saturated"), {}, "mac"),
        (("tdma", 2, 5, "bursts"), {}, "traffic"),
        (("tdma", 0, 5, "saturated"), {}, "stations"),
        (("tdma", -1, 5, "saturated"), {}, "stations"),
        (("slotted-aloha", 0, 5, "saturated"), {}, "stations"),
        (("tdma", 10_001, 5, "disaster"), {}, "stations"),
        (("tdma", 2, 0, "saturated"), {}, "packet_slots"),
        (("tdma", 2, 10_001, "saturated"), {}, "packet_slots"),
        (("tdma", 2, 5, "saturated"), {"packets": 0}, "packets"),
        (("tdma", 2, 5, "saturated"), {"warmup": 1}, "warmup"),
        (("tdma", 2, 5, "saturated"), {"seed": -1}, "seed"),
        (("tdma", 2, 5, "saturated"), {"load": 0.5}, "load"),
        (("tdma", 2, 5, "poisson"), {}, "load"),
        (("tdma", 2, 5, "poisson"), {"load": 51}, "load"),
        (("tdma", 2, 5, "poisson"), {"load": 1e-300}, "too long"),
        (("tdma", 2, 5, "saturated"), {"reading": "A"}, "no use for reading"),
        (("tdma", 2, 5, "saturated"), {"colour": 1}, "colour"),
        (("csma-cd-d1", 2, 5, "saturated"), {"turnaround_slots": 1}, "turnaround_slots"),
        (("csma-cd-d2", 2, 5, "saturated"), {"return_slots": -1}, "return_slots"),
        (("csma-cd-d2", 2, 5, "saturated"), {"backoff": "cubic"}, "backoff"),
        (("csma-cd-d2", 2, 5, "saturated"), {"backoff_slots": 0}, "backoff_slots"),
        (("csma-cd-r", 2, 5, "saturated"), {"reading": "C"}, "reading"),
        (("csma-cd-r", 2, 5, "saturated"), {"window": -1}, "window"),
        (("p-persistent", 2, 5, "saturated"), {"p": 0}, "probability"),
        (("nonpersistent", 0, 5, "poisson"), {"p": 0.1, "load": 1}, "infinite"),
    ],
)
def test_what_is_refused(arguments, named, word):
    with pytest.raises(ValueError, match=word):
        slotted(*arguments, **named)
