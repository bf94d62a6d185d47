"""What is kept of any network on a channel, and how a declared one is told of it: by hand."""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.dialect.access import PACKET
from innervate.dialect.arith import MASK30
from innervate.sim import taps
from innervate.sim.came import Came
from innervate.sim.channel import declared, listening
from innervate.sim.channel.declared import DeclaredChannel
from innervate.sim.counts import Counts
from innervate.sim.heap import AIR_BITS
from innervate.sim.heard import (
    ARRIVED,
    BROKEN_OFF,
    COLLIDED,
    COUNTERS,
    DELIVERED,
    NOISY,
    OFF,
    SENDING,
    SENT,
)
from innervate.sim.own import Unfit, frames_of
from innervate.sim.recorded import Recorded
from innervate.sim.tables import DELIVERY, get, row_dtype
from tests.networks.radio.runs import radio_plan

HANDLERS = ("on_start", "on_frame", "on_timer", "on_input", "on_carrier")
HEARD = {"alive": 1, "deaf": 0, "spoilt": 0, "clear": True}


def world_of(**more):
    run = {"checks": 1, "broken": 0, "broken_node": -1, "packets": 1, "packet_limit": 9, "taps": 0,
           "tap_limit": 9, "ta_us": 30}  # fmt: skip
    radio = Of(alive=1, deaf=0, offset=100, next_offer=5, backlog=2)
    return Of(
        run=[Of(**run | more)],
        above=Of(counters=[0] * COUNTERS, items=None, kinds=None, came=Came([], [])),
        radios=[radio, Of(**vars(radio))], packets=[Of() for _ in range(4)],
        words=[[5, 5], [5, 9]], low=[0, 0], high=[8, 8], degree=[3, 2],
        taps=[Of() for _ in range(4)], tapped=[Of() for _ in range(4)],
        air=[Of(start=60, spoilt=0) for _ in range(16)], frames=[Of(seq=k) for k in range(16)],
    )  # fmt: skip


@pytest.mark.parametrize(("state", "word", "why"), [
    ({"received": True}, ARRIVED, taps.FINE),
    ({"alive": 0, "deaf": 1, "clear": False}, OFF, taps.COLLISION),
    ({"deaf": 1, "clear": False, "spoilt": 1}, SENDING, taps.SENDING),
    ({"clear": False, "spoilt": 1}, COLLIDED, taps.COLLISION),
    ({"spoilt": 1}, BROKEN_OFF, taps.SPOILT), ({}, NOISY, taps.NOISE),
])  # fmt: skip
def test_what_became_of_a_frame_is_counted_once_by_what_comes_first(state, word, why):
    world, how = world_of(), HEARD | {"received": False} | state
    world.radios[1].alive, world.radios[1].deaf = how["alive"], how["deaf"]
    world.air[3].spoilt = how["spoilt"]
    assert listening.why(world, 1, 3, how["clear"], how["received"]) == why
    assert [k for k, count in enumerate(world.above.counters) if count] == [word]
    assert world.above.counters[word] == 1


def test_a_delivery_has_its_row_if_rows_are_kept():
    world = world_of()
    listening.keep(world, 1, 5, 900, 70)
    row = {"time": 900, "node": 1, "port": 0, "kind": 5, "latency": 70}
    assert vars(world.packets[1]) == row
    world.run[0].packet_limit = 0
    listening.keep(world, 1, 5, 900, 70)
    assert (world.run[0].packets, world.above.counters[DELIVERED]) == (2, 2)


@pytest.mark.parametrize(("node", "run", "found"), [
    (0, {}, (0, -1)), (1, {}, (listening.BROKEN_RANGE, 1)), (1, {"checks": 0}, (0, -1)),
    (1, {"broken": 2}, (2, -1)),
])  # fmt: skip
def test_a_value_out_of_range_breaks_a_run_that_is_checked_once(node, run, found):
    world = world_of(**run)
    listening.check_range(world, node)
    assert (world.run[0].broken, world.run[0].broken_node) == found


# A declared network.


def copy(to, frame):
    to.seq = frame.seq


def kind_of(frame):
    return 40 + frame.seq


def made_of(is_timed):
    fields = (("seq", 0, 0, 255, "", ""), ("made_at", 0, 0, MASK30, "us", ""))
    return frames_of(fields[: 1 + is_timed]) | {"copy_frame": copy, "kind_of": kind_of}


