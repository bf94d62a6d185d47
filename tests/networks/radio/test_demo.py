"""What is said of a radio run on a terminal and in the demo, from values set by hand."""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.dialect.access import CLOCK, LEAVE, RESULT
from innervate.networks.radio import board, demo, run, show
from innervate.networks.radio.protocol.constants import MAIN
from innervate.sim.channel.loop import ON_CARRIER
from innervate.sim.status import ON_FRAME, ON_INPUT, ON_START, ON_TIMER


def test_the_demo_counts_from_the_first_offer():
    packets = {"offered": np.array([5000, 3000]), "end": np.array([7000, 15500])}
    found = demo.lines(Of(
        plan=Of(params={"packet_slots": 10, "slot_us": 200}, stations=3),
        result=Of(packets=packets), radio={"order": [2, 0, 1], "lost_silently": 0},
    ))  # fmt: skip
    assert found == [
        "     +4 ms   the first packet has arrived, everybody knows the order",
        "  +12.5 ms   all ten packets have arrived", "",
        "Order: 2, 0, 1. 0 packets lost without their sender knowing.",
        "The packets alone take 6 ms.",
    ]  # fmt: skip


SUMMARY = {
    "name": "team", "protocol": "cd", "wall_s": 0.126, "seed": 4, "delivered": 3,
    "duration_slots": 200, "delay_slots": {"p50": 8.5, "p99": 1.0, "max": 131.4},
    "throughput": 0.5, "jain": 0.25, "collisions": 1, "lost_silently": 2,
    "bounds_noticed": {"count": 0}, "headline": {"level": "good", "text": "all came."},
}  # fmt: skip
DELIVERED = "3 packets delivered, the last 200 slots (100.0 ms) after the first offer."
DELAY = ("Delay from offer to the end of the frame: half within 8.5 slots, 99 % within 1 slot, "
         "all within 131 slots.")  # fmt: skip
FILL, LOST = "Packets fill 50 % of the channel's time", "1 collision; 2 packets lost without the "
LOST += "sender knowing."


def told(monkeypatch, hidden=False, is_outside=False, **more):
    monkeypatch.setattr(show, "warnings", lambda plan: ["Beware."])
    monkeypatch.setattr(show, "outside", lambda model: is_outside)
    plan = Of(params={"slot_us": 500, "packet_slots": 9}, stations=3, pairs=Of(hidden=hidden),
              scenario=Of(model=None))  # fmt: skip
    summary = SUMMARY | more
    return Of(summary=summary, radio=summary, slotted=summary, plan=plan,
              result=Of(ended_us=1_234_567))  # fmt: skip


def test_the_first_line_says_what_ran_and_then_how_it_went(monkeypatch):
    assert show.summary_lines(told(monkeypatch)) == [
        "team: 3 stations on one channel, cd, packets of at most 9 slots; 1.235 s simulated in "
        "0.13 s, seed 4", "good: all came.", DELIVERED, "Beware.", DELAY,
        f"{FILL}; fairness (Jain) 0.250.", LOST,
    ]  # fmt: skip


@pytest.mark.parametrize(("more", "lines"), [
    ({"jain": None}, [DELIVERED, "Beware.", DELAY, f"{FILL}.", LOST]),
    ({"throughput": None}, [DELIVERED, "Beware.", DELAY, LOST]),
    ({"duration_slots": None, "throughput": None},
     ["3 packets delivered.", "Beware.", DELAY, LOST]),
    *(({"delay_slots": SUMMARY["delay_slots"] | {name: None}, "throughput": None},
       [DELIVERED, "Beware.", LOST]) for name in ("p50", "p99", "max")),
    ({"throughput": None, "interrupted_at_s": 1.5},
     [DELIVERED, "Beware.", DELAY, LOST, "Interrupted at 1.500 s of simulated time."]),
])  # fmt: skip
def test_what_never_happened_is_not_said(more, lines, monkeypatch):
    assert show.result_lines(told(monkeypatch, **more)) == lines


@pytest.mark.parametrize(("count", "hidden", "is_outside", "more", "is_said"), [
    (1, False, False, {}, True), (0, False, False, {}, False), (1, True, False, {}, False),
    (1, False, True, {}, False), (1, False, False, {"level": "slotted"}, False),
])  # fmt: skip
def test_delays_outside_their_bounds_are_said_once(
    count, hidden, is_outside, more, is_said, monkeypatch
):
    made = told(monkeypatch, hidden, is_outside, bounds_noticed={"count": count}, **more)
    assert bool(show._noticed(made)) == is_said


@pytest.mark.parametrize(("handler", "port", "said"), [
    (ON_START, 0, "switched on"), (ON_FRAME, 3, "received a frame of type 3"),
    (ON_TIMER, MAIN, "a wait is over"), (ON_TIMER, 1 - MAIN, "its minislot"),
    (ON_INPUT, LEAVE, "is to leave"), (ON_INPUT, RESULT, "is told who received its packet"),
    (ON_INPUT, CLOCK, "is told time"), (ON_INPUT, 0, "was offered a packet"),
    (ON_CARRIER, 0, "hears nothing"), (ON_CARRIER, 2, "hears several"),
    (ON_CARRIER, 3, "hears one"), (ON_CARRIER, 7, "hears one"),
])  # fmt: skip
def test_a_call_is_said_in_words(handler, port, said):
    row = {"node": 3, "handler": handler, "port": port}
    assert run.call_words(None, row) == f"station 3: {said}"


@pytest.mark.parametrize(("level", "name", "why"), [
    ("slotted", "slotted", "a run on the slotted level has no events to compare"),
    (None, "radio", ""), ("exact", "radio", ""),
])  # fmt: skip
def test_a_slotted_run_has_a_summary_of_its_own_and_no_events(level, name, why):
    summary = {} if level is None else {"level": level}
    assert (run.summary_name(summary), run.without_events(summary)) == (name, why)
    plan = Of(scenario=Of(model=Of(channel=Of(level=level))))
    assert bool(run.tables_of(Of(plan=plan))) == (level != "slotted")
    if level == "slotted":
        assert list(run.trail(plan, 9)) == []


@pytest.mark.parametrize(("per_turn", "slots", "most"), [(1, 9, 7), (3, 9, 21), (50, 99, None)])
def test_a_frame_carries_what_a_turns_packets_have_besides_their_crcs(per_turn, slots, most):
    params = {"per_turn": per_turn, "packet_slots": slots}
    assert board.payload_max(params) == (board.frames.PAYLOAD_MAX if most is None else most)
