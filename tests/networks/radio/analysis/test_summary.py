from types import SimpleNamespace

import numpy as np
import pytest

import innervate
from innervate.dialect.access import REPORT_LEFT
from innervate.networks.radio.analysis import air, airtime
from innervate.networks.radio.analysis import air as radio_air
from innervate.networks.radio.analysis import airtime as radio_airtime
from innervate.networks.radio.analysis import packets as radio_packets
from innervate.networks.radio.analysis import summary as radio
from innervate.networks.radio.plot.words import off_words
from innervate.networks.radio.protocol.constants import CRR, DATA, OPEN, REPORT_BOUNDS
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.networks.radio.show import summary_lines
from innervate.networks.radio.sim.build import build
from innervate.networks.radio.sim.simulate import COUNTS
from innervate.plot import report
from innervate.scenario.actions.channel import FADE, GARBLE, JOIN, KILL, LEAVE
from innervate.sim.channel import world as w
from innervate.sim.channel.loop import ON_CARRIER
from innervate.sim.tables import ROW, put
from tests.networks.radio.runs import radio_plan, run

SLOT = 208


def table(fields, *rows):
    """Rows as a structured array; what a row leaves out at its end is 0."""
    width = len(fields)
    full = [(*row, *[0] * (width - len(row))) for row in rows]
    return np.array(full, [(name, np.int64) for name in fields])


def packet(offered_us, end_us, node, slots=5, receivers=1):
    return (offered_us, end_us, end_us, node, 0, slots, receivers, 1, 1)


def made(packets=(), sent=(), rows=(), ended_us=100_000, **plan):
    """A result as if it had been simulated: 5-slot packets, delays of 52 us unless said."""
    n = plan.pop("stations", 2)
    plan = radio_plan(n, packet_slots=5, real=(52, 52), **plan)
    return SimpleNamespace(
        plan=plan,
        world=build(plan, plain=True, checks=False, observe=False),
        packets=table(w.PACKET, *packets),
        sent=table(w.SENT, *sent),
        rows=table(ROW, *rows),
        counts=dict.fromkeys(COUNTS, 0)
        | {"handled": 7, "decoded": 3, "silent": 1, "completed": len(packets)},
        ended_us=ended_us,
        wall_s=0.5,
        fingerprint="0" * 16,
        interrupted=False,
    )