@pytest.mark.parametrize("limit", [0, 9])
def test_a_frame_counts_for_all_who_could_hear_it_and_is_kept_with_its_start(limit):
    do, world = Of(**declared._noted(**made_of(False))), world_of(tap_limit=limit)
    do.record_sent(world, 0, Of(seq=7), 1_000)
    do.record_received(world, 1, (1 << AIR_BITS) | 2, 1_200, True, False)
    world.radios[1].alive = 0
    do.record_received(world, 1, 3, 1_300, True, False)
    assert (world.above.counters[SENT], world.above.counters[OFF]) == (3, 1)
    rows = [vars(row) for row in world.taps[: world.run[0].taps]]
    assert rows == [] if limit == 0 else rows == [
        {"time": 1_030, "start": 1_030, "at": 0, "sender": 0, "out": 1, "why": taps.FINE},
        {"time": 1_200, "start": 60, "at": 1, "sender": 1, "out": 0, "why": taps.NOISE},
    ]  # fmt: skip
    assert [vars(one) for one in world.tapped[:2]] == (
        [{"seq": 7}, {"seq": (1 << AIR_BITS) | 2}] if limit else [{}, {}])  # fmt: skip


@pytest.mark.parametrize(("is_timed", "made_at", "time", "latency"), [
    (False, 60, 90, -1), (True, 60, 90, 30), (True, 0, 90, -1), (True, 5, MASK30 + 26, 20),
    (True, 1, 1, 0),
])  # fmt: skip
def test_a_delivery_took_as_long_as_since_it_was_handed_in(is_timed, made_at, time, latency):
    do, world = Of(**declared._noted(**made_of(is_timed))), world_of()
    do.note_received(world, 1, Of(seq=2, made_at=made_at), time)
    assert (world.packets[1].kind, world.packets[1].latency) == (42, latency)


@pytest.mark.parametrize(("is_timed", "at", "made_at"), [
    (False, 70, 9), (True, 70, 70), (True, 0, 1), (True, MASK30 + 1, 1), (True, MASK30 + 71, 70),
])  # fmt: skip
def test_what_a_node_is_handed_is_the_oldest_that_waits(is_timed, at, made_at):
    given = []
    protocol = Of(**dict.fromkeys(HANDLERS, print))
    protocol.on_input = lambda _node, _params, now, kind, item, _out: given.append(
        (now, kind, item.seq))  # fmt: skip
    do = Of(**declared._entries(protocol, lambda world, node: None, **made_of(is_timed)))
    world = world_of()
    world.above.items = [Of(seq=10 + k) for k in range(6)]
    world.above.kinds = [20 + k for k in range(6)]
    world.arrivals, world.item = [0, 0, 0, at, 99, 99], [Of(seq=0, made_at=9)]
    world.stations, world.params, world.out = [None, None], [None], None
    do.on_input(world, 1, 500, PACKET)
    assert given == [(500, 23, 13)]  # five have come, two of them wait: the fourth
    assert (world.radios[1].backlog, world.item[0].made_at) == (1, made_at)
    do.on_input(world, 1, 600, 77)
    assert given[1:] == []  # what a channel's devices tell is nothing for a network of one's own
    assert world.radios[1].backlog == 1


def network_of(timers=2, fields=("kind", "slots")):
    frame = tuple((name, 0, 0, 9, "", "") for name in fields)
    protocol = Of(__name__="talk", TIMERS=timers, **dict.fromkeys(HANDLERS, print))
    return Of(protocol=protocol, fields=Of(FRAME=frame), name="talk", has=lambda _: False)


@pytest.mark.parametrize(("given", "says"), [
    ({}, None), ({"timers": 3}, "at most 2 timers, not 3"),
    ({"fields": ("kind",)}, "no field slots"),
])  # fmt: skip
def test_what_a_channel_cannot_do_is_said(monkeypatch, given, says):
    monkeypatch.setattr(declared, "invariants_of", lambda *_: {})
    if says is None:
        assert callable(declared.functions(network_of(**given)).watch)
    else:
        with pytest.raises(Unfit, match=says):
            declared.functions(network_of(**given))


