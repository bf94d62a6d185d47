"""One cable's wire and queue, driven by hand: what goes, what waits, what is lost and why."""

from types import SimpleNamespace
from unittest import mock

import pytest

from innervate.dialect.outbox import FLUSH, URGENT
from innervate.networks.skin.protocol.constants import BEACON, COMMAND, DATA
from innervate.networks.skin.sim import stack
from innervate.networks.skin.sim.build import build
from innervate.scenario.actions.cables import CUT, KILL, LOOSE, LOSE, RESTART, RESTORE, REVIVE
from innervate.sim import tables, wheel
from innervate.sim.cables import build as cables
from innervate.sim.cables import commands, recorder, wires
from innervate.sim.cables.wires import (
    ARRIVED,
    DELAYED,
    LOST_BROKEN,
    LOST_CUT,
    LOST_NOISE,
    LOST_OFF,
    LOST_QUEUE,
    OTHER_BLOCK,
    SENT,
    URGENT_BLOCK,
)  # fmt: skip
from innervate.sim.cables.world import ALIVE, DEAD
from tests.networks.skin.runs import line, plan_of

WIRE_US, LATENCY_US = 60, 75
END, PEER = 1, 4  # cell 0 east to cell 1 west
ONE = 32_768


class Cable:
    """A line of two cells, all nodes on, nothing under way."""

    def __init__(self, room=3, hop_latency_us=(LATENCY_US, LATENCY_US), **timing):
        timing = {"hop_latency_us": list(hop_latency_us), "loss": 0.0} | timing
        plan = plan_of(line(2, data={"rate_hz": 100, "queue": room}, timing=timing))
        with mock.patch.object(cables, "BATCH", 8), mock.patch.object(tables, "PLAIN_ROWS", 8):
            self.world = build(plan, plain=True)
        assert self.world.ends[END].peer == PEER
        assert self.world.run[0].wire_us == WIRE_US
        for node in range(3):
            self.world.alive[node] = ALIVE
        self.world.run[0].observe = 0

    def frame(self, seq, kind=DATA):
        frame = self.world.sample[0]
        frame.kind, frame.seq, frame.cell = kind, seq, 0
        return frame

    def send(self, *seqs, at=0, flags=0, kind=DATA):
        for seq in seqs:
            wires.transmit(self.world, stack, END, self.frame(seq, kind), at, flags)
        return self

    def obey(self, action, *, end=END, node=-1, value=0):
        command = SimpleNamespace(action=action, at=0, end=end, node=node, value=value, index=0)
        commands.obey(self.world, stack, command)
        return self

    def flights(self):
        """(when it arrives, number, block) of the frames on their way."""
        run, events = self.world.run[0], self.world.wheel.events
        slots = range(run.pool_slots, self.world.wheel.pool[wheel.FRESH])
        return sorted(
            (events[slot].time, self.world.frames[slot - run.pool_slots].seq, events[slot].kind)
            for slot in slots
            if events[slot].bucket != wheel.NIL
        )

    def waiting(self):
        """Numbers of the frames that wait."""
        room, buffer = self.world.run[0].queue_frames, self.world.buffers[END]
        places = [(buffer.first + i) % room for i in range(buffer.queued)]
        return [self.world.queue[END * room + place].seq for place in places]

    def free(self, at):
        """The wire may be free: its event fires."""
        slot = self.world.run[0].tx_slots + END
        if self.world.wheel.events[slot].bucket != wheel.NIL:
            wheel.remove(self.world.wheel, slot)
        wires.wire_free(self.world, stack, END, at)
        return self

    def counts(self, block=0):
        """Counters of a block that are not 0."""
        names = {"sent": SENT, "cut": LOST_CUT, "noise": LOST_NOISE, "off": LOST_OFF,
                 "queue": LOST_QUEUE, "broken": LOST_BROKEN}  # fmt: skip
        found = {name: self.world.counters[place + block] for name, place in names.items()}
        return {name: count for name, count in found.items() if count}


