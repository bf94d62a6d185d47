"""A mesh over a radio team's channel, by hand: frames that become packets, and what comes back."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.access import QUEUE
from innervate.dialect.outbox import URGENT
from innervate.networks.mesh.protocol.constants import ACK
from innervate.networks.mesh.scenario.plan import HEADER_SLOTS
from innervate.networks.mesh.sim import over_channel, recorder
from innervate.networks.mesh.sim.over_channel import KEPT
from innervate.sim import heap, taps
from innervate.sim.channel import loop as radio_loop
from innervate.sim.channel import medium as channel
from innervate.sim.channel import traffic
from innervate.sim.channel.world import RING
from innervate.sim.field import calls, medium, queue
from innervate.sim.field.medium import NONE
from innervate.sim.field.states import ALIVE, DEAD, HELD, VOID
from innervate.sim.status import DONE, POOL_FULL

NODES, BYTES, PHY, SLOT_US = 3, 30, 7, 208
SLOTS = PHY + HEADER_SLOTS + BYTES


class Do:
    channel = "the channel's functions"

    def __init__(self):
        self.said, self.mark = [], 77

    def copy_frame(self, to, frame):
        to.seq = frame.seq

    def digest(self, _frame):
        return self.mark

    def frame_bytes(self, _frame):
        return BYTES

    def tell_sent(self, _world, _do, *what):
        self.said.append(("sent", *what))


def below_of():
    return Of(
        run=[Of(stations=NODES, broken=0, broken_node=2, slot_us=SLOT_US, fingerprint=5, offers=0,
                dropped=0)],
        radios=[Of(backlog=0, fresh=65_535, data_end=0, alive=1) for _ in range(NODES)],
        heap=Of(keys=[0] * 8, size=[0]), sizes=[0] * (NODES * RING), degree=[2, 2, 0],
        delay=[10, 25, 0] * NODES, above=Of(keys=[0] * 8, size=[0]),
        offered=[0] * (NODES * RING), got=[0] * (NODES * RING), tries=[0] * (NODES * RING),
    )  # fmt: skip


@pytest.fixture
def world():
    names = ("broken", "blocked", "arrived", "transmissions", "received", "fingerprint", "checks")
    return Of(
        run=[Of(**dict.fromkeys(names, 0), broken_node=-1, phy_bytes=PHY)], below=below_of(),
        radios=[Of(held=NONE, state=ALIVE) for _ in range(NODES)],
        air=[Of(node=0, state=HELD, start=0, end=0, receivers=0, digest=77)
             for _ in range(NODES * KEPT)],
        frames=[Of(seq=0, kind=ACK + 1, rssi=0) for _ in range(NODES * KEPT)],
    )  # fmt: skip


@pytest.fixture
def do():
    return Do()


@pytest.fixture
def said(monkeypatch):
    """What other rooms were asked for."""
    found = []
    for room, name in ((recorder, "record_transmission"), (recorder, "tap"), (calls, "take"),
                       (channel, "silence"), (radio_loop, "switch_on"), (traffic, "note_sent"),
                       (traffic, "note_received"), (traffic, "note_delivered")):  # fmt: skip
        monkeypatch.setattr(
            room, name, lambda _world, *what, name=name: found.append((name, *what))
        )
    monkeypatch.setattr(medium, "rssi_dbm", lambda _world, sender, node: -10 * sender - node)
    return found


PLACE = KEPT + (65_535 & (KEPT - 1))  # of node 1's first packet


@pytest.mark.parametrize(("flags", "held"), [(0, PLACE), (URGENT, NONE)])
def test_a_frame_becomes_a_packet_that_is_offered_at_once(world, do, flags, held):
    assert over_channel.hand_down(world, do, 1, Of(seq=9), Of(c=flags), 70) == 77
    air = world.air[PLACE]
    assert (air.node, air.state, air.receivers, air.digest) == (1, HELD, 0, 77)
    assert (world.frames[PLACE].seq, world.radios[1].held) == (9, held)
    below = world.below
    assert below.sizes[RING + (65_535 & (RING - 1))] == SLOTS
    assert below.heap.keys[0] == heap.key_of(70, heap.OFFER, 1, 1)
    assert (below.radios[1].fresh, below.radios[1].backlog) == (0, 1)


@pytest.mark.parametrize(("flags", "held", "backlog", "found"), [
    (0, 5, 0, (medium.BROKEN_HELD, 0)), (URGENT, 5, QUEUE - 1, (0, 0)),
    (URGENT, NONE, QUEUE, (0, 1)),
    (0, NONE, QUEUE, (0, 0)),
])  # fmt: skip
def test_what_has_no_room_is_left_out_or_breaks_the_run(world, do, flags, held, backlog, found):
    world.radios[1].held, world.below.radios[1].backlog = held, backlog
    sent = over_channel.hand_down(world, do, 1, Of(seq=9), Of(c=flags), 70)
    assert (world.run[0].broken, world.run[0].blocked) == found
    assert sent == (0 if any(found) else 77)
    assert world.below.heap.size[0] == (0 if any(found) else 1)


def above(below):
    return sorted(below.above.keys[: below.above.size[0]])


def test_what_the_channel_does_is_noted_above(said):
    below = below_of()
    below.radios[0].data_end = 900
    frame = Of(count=2, handle=65_535, source=1)
    over_channel.note_sent(below, 0, frame, 70)
    ends = 900 + 25 + 1  # when the furthest has heard its end
    assert above(below) == [queue.key_of(ends, queue.ENDS, 0, place) for place in (0, KEPT - 1)]
    below.above.size[0] = 0
    over_channel.note_received(below, 2, frame, 80)
    assert above(below) == [
        queue.key_of(80, queue.STARTS, 2, place) for place in (KEPT, 2 * KEPT - 1)]  # fmt: skip
    below.above.size[0] = 0
    over_channel.note_delivered(below, 2, 65_535, 90)
    assert above(below) == [queue.key_of(90, queue.TELL, 2, 3 * KEPT - 1)]
    assert [what[0] for what in said] == ["note_sent", "note_received", "note_delivered"]


@pytest.mark.parametrize(("node", "tail"), [(0, 26), (2, 1)])
def test_a_frame_is_over_when_the_furthest_has_heard_it(node, tail):
    assert over_channel.tail_us(below_of(), node) == tail


def test_a_frame_began_as_many_slots_before_its_end(world):
    began = over_channel.began(world, 3, BYTES, 90_000)
    assert began == world.air[3].start == 90_000 - SLOTS * SLOT_US
    assert world.air[3].end == 90_000


@pytest.mark.parametrize("broken", [0, 3])
def test_a_channel_that_broke_breaks_the_mesh(world, monkeypatch, broken):
    monkeypatch.setattr(radio_loop, "pressing", lambda below: POOL_FULL if not broken else DONE)
    world.below.run[0].broken = broken
    assert over_channel.short(world) == (DONE if broken else POOL_FULL)
    found = (recorder.BROKEN_BELOW, 2) if broken else (0, -1)
    assert (world.run[0].broken, world.run[0].broken_node) == found


def test_who_starts_listens_first(world, do, said):
    over_channel.power_on(world, do, 1, 70, 0)
    assert said == [("switch_on", do.channel, 1, 70, radio_loop.LATE)]


@pytest.mark.parametrize(("backlog", "data_end", "row"), [
    (1, 70 + SLOTS * SLOT_US - 1, 1), (1, 70 + SLOTS * SLOT_US, 0), (0, 900, 0), (1, 70, 0),
    (1, 71, 1),
])  # fmt: skip
def test_who_stops_in_mid_frame_leaves_a_row_of_it_if_it_had_begun(
    world, do, said, backlog, data_end, row
):
    one = world.below.radios[1]
    one.backlog, one.data_end, one.fresh = backlog, data_end, 4
    over_channel.power_off(world, do, 1, 70)
    rows = [what for what in said if what[0] == "record_transmission"]
    assert rows == [("record_transmission", KEPT + 3, 70, BYTES, 0)] * row
    assert (one.alive, one.backlog) == (0, 0)
    assert said[-1] == ("silence", 1, 70)
    assert [air.state for air in world.air] == [HELD] * KEPT + [VOID] * KEPT + [HELD] * KEPT


@pytest.mark.parametrize(("kind", "rssi"), [(ACK, 0), (ACK + 1, -12)])
def test_a_frame_that_arrives_is_taken_and_counted(world, do, said, kind, rssi):
    world.air[5].node, world.frames[5].kind = 1, kind
    over_channel.arrive(world, do, 2, 5, 70)
    assert (world.air[5].receivers, world.run[0].arrived, world.frames[5].rssi) == (1, 1, rssi)
    assert said == [("tap", 5, 2, 70, 0, taps.FINE), ("take", do, 2, world.frames[5], 70)]


@pytest.mark.parametrize("change", ["void", "dead"])
def test_nothing_arrives_of_who_has_stopped_or_at_who_is_off(world, do, said, change):
    if change == "void":
        world.air[5].state = VOID
    else:
        world.radios[2].state = DEAD
    over_channel.arrive(world, do, 2, 5, 70)
    assert (said, world.run[0].arrived) == ([], 0)


@pytest.mark.parametrize(("checks", "mark", "broken"), [
    (1, 77, 0), (1, 78, medium.BROKEN_FRAME), (0, 78, 0),
])  # fmt: skip
def test_a_frame_that_has_left_the_air_has_its_row_and_counts(
    world, do, said, checks, mark, broken
):
    world.run[0].checks, do.mark, world.air[5].receivers = checks, mark, 2
    over_channel.note_end(world, do, 0, 5, 90_026)
    run, start = world.run[0], 90_000 - SLOTS * SLOT_US
    assert said == [("record_transmission", 5, 90_000, BYTES, 2),
                    ("tap", 5, 0, start, 1, taps.FINE)]  # fmt: skip
    assert (run.transmissions, run.received, run.broken) == (1, 2, broken)
    assert world.air[5].receivers == 0  # it may be sent again
    world.air[5].state = VOID
    over_channel.note_end(world, do, 0, 5, 90_026)
    assert (run.transmissions, len(said)) == (1, 2)


@pytest.mark.parametrize(("rank", "what"), [(queue.STARTS, "arrive"), (queue.ENDS, "note_end")])
def test_what_the_channel_noted_is_done(world, do, monkeypatch, rank, what):
    called = []
    for name in ("arrive", "note_end"):
        monkeypatch.setattr(
            over_channel, name, lambda _w, _do, *how, name=name: called.append((name, *how))
        )
    over_channel.dispatch_below(world, do, rank, 2, 5, 70)
    assert called == [(what, 2, 5, 70)]
    assert world.run[0].fingerprint != 0


@pytest.mark.parametrize(("held", "told"), [(5, 1), (6, 0), (NONE, 0)])
def test_a_router_is_told_that_its_own_frame_was_delivered(world, do, held, told):
    world.radios[2].held = held
    over_channel.dispatch_below(world, do, queue.TELL, 2, 5, 70)
    assert do.said == [("sent", 2, 70, 1)] * told
    assert world.radios[2].held == (NONE if told else held)