def test_after_a_call_ranges_are_checked_before_own_invariants_by_the_nodes_clock():
    seen = []

    def holds(state, params, now):
        seen.append(now)
        return False

    watch = declared._watching([holds])["watch"]
    world = world_of(trail_limit=0)
    world.stations, world.params = [None, None], [None]
    watch(world, 0, MASK30, 1, 2)
    assert (seen, world.run[0].broken) == ([99], 64)
    other = world_of(trail_limit=0)
    other.stations, other.params = [None, None], [None]
    watch(other, 1, 70, 1, 2)
    assert (other.run[0].broken, len(seen)) == (listening.BROKEN_RANGE, 1)


# From outside.


def bare(**run):
    numbers = np.zeros(1, [(name, np.int64) for name in (
        "rows", "packets", "trail", "status", "checks", "broken", "broken_node", "broken_at", "now",
        "offers")])  # fmt: skip
    for name, value in run.items():
        numbers[name] = value
    radios = np.zeros(4, [("alive", np.int64), ("leaving", np.int64)])
    radios["alive"], radios["leaving"] = (1, 0, 1, 0), (1, 0, 0, 1)
    counters = np.arange(3, 3 + 7 * COUNTERS, 7)
    world = Of(run=numbers, radios=radios, above=Of(counters=counters, came=Came([], [])))
    return DeclaredChannel(Of(stations=3, seed=8, kind="talk"), world, None)


def test_frames_and_messages_are_counted_by_name():
    running = bare(now=70)
    running.message_times = [0, 70, 70, 71]
    assert running.counts() == Counts(
        nodes=3, off=(1,), sent=3, arrived=10, offered=3, delivered=52,
        lost_by={"collision": 17, "sending": 24, "noise": 31, "off": 38, "broken_off": 45},
        is_shared=True,
    )  # fmt: skip


@pytest.mark.parametrize(("at", "words"), [(-1, "0.000000"), (70, "0.000070")])
def test_what_broke_is_told_with_when_and_by_whom(at, words):
    said = bare(broken=listening.BROKEN_RANGE, broken_node=2, broken_at=at).broken_line()
    what = "a value of node 2 is out of its declared range"
    assert said == f"invariant broken at {words} s (seed 8): {what}"


def test_packets_that_were_handed_up_are_deliveries():
    running = bare()
    packets = np.array([(900, 1, 0, 5, 70), (950, 2, 0, 6, -1)], row_dtype(DELIVERY))
    running.world.rows = running.world.trail = running.world.packets = packets[:0]
    running._kept["packets"].append(packets)
    found = running.take()
    assert set(found) == {"rows", "trail", "deliveries"}
    assert found["deliveries"].tolist() == [(900, 1, 0, 5, 70), (950, 2, 0, 6, -1)]


@pytest.mark.parametrize("plain", [True, False])
def test_what_users_give_stands_in_its_order_and_the_mediums_own_fields_behind(monkeypatch, plain):
    own = (("kind", 0, 0, 9, "", ""), ("seq", 0, 0, 255, "", ""), ("slots", 0, 0, 9, "", ""))
    fields = Of(STATE=own[:1], FRAME=own, PARAMS=())
    monkeypatch.setattr(declared, "networks", lambda: {"radio": Of(fields=fields, protocol=Of())})
    plan = radio_plan(3)
    inputs = [Of(kind=6, at_us=70, item={"seq": 8, "slots": 2}),
              Of(kind=5, at_us=70, item={"seq": 9})]  # fmt: skip

    class Plan:
        def __getattr__(self, name):
            return inputs if name == "inputs" else getattr(plan, name)

    world = declared.world_of(Plan(), plain, Recorded())
    assert [int(get(world.above.items, i, "seq")) for i in range(3)] == [8, 9, 0]
    assert [int(kind) for kind in world.above.kinds] == [6, 5, 0]
    assert int(get(world.above.items, 0, "slots")) == 2
    assert [list(map(int, column)) for column in world.above.came] == [[70], [0]]
    assert (int(get(world.frames, 0, "count")), int(get(world.item, 0, "ago"))) == (0, 0)
    assert int(get(world.stations, 2, "queued")) == 0
    twice = declared.extended((("count", 0, 1, 5, "", "own"),), declared.OF_FRAME)
    assert [(name, what) for name, *_, what in twice] == [("count", "own"), ("handle", "not used")]