def test_a_frame_arrives_after_the_latency_and_keeps_the_wire_for_its_length():
    cable = Cable().send(1, at=1000)
    assert cable.flights() == [(1000 + LATENCY_US, 1, 0)]
    assert cable.world.ends[END].busy == 1000 + WIRE_US
    assert cable.world.ends[PEER].busy == 0  # each way has a wire of its own
    assert cable.send(2, at=1000 + WIRE_US).flights()[1:] == [(1000 + WIRE_US + LATENCY_US, 2, 0)]
    assert cable.waiting() == []
    assert cable.send(3, at=1000 + 2 * WIRE_US - 1).waiting() == [3]
    assert cable.counts() == {"sent": 3}


@pytest.mark.parametrize("room", [1, 2, 3, 8])
def test_a_port_has_room_for_as_many_frames_as_it_is_said_to(room):
    cable = Cable(room).send(*range(room + 3))
    assert cable.waiting() == list(range(1, room + 1))
    assert cable.counts() == {"sent": room + 3, "queue": 2}
    cable.free(WIRE_US).send(50, 51, at=WIRE_US)  # one place is free again
    assert cable.waiting() == [*range(2, room + 1), 50]
    assert cable.counts()["queue"] == 3


def test_frames_that_wait_leave_one_by_one_in_order_round_and_round():
    cable = Cable(3).send(0, 1, 2, 3)
    for k in range(1, 20):  # one leaves, one comes
        cable.free(WIRE_US * k).send(k + 3, at=WIRE_US * k)
        assert cable.waiting() == [k + 1, k + 2, k + 3]
        assert cable.world.ends[END].waiting == 1
    for k in range(20, 23):
        cable.free(WIRE_US * k)
    assert cable.flights() == [(WIRE_US * k + LATENCY_US, k, 0) for k in range(23)]
    assert cable.free(WIRE_US * 23).world.ends[END].waiting == 0
    assert cable.counts() == {"sent": 23}


def test_a_wire_that_is_busy_again_is_waited_for():
    cable = Cable().send(1, 2)
    cable.send(9, at=10, flags=URGENT, kind=BEACON)  # takes the wire as soon as it is free
    assert cable.flights() == [(LATENCY_US, 1, 0), (WIRE_US + LATENCY_US, 0, URGENT_BLOCK)]
    assert cable.free(WIRE_US).waiting() == [2]
    slot = cable.world.run[0].tx_slots + END
    assert cable.world.wheel.events[slot].time == 2 * WIRE_US
    assert cable.free(2 * WIRE_US).waiting() == []
    assert (2 * WIRE_US + LATENCY_US, 2, 0) in cable.flights()
    assert (cable.counts(), cable.counts(URGENT_BLOCK)) == ({"sent": 2}, {"sent": 1})


def test_behind_one_that_waits_all_wait_though_the_wire_is_free():
    cable = Cable().send(1, 2)
    assert cable.send(3, at=WIRE_US).waiting() == [2, 3]


def test_commands_and_urgent_frames_are_counted_by_themselves():
    cable = Cable(1).send(1, kind=COMMAND).send(2, kind=COMMAND).send(3, kind=COMMAND)
    cable.send(4, flags=URGENT, kind=BEACON)
    assert cable.counts(OTHER_BLOCK) == {"sent": 3, "queue": 1}
    assert cable.counts(URGENT_BLOCK) == {"sent": 1}
    assert cable.counts() == {}
    cable.free(2 * WIRE_US)
    assert cable.counts(OTHER_BLOCK) == {"sent": 3, "queue": 1}  # it left, and was one already


def test_what_waits_at_a_port_that_is_found_broken_is_given_up():
    cable = Cable().send(1, 2, 3)
    cable.send(9, at=5, flags=URGENT | FLUSH, kind=BEACON)
    assert cable.waiting() == []
    assert cable.counts() == {"sent": 3, "broken": 2}
    assert cable.send(4, at=900).free(900).flights()[-1] == (900 + LATENCY_US, 4, 0)


def test_without_a_cable_nothing_leaves():
    cable = Cable()
    cable.world.ends[END].peer = -1
    assert cable.send(1, 2).flights() == []
    assert cable.counts() == {}


