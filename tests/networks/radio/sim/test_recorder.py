"""What is written down of a team and checked on the way, by frames that are made here."""

from types import SimpleNamespace

import pytest

from innervate.networks.radio.protocol.constants import DATA, REPORT
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.networks.radio.sim import build, recorder, simulate, stacks
from innervate.scenario.actions.channel import FADE, JOIN, KILL, LEAVE
from innervate.sim import taps
from innervate.sim.channel import medium
from innervate.sim.heap import AIR_BITS
from tests.networks.radio.baseline_runs import baseline_plan
from tests.networks.radio.runs import radio_plan

TA_US, SLOT_US = 2000, 208
SENT = {"kind": DATA, "slots": 5, "pos": 3, "next": 4, "handle": 9, "count": 7, "more": 1}


def world_of(plan=None, **kept):
    return build.build(plan or radio_plan(3, ta=TA_US), True, **kept)


def frame_of(world, **values):
    """One of the world's frames, with these fields."""
    found = world.frames[0]
    for name, value in values.items():
        setattr(found, name, value)
    return found


def test_a_row_says_when_a_frame_is_on_the_air_and_what_it_holds():
    world = world_of()
    recorder.record_sent(world, 2, frame_of(world, **SENT), 500)
    row = world.sent[0]
    assert (world.run[0].sent, row.node, row.time) == (1, 2, 500 + TA_US)
    assert row.end == 500 + TA_US + 5 * SLOT_US
    assert {name: getattr(row, name) for name in SENT} == SENT
    recorder.record_sent(world, 1, frame_of(world, kind=REPORT, more=0), 900)
    assert (world.run[0].sent, world.sent[1].kind, world.sent[1].more) == (2, REPORT, 0)
    assert world.run[0].taps == 0  # nobody asked for them


def test_a_frame_that_leaves_is_copied_for_captures():
    world = world_of(tap=True)
    frame = frame_of(world, **SENT)
    recorder.record_sent(world, 2, frame, 500)
    frame.handle = 10
    recorder.record_sent(world, 1, frame, 800)
    rows, copies = world.taps[:2], world.tapped[:2]
    assert [(row.time, row.start, row.at, row.sender, row.out, row.why) for row in rows] == [
        (2500, 2500, 2, 2, 1, taps.FINE), (2800, 2800, 1, 1, 1, taps.FINE),
    ]  # fmt: skip
    assert [copy.handle for copy in copies] == [9, 10]


@pytest.mark.parametrize(
    ("received", "clear", "deaf", "spoilt", "why"),
    [
        (1, 1, 0, 0, taps.FINE), (1, 1, 1, 1, taps.FINE), (0, 1, 0, 1, taps.SPOILT),
        (0, 1, 0, 0, taps.NOISE), (0, 0, 0, 0, taps.COLLISION), (0, 0, 2, 0, taps.SENDING),
        (0, 0, 0, 1, taps.COLLISION),
    ],
)  # fmt: skip
def test_a_capture_says_why_a_frame_was_not_received(received, clear, deaf, spoilt, why):
    world, what = world_of(tap=True), 2 << AIR_BITS | 1
    world.radios[0].alive, world.radios[0].deaf = 1, deaf
    world.air[what].start, world.air[what].spoilt = 700, spoilt
    world.frames[what].handle = 6
    recorder.record_received(world, 0, what, 950, clear, received)
    row = world.taps[0]
    assert (row.time, row.start, row.at, row.sender, row.out) == (950, 700, 0, 2, 0)
    assert (row.why, world.tapped[0].handle, world.run[0].taps) == (why, 6, 1)


def test_who_is_off_and_whom_nobody_captures_have_no_row():
    off, uncaptured = world_of(tap=True), world_of()
    uncaptured.radios[0].alive = 1
    for world in (off, uncaptured):
        recorder.record_received(world, 0, 1, 950, 1, 1)
        assert world.run[0].taps == 0


@pytest.mark.parametrize(("at", "broken"), [(1040, 0), (1039, recorder.BROKEN_TURNS), (0, 5)])
def test_a_turn_begins_when_the_last_has_ended(at, broken):
    """Of 5 slots of 208 us each."""
    world = world_of(radio_plan(3))
    run = world.run[0]
    assert run.exclusive
    frame = frame_of(world, **SENT)
    recorder.record_sent(world, 1, frame, 0)
    frame.kind = REPORT
    recorder.record_sent(world, 0, frame, 5)  # no turn
    assert run.broken == 0
    frame.kind = DATA
    recorder.record_sent(world, 2, frame, at)
    assert (run.broken, run.broken_node) == (broken, 2 if broken else 0)
    assert run.data_until == at + 1040
    recorder.record_sent(world, 1, frame, 0)
    assert (run.broken, run.broken_node) == (5, 2 if broken else 1)  # the first is told