def test_a_disaster_by_hand():
    # Offered at 0 and 104 us; station 1 first, then station 0, 10 slots after the first offer.
    packets = [packet(0, 10 * SLOT, 0), packet(SLOT // 2, 5 * SLOT, 1), packet(0, 1, 0, 5, 0)]
    summary = radio.summarize(made(packets, arrivals=[[0], [104]]), "by hand")
    assert summary["name"] == "by hand"
    assert summary["traffic"] == "disaster"
    assert summary["events"] == 10
    assert summary["events_per_s"] == 20
    assert summary["throughput"] == 1.0  # 2 packets of 5 slots in 10 slots
    assert summary["duration_slots"] == 10
    assert summary["order"] == [1, 0]
    assert summary["delivered"] == 2
    assert summary["lost_silently"] == 1
    assert summary["jain"] == summary["jain_round"] == 1.0
    assert summary["delay_slots"] == {"p50": 7.25, "p95": 9.725, "p99": 9.945, "max": 10.0}
    assert summary["fifo"] == 0.0


def test_the_first_are_told_in_order_of_success(monkeypatch):
    """All of them only in a disaster, where each offers once or so."""
    monkeypatch.setattr(radio, "ORDER_MAX", 3)
    packets = [packet(0, (k + 1) * 10 * SLOT, k // 2 % 2) for k in range(5)]
    assert radio.order(made(packets, traffic="saturated")) == [0, 0, 1]
    assert radio.order(made(packets, arrivals=[[0], [0]])) == [0, 0, 1, 1, 0]


def test_a_team_stands_still_since_its_newest_success():
    """Ended at 100 ms; a packet of station 1 still waits since the beginning."""
    packets = [packet(0, 30_000, 0), packet(0, 70_000, 0), packet(0, 90_000, 0, receivers=0)]
    for there, still_ms in ((packets, 30.0), ([], 100.0)):
        result = made(there)
        for one in result.world.radios:
            one.alive = 1
        result.world.radios[1].backlog = result.world.radios[1].fresh = 1
        assert radio.facts(result).still_ms == still_ms


def test_nothing_ever_happened():
    summary = radio.summarize(made())
    for key in ("throughput", "duration_slots", "jain", "jain_round", "fifo"):
        assert summary[key] is None
    assert summary["delay_slots"] == dict.fromkeys(("p50", "p95", "p99", "max"))
    assert summary["order"] == []
    assert summary["collisions"] == 0
    assert summary["bounds_noticed"] == {"count": 0, "stations": []}
    assert airtime.airtime_steps(made()).values.max() == 0


def test_saturation_leaves_out_the_first_tenth():
    # 20 packets of 5 slots: the first two end at 1,000 and 2,000 slots, then one in 10 slots.
    ends = [1000, 2000, *range(2010, 2190, 10)]
    packets = [packet(0, end * SLOT, i % 2) for i, end in enumerate(ends)]
    result = made(packets, traffic="saturated")
    assert len(radio_packets.settled(result)) == 18
    assert airtime.throughput(result) == pytest.approx(0.5)
    assert radio.delays(result)[0] == 2010


@pytest.mark.parametrize(
    ("counts", "index"), [([3, 3, 3], 1.0), ([1, 0, 0, 0], 0.25), ([2, 1], 0.9), ([0, 0], None)]
)
def test_jain(counts, index):
    assert radio.jain(counts) == (None if index is None else pytest.approx(index))


def test_jain_over_rounds_counts_turns_not_packets():
    # Turns 0 1 | 1 1 | 0: two whole rounds of two, 1 and 1/2; the third turn has two packets.
    ends = [(5, 0), (10, 1), (20, 1), (20, 1), (25, 1), (30, 0)]
    packets = [packet(0, end * SLOT, node) for end, node in ends]
    result = made(packets, arrivals=[[0, 0], [0]])
    assert radio.jain_round(result) == pytest.approx(0.75)


def test_fifo_counts_only_those_that_waited_together():
    # Station 1 waited longer than 0 but came second; 0's next packet was offered after that.
    packets = [packet(100, 3000, 0), packet(50, 6000, 1), packet(7000, 9000, 0)]
    assert radio.fifo(made(packets, arrivals=[[100, 7000], [50]])) == 0.0
    # Of equal offers neither is first.
    assert radio.fifo(made([packet(0, 3000, 0), packet(0, 6000, 1)])) is None
    assert radio.fifo(made([packet(0, 3000, 1), packet(9, 6000, 0)])) == 1.0


def sent(start, end, node, kind=DATA):
    return (start, end, node, kind, (end - start) // SLOT)


def test_collisions_are_groups_with_a_packet_in_them():
    on_air = [
        sent(0, 1000, 0), sent(500, 1500, 1), sent(1400, 1600, 0, CRR),  # one chain of three
        sent(1600, 1700, 1),  # touches only
        sent(2000, 2208, 0, CRR), sent(2100, 2308, 1, CRR),  # CR-Rs among themselves
        sent(3000, 3416, 0, OPEN), sent(3100, 3308, 1, CRR),
    ]  # fmt: skip
    found = air.groups(made(sent=on_air))
    assert found.members.tolist() == [3, 1, 2, 2]
    assert found.collision.tolist() == [True, False, False, True]
    assert found.start.tolist() == [0, 1600, 2000, 3000]
    assert found.end.tolist() == [1600, 1700, 2308, 3416]
    assert radio.summarize(made(sent=on_air))["collisions"] == 2


def test_measured_delays():
    rows = [
        (0, 0, REPORT_BOUNDS, 20, 0), (0, 1, REPORT_BOUNDS, 130, 1), (0, 1, REPORT_BOUNDS, 120, 2),
    ]  # fmt: skip
    found = radio.bounds_noticed(made(rows=rows))
    assert found["count"] == 3
    assert found["stations"] == [
        {"station": 0, "count": 1, "delay_us": {"min": 20.0, "max": 20.0}},
        {"station": 1, "count": 2, "delay_us": {"min": 120.0, "max": 130.0}},
    ]


def test_throughput_over_time():
    # A frame of two packets from 0 to 10 slots, one of a single packet from 15 to 20.
    packets = [packet(0, 10 * SLOT, 0), packet(0, 10 * SLOT, 0), packet(0, 20 * SLOT, 1)]
    steps = airtime.airtime_steps(made(packets), 4, 0, 20 * SLOT)
    assert steps.values == pytest.approx([1, 1, 0, 1])
    assert steps.time_us.tolist() == [0, 5 * SLOT, 10 * SLOT, 15 * SLOT]
    assert radio_airtime._spans(made(packets), made(packets).packets)[0].tolist() == [0, 1040, 3120]


def test_signals_by_hand():
    # 0 sends 0-1000, 1 sends 400-800: 2 hears both after 52 us; the senders hear what is left.
    result = made(sent=[sent(0, 1000, 0), sent(400, 800, 1)], stations=3)
    first, second, third = air.signals(result, -10, 2000)
    assert first.deaf.tolist() == [[0, 1000]]
    assert first.cd.tolist() == []
    assert second.cd.tolist() == second.voc.tolist() == [[52, 400], [800, 1052]]
    assert third.cd.tolist() == [[52, 1052]]
    assert third.voc.tolist() == [[52, 452], [852, 1052]]
    assert third.deaf.tolist() == third.off.tolist() == []
    assert air.signals(result, 500, 600)[2].cd.tolist() == [[500, 600]]


def test_signals_with_a_turnaround_faults_and_hidden_stations():
    faults = [RadioFault(500, KILL, 0, 0, 0), RadioFault(5000, JOIN, 0, 0, 1)]
    result = made(sent=[sent(100, 1140, 0)], stations=3, ta=100, faults=faults)
    result.plan.delays_us[0][2] = -1
    first, second, third = air.signals(result, 0, 9000)
    assert first.deaf.tolist() == [[0, 1240]]
    assert first.off.tolist() == [[500, 5000]]
    assert second.cd.tolist() == [[152, 552]]  # it stopped when its sender died
    assert third.cd.tolist() == []


def test_signals_of_what_a_fade_hid():
    faults = [RadioFault(0, GARBLE, 0, 1, 0), RadioFault(0, FADE, 0, 1, 1)]
    on_air = [sent(at, at + SLOT, 0, CRR) for at in (1000, 2000, 3000)]
    heard = air.signals(made(sent=on_air, faults=faults), 0, 9000)[1]
    assert heard.cd.tolist() == [[1052, 1260], [3052, 3260]]


def test_who_left_is_off():
    result = made(rows=[(700, 1, REPORT_LEFT)], absent=[1, 0])
    off = radio_air.off_times(result)
    assert off[0].tolist() == [[0, radio_air.FOREVER]]
    assert off[1].tolist() == [[700, radio_air.FOREVER]]


def inside(spans, times):
    """Which of the times lie in one of the spans."""
    count = np.searchsorted(spans[:, 0], times, "right")
    return count - np.searchsorted(spans[:, 1], times, "right") > 0


FAULTS = [
    RadioFault(103_000, KILL, 2, 0, 0),
    RadioFault(107_000, GARBLE, 1, 2, 1),
    RadioFault(108_000, FADE, 3, 2, 2),
    RadioFault(160_000, JOIN, 2, 0, 3),
    RadioFault(300_000, LEAVE, 0, 0, 4),
]


@pytest.mark.parametrize(
    ("n", "options"),
    [
        (2, {}),
        (5, {"ta": 2000, "spread": 900}),
        (10, {"packet_slots": 5}),
        (7, {"real": (52, 400), "packet_slots": 5, "duration_s": 0.3}),
        (4, {"traffic": "saturated", "packets": 20}),
        (5, {"faults": FAULTS, "duration_s": 0.6, "traffic": "saturated", "packets": 1000}),
    ],
)
def test_signals_are_what_the_medium_told_the_stations(n, options):
    result = run(n, seed=3, plain=True, trail=True, **options)
    told = result.trail[result.trail["handler"] == ON_CARRIER]
    assert len(told) > 4
    compared = 0
    for station, heard in enumerate(air.signals(result, 0, result.ended_us + 1)):
        mine = told[told["node"] == station]
        # A station may decide to send in the moment in which it is told: deaf from there on.
        mine = mine[~inside(heard.deaf, mine["time"]) & ~inside(heard.off, mine["time"])]
        hears = 2 * inside(heard.cd, mine["time"]) + inside(heard.voc, mine["time"])
        assert hears.tolist() == mine["port"].tolist()
        # Nothing changes untold, but by deafness and while it is off.
        edges = np.unique(np.concatenate([heard.cd.ravel(), heard.voc.ravel()]))
        shut = np.concatenate([heard.deaf, heard.off])
        edges = edges[~np.isin(edges, shut.ravel()) & (edges < result.ended_us)]
        assert set(edges.tolist()) <= set(mine["time"].tolist())
        compared += len(mine)
    assert compared > 4


@pytest.mark.parametrize("packet_slots", [5, 25])
def test_a_disaster_as_simulated(packet_slots):
    result = run(10, packet_slots, spread=50)
    summary = radio.summarize(result)
    assert summary["delivered"] == summary["offered"] == 10
    assert sorted(summary["order"]) == list(range(10))
    assert summary["lost_silently"] == 0
    assert summary["collisions"] >= 1
    assert summary["throughput"] == pytest.approx(10 * packet_slots / summary["duration_slots"])
    last_us = int(result.packets["end"].max())
    first_us = min(at for (at,) in result.plan.arrivals)
    assert summary["duration_slots"] == pytest.approx((last_us - first_us) / SLOT)
    assert summary["delay_slots"]["max"] <= summary["duration_slots"]
    steps = airtime.airtime_steps(result, 100)
    assert np.mean(steps.values) == pytest.approx(summary["throughput"])


def test_saturation_as_simulated():
    summary = radio.summarize(run(4, 25, traffic="saturated", packets=100))
    assert 0.95 < summary["throughput"] < 25 / (25 + 52 / SLOT)
    assert summary["jain"] > 0.999
    assert summary["jain_round"] > 0.99
    assert len(summary["order"]) == 400
    assert summary["traffic"] == "saturated"


def test_time_switched_off_is_no_delay():
    # Station 0 is off from 20 to 60 slots; what it offered before or meanwhile has no delay.
    faults = [
        RadioFault(at_us=at * SLOT, action=action, node=0, value=0, index=i)
        for i, (at, action) in enumerate([(20, KILL), (60, JOIN)])
    ]
    packets = [
        packet(0, 20 * SLOT, 0),  # ended as it went off: it was on all the time
        packet(19 * SLOT, 70 * SLOT, 0),
        packet(30 * SLOT, 75 * SLOT, 0),
        packet(60 * SLOT, 80 * SLOT, 0),
        packet(10 * SLOT, 65 * SLOT, 1),
    ]
    result = made(packets, faults=faults, arrivals=[[0] * 4, [0]])
    assert sorted(radio.delays(result)) == [20, 20, 55]
    assert radio.summarize(result)["waited_off"] == 2
    assert radio.summarize(result)["delay_slots"]["max"] == 55


def test_throughput_counts_the_time_in_which_nothing_came_through():
    # Three of 195 packets are delivered in the first 20 slots of 1,000; then nothing any more.
    packets = [packet(0, end * SLOT, 0) for end in (5, 12, 20)]
    poisson = made(packets, ended_us=1000 * SLOT, arrivals=[[0] * 195, []], wanted=0)
    assert airtime.throughput(poisson) == pytest.approx(3 * 5 / 1000)
    assert airtime.airtime_steps(poisson, 50).values[1:].max() == 0
    stuck = made(packets, ended_us=1000 * SLOT, traffic="saturated", wanted=200)
    assert airtime.throughput(stuck) == pytest.approx(3 * 5 / 1000)


def test_throughput_ends_with_the_last_packet_that_was_wanted():
    packets = [packet(0, end * SLOT, end % 2) for end in (5, 20)]
    done = made(packets, ended_us=1000 * SLOT, traffic="saturated", wanted=2)
    assert airtime.throughput(done) == pytest.approx(2 * 5 / 20)
    # A disaster is over when nobody who is on waits any more, though who died had a packet.
    killed = [RadioFault(at_us=1, action=KILL, node=0, value=0, index=0)]
    over = made(packets[:1], ended_us=1000 * SLOT, faults=killed, arrivals=[[0], [0]], wanted=0)
    assert airtime.throughput(over) == 1.0
    put(over.world.radios, 1, alive=1, backlog=1)
    assert airtime.throughput(over) == pytest.approx(5 / 1000)


def test_packets_of_who_left_are_told_apart():
    arrivals = [[1000, 300_000], [2000], [3000, 200_000, 400_000]]
    left = [RadioFault(at_us=100_000, action=LEAVE, node=2, value=0, index=0)]
    summary = radio.summarize(
        run(3, packet_slots=5, plain=True, faults=left, arrivals=arrivals, wanted=0, duration_s=0.5)
    )
    assert [summary[key] for key in ("offered", "delivered", "pending", "abandoned")] == [
        6,
        4,
        0,
        2,
    ]
    assert off_words(summary)[0].startswith("Not counted: 2 packets of robots that were off or had")
    assert off_words(summary | {"abandoned": 0, "waited_off": 1}) == [
        "1 packet waited while its robot was off; delays leave them out."
    ]
    assert off_words(summary | {"abandoned": 0}) == []


@pytest.mark.parametrize(
    ("tables", "level", "warning"),
    [
        ({"stations": 1}, "down", "One station alone: nobody can receive what it sends."),
        ({"stations": 3, "channel": {"hidden": [[0, 2]]}}, "d",
         "Stations that do not hear each other (0 and 2): packets may collide unnoticed, stations "
         "may starve."),
        ({"stations": 1, "channel": {"level": "slotted"}}, "down",
         "One station alone: nobody can receive what it sends."),
        ({"stations": 3}, "ok", ""),
    ],
)  # fmt: skip
def test_summary_terminal_and_report_say_the_same(tables, level, warning):
    done = innervate.run({"kind": "radio", "duration_s": 0.4} | tables, plain=True)
    head = done.summary["headline"]
    assert head["level"].startswith(level)
    lines, page = summary_lines(done), report.render(done)
    assert f"{head['level']}: {head['text']}" in lines
    said = [line.split("(Jain) ")[1] for line in lines if "fairness (Jain)" in line]
    assert said == [f"{one:.3f}." for one in [done.summary["jain"]] if one is not None]
    assert f"<h1>{head['text']}</h1>" in page
    beginnings = ("One station alone", "Stations that do not hear")
    assert [line for line in lines if line.startswith(beginnings)] == [warning] * bool(warning)
    assert [text for text in beginnings if text in page] == [
        text for text in beginnings if warning.startswith(text)
    ]