@pytest.mark.parametrize("lose", [1, 2])
def test_the_next_few_frames_are_lost_for_sure_both_ways(lose):
    cable = Cable().obey(LOSE, value=lose)
    for k in range(3):
        cable.send(k, at=1000 * k)
    assert [seq for _, seq, _ in cable.flights()] == list(range(lose, 3))
    assert cable.counts() == {"sent": 3, "noise": lose}
    assert (cable.world.buffers[PEER].lose, cable.world.ends[END].impaired) == (lose, 0)


def test_a_loose_cable_loses_by_chance_until_it_is_fixed_and_lost_frames_come_first():
    cable = Cable().obey(LOOSE, value=ONE).send(1, at=0).obey(LOSE, value=1).send(2, at=1000)
    assert cable.counts() == {"sent": 2, "noise": 2}
    assert cable.send(3, at=2000).counts() == {"sent": 3, "noise": 3}  # it is loose still
    cable.obey(LOOSE, value=0).send(4, at=3000)
    assert [seq for _, seq, _ in cable.flights()] == [4]
    half = Cable().obey(LOOSE, value=ONE // 2)
    for k in range(90):
        half.send(k, at=1000 * k)
    assert half.counts()["noise"] == pytest.approx(45, abs=19)  # four deviations


def test_a_frame_on_a_cable_that_is_cut_is_lost_and_so_are_those_behind_it():
    cable = Cable().send(1).obey(CUT)
    event = next(one for one in cable.world.wheel.events if one.bucket != wheel.NIL)
    assert not wires.lands(cable.world, stack, event, 1, cable.frame(1), 75)
    assert cable.send(2, at=1000).counts() == {"sent": 2, "cut": 2}
    cable.obey(RESTORE)  # what was under way when it was cut does not come after all
    assert not wires.lands(cable.world, stack, event, 1, cable.frame(1), 75)
    assert len(cable.send(3, at=2000).flights()) == 2


def test_a_frame_to_a_node_that_is_off_is_lost_for_that():
    cable = Cable().send(1, 2)
    event = next(one for one in cable.world.wheel.events if one.bucket != wheel.NIL)
    assert wires.lands(cable.world, stack, event, 1, cable.frame(1), 75)
    for state in (0, DEAD):
        cable.world.alive[1] = state
        assert not wires.lands(cable.world, stack, event, 1, cable.frame(1), 75)
    assert cable.counts() == {"sent": 2, "off": 2}
    assert cable.world.counters[ARRIVED] == 0  # whoever hands it on counts that


def test_who_loses_its_memory_loses_what_waits():
    for action in (KILL, RESTART):
        cable = Cable().send(1, 2, 3).obey(action, end=-1, node=0)
        assert cable.waiting() == []
        assert cable.counts()["off"] == 2


def down(cable):
    """Whether the cable is down, told by both its ends alike."""
    ends, epoch = cable.world.ends, cable.world.epoch
    found = {epoch[end] & 1 for end in (END, PEER)} | {
        ends[end].impaired & wires.DOWN for end in (END, PEER)}  # fmt: skip
    assert len(found) == 1
    return found == {1}


OFF, ON, OTHER, BACK = ((KILL, 0), (REVIVE, 0), (KILL, 1), (REVIVE, 1))


@pytest.mark.parametrize(
    ("steps", "is_down"),
    [
        ([CUT], True), ([CUT, RESTORE], False), ([RESTORE], False), ([RESTORE, CUT], True),
        ([OFF], True), ([OFF, ON], False), ([OFF, OFF, ON], False), ([ON], False),
        ([CUT, OFF, RESTORE], True), ([CUT, OFF, ON], True), ([CUT, OFF, ON, RESTORE], False),
        ([OFF, CUT, ON], True), ([OFF, OTHER, ON], True), ([OFF, OTHER, ON, BACK], False),
        # A cable that is not cut cannot be put back, whoever is off at its ends.
        ([OFF, RESTORE], True), ([OFF, OTHER, RESTORE, RESTORE], True),
        ([OFF, RESTORE, ON], False), ([OFF, RESTORE, ON, OFF], True),
        # One that is cut twice is put back once.
        ([CUT, CUT, RESTORE], False), ([CUT, OFF, CUT, RESTORE, ON], False),
        ([CUT, OFF, RESTORE, RESTORE], True), ([CUT, OFF, RESTORE, RESTORE, ON], False),
    ],
)  # fmt: skip
def test_a_cable_is_down_while_it_is_cut_or_a_node_at_it_is_off(steps, is_down):
    cable = Cable()
    for step in steps:
        action, node = step if isinstance(step, tuple) else (step, -1)
        cable.obey(action, node=node, end=END if node < 0 else -1)
    assert down(cable) == is_down


@pytest.mark.parametrize(("steps", "why"), [
    ([CUT], "cut"), ([OTHER], "off"), ([OFF], "off"), ([OFF, OTHER], "off"),
    ([CUT, OTHER], "cut"), ([OTHER, CUT], "cut"), ([CUT, OTHER, RESTORE], "off"),
    ([CUT, OTHER, BACK], "cut"),
])  # fmt: skip
def test_what_is_lost_on_a_cable_that_is_down_is_lost_to_the_cut_or_to_who_is_off(steps, why):
    """For a network of one's own; whoever reads captures of skins takes all of it for cuts."""
    own = SimpleNamespace(**{**vars(stack), "is_off": recorder.is_off})
    for do, found in ((own, why), (stack, "cut")):
        cable = Cable().send(1)
        event = next(one for one in cable.world.wheel.events if one.bucket != wheel.NIL)
        for step in steps:
            action, node = step if isinstance(step, tuple) else (step, -1)
            cable.obey(action, node=node, end=END if node < 0 else -1)
        assert not wires.lands(cable.world, do, event, 1, cable.frame(1), 75)
        wires.transmit(cable.world, do, END, cable.frame(2), 1000, 0)
        assert cable.counts() == {"sent": 2, found: 2}


@pytest.mark.parametrize("flags", [0, URGENT, FLUSH, URGENT | FLUSH])
@pytest.mark.parametrize(("steps", "is_sent"), [
    ([], True), ([KILL], False), ([RESTART], False), ([KILL, REVIVE], False),
    ([RESTART, RESTART], False), ([CUT, RESTORE], True),
])  # fmt: skip
def test_a_frame_sent_later_leaves_then_unless_its_node_has_lost_its_memory(steps, is_sent, flags):
    cable, block = Cable(), URGENT_BLOCK if flags & URGENT else 0
    with mock.patch.object(
        commands.calls, "switch_on", lambda world, do, node, *_: on(world, node)
    ):
        wires.delay(cable.world, stack, END, cable.frame(1), 500, flags)
        assert cable.flights() == [(500, 1, DELAYED)]
        for step in steps:
            cable.obey(step, node=-1 if step in (CUT, RESTORE) else 0)
    slot = cable.world.run[0].pool_slots
    wheel.remove(cable.world.wheel, slot)
    wires.release(cable.world, stack, slot, 500)
    assert cable.flights() == ([(500 + LATENCY_US, 1, block)] if is_sent else [])
    assert cable.counts(block) == ({"sent": 1} if is_sent else {"sent": 1, "off": 1})
    assert cable.world.wheel.pool[wheel.FREE] == slot  # for another frame


def on(world, node):
    """Stands for switching a node on: its handlers would send frames of their own."""
    world.alive[node] = ALIVE


def test_a_frame_sent_later_at_a_free_port_is_none():
    cable = Cable()
    free = next(end for end in range(8) if cable.world.ends[end].peer < 0)
    wires.delay(cable.world, stack, free, cable.frame(1), 500, 0)
    cable.obey(RESTART, node=free // 4)
    slot = cable.world.run[0].pool_slots
    wheel.remove(cable.world.wheel, slot)
    before = list(cable.world.counters)
    wires.release(cable.world, stack, slot, 500)
    assert cable.world.counters == before


def test_latencies_drawn_for_every_frame_lie_in_their_range_both_ends_included():
    cable = Cable(hop_latency_us=(70, 72), latency="per_frame")
    drawn = [at - 1000 * k for k in range(60)
             for at, seq, _ in cable.send(k, at=1000 * k).flights() if seq == k]  # fmt: skip
    assert set(drawn) == {70, 71, 72}