def test_a_value_out_of_its_range_is_told_of_the_first_and_every_call_is_in_the_trail():
    world = world_of(trail=True)
    run = world.run[0]
    recorder.watch(world, 1, 40, 3, 0)
    assert run.broken == 0
    for node in (2, 1):
        world.stations[node].number = 1 << 20
        recorder.watch(world, node, 50, 3, 1)
    assert (run.broken, run.broken_node) == (medium.BROKEN_RANGE, 2)
    rows = [(row.time, row.node, row.handler, row.port) for row in world.trail[: run.trail]]
    assert rows == [(40, 1, 3, 0), (50, 2, 3, 1), (50, 1, 3, 1)]
    unchecked = world_of(checks=False)
    unchecked.stations[2].number = 1 << 20
    recorder.watch(unchecked, 2, 50, 3, 1)
    assert unchecked.run[0].broken == 0


def hidden():
    plan = radio_plan(3)
    plan.delays_us[0][2] = plan.delays_us[2][0] = -1
    return plan


DEATH = RadioFault(9_000, KILL, 1, 0, 0)


@pytest.mark.parametrize(
    ("plan", "exclusive"),
    [
        (radio_plan(3), 1), (radio_plan(3, protocol="csma-cd-r/paper"), 0),
        (radio_plan(3, loss_q15=1), 0), (radio_plan(3, faults=[DEATH]), 0), (hidden(), 0),
        (baseline_plan("tdma", 3), 0), (radio_plan(3, real=(51, 51)), 0),
        (radio_plan(3, real=(52, 52)), 1),
        (radio_plan(3, real=(105, 105)), 0), (radio_plan(3, real=(104, 104)), 1),
    ],
)  # fmt: skip
def test_turns_are_looked_at_where_none_may_overlap(plan, exclusive):
    assert world_of(plan).run[0].exclusive == exclusive
    assert world_of(plan, checks=False).run[0].exclusive == 0


@pytest.mark.parametrize(("action", "wanted"), [(KILL, 0), (LEAVE, 0), (JOIN, 3), (FADE, 3)])
def test_what_is_done_to_a_team_later_is_as_if_it_had_been_planned(action, wanted):
    running = simulate.simulation(radio_plan(3), plain=False)
    assert (running.world.run["exclusive"][0], running.world.run["wanted"][0]) == (1, 3)
    events = int(running.world.heap.size[0])
    running.schedule(RadioFault(700, action, 1, 2, 4))
    assert (running.world.run["exclusive"][0], running.world.run["wanted"][0]) == (0, wanted)
    told = running.world.commands[-1]
    assert (told["action"], told["node"], told["value"], told["index"]) == (action, 1, 2, 4)
    assert running.world.heap.size[0] == events + 1


def test_of_what_runs_plain_nothing_is_marked_as_compiled(monkeypatch):
    marked = []
    monkeypatch.setattr(simulate.compilation, "mark_compiled", marked.append)
    simulate.simulation(radio_plan(3), plain=True).prepare()
    assert marked == []


def test_all_names_of_one_protocol_share_what_is_compiled():
    def names(protocol, **kept):
        return simulate.simulation(radio_plan(3, protocol=protocol), **kept).loop_names()

    assert names("csma-cd-r/practical") == ["csma-cd-r-practical"]
    found = names("tdma")
    assert {"tdma", "dcf", "token-ring"} < set(found)
    assert len(found) == len(stacks.PROTOCOLS) - 2
    assert simulate.simulation(radio_plan(3), plain=True).name == ""


@pytest.mark.parametrize("broken", simulate.RadioSimulation.broken_words)
def test_what_is_broken_is_said_with_who_and_when(broken):
    world = world_of()
    run = world.run[0]
    run.broken, run.broken_node, run.broken_at = broken, 2, 1_500_000
    running = simulate.RadioSimulation(SimpleNamespace(seed=7), world, None)
    said = running.broken_line()
    assert said.startswith("invariant broken at 1.500000 s (seed 7): ")
    assert "station 2" in said
    run.broken_at = -1
    assert "at 0.000000 s" in running.broken_line()


def test_what_can_be_broken_is_known_in_words():
    words = simulate.RadioSimulation.broken_words
    assert len(set(words.values())) == len(words) == 7
    assert "began a turn while another" in words[recorder.BROKEN_TURNS]
    assert "declared range" in words[medium.BROKEN_RANGE]


FRAME = ("kind", "slots", "source", "handle", "pos", "next", "more", "ok", "window", "span", "wide")


def test_every_field_of_a_frame_has_a_part_in_its_fingerprint():
    world = world_of()
    frame = frame_of(world, **dict.fromkeys(FRAME, 0))
    nothing = stacks.digest(frame)
    seen = {nothing}
    for name in FRAME:
        setattr(frame, name, 1)
        seen.add(stacks.digest(frame))
        setattr(frame, name, 0)
    for name in ("good", "bad"):
        for place in (0, 1):
            getattr(frame, name)[place] = 1
            seen.add(stacks.digest(frame))
            getattr(frame, name)[place] = 0
    assert len(seen) == 1 + len(FRAME) + 4
