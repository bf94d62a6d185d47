"""What the medium of cables is told of a network that only declares its protocol: by hand."""

from types import ModuleType
from types import SimpleNamespace as Of

import pytest

from innervate.dialect.arith import MASK30
from innervate.scenario.actions.cables import GIVE
from innervate.sim import wheel
from innervate.sim.cables import declared
from innervate.sim.cables.declared import functions
from innervate.sim.cables.world import ALIVE, BROKEN_RANGE, DEAD, OFF
from innervate.sim.came import Came
from innervate.sim.own import Unfit, frames_of
from innervate.sim.recorded import Recorded
from tests.networks.skin.runs import line, plan_of

HANDLERS = ("on_start", "on_frame", "on_timer", "on_input")
FRAME = (("kind", 0, 0, 9, "", ""), ("seq", 0, 0, 255, "", ""), ("path", 2, 0, 9, "", ""))
TIMED = (*FRAME, ("made_at", 0, 0, MASK30, "us", ""))


def protocol_of(timers=3, **more):
    made = ModuleType("gossip")
    vars(made).update(dict.fromkeys(HANDLERS, print), TIMERS=timers, **more)
    return made


def frame(seq, **more):
    return Of(**{"kind": 4, "seq": seq, "path": [5, 6], "made_at": 60} | more)


def world_of(**run):
    given = {"deliveries": 0, "delivery_limit": 9, "broken": 0, "broken_node": -1, "checks": 1}
    return Of(
        run=[Of(**given | run)], sample=[frame(0, made_at=9)], carrier=[frame(1), frame(2)],
        alive=[ALIVE, OFF, DEAD], counters=[0] * 40, deliveries=[Of() for _ in range(3)],
        delays=[Of(high=0, count=0, sum=0)], delay_counts=[0] * 6000, words=[[5], [9]],
        low=[0], high=[8], cells=[None] * 2, params=[None], clocks=[Of(offset=100, rate=0)] * 2,
        wheel=Of(clock=[MASK30, wheel.NIL]), watch=Came([60, MASK30 + 6], [0, 0]),
    )  # fmt: skip


@pytest.mark.parametrize("timers", [3, 4])
def test_a_node_has_so_many_timers_beside_that_of_its_samples(timers):
    if timers > 3:
        with pytest.raises(Unfit, match="at most 3 timers, not 4"):
            functions(protocol_of(timers), Of(FRAME=FRAME))
    else:
        functions(protocol_of(timers), Of(FRAME=FRAME))


def test_a_frame_is_copied_and_told_by_every_field_but_when_it_was_made():
    made = frames_of(TIMED)
    to = frame(0, kind=0, path=[0, 0], made_at=0)
    made["copy_frame"](to, frame(7))
    assert to == frame(7)
    assert to.path is not frame(7).path
    marks = {made["digest"](one) for one in (
        frame(7), frame(8), frame(7, kind=5), frame(7, path=[6, 5]), frame(7, path=[5, 7]),
        frame(7, made_at=61))}  # fmt: skip
    assert len(marks) == 5
    assert (made["kind_of"](frame(7)), made["block_of"](frame(7))) == (4, 0)
    assert frames_of(FRAME[1:])["kind_of"](frame(7)) == -1


def test_a_protocol_may_copy_its_frames_itself():
    def copy_frame(to, frm):
        to.seq = -frm.seq

    do = functions(protocol_of(copy_frame=copy_frame), Of(FRAME=FRAME))
    to = frame(0)
    do.copy_frame(to, frame(7))
    assert to.seq == -7


@pytest.mark.parametrize(("node", "kind"), [(0, 6), (1, 0), (2, 0)])
def test_what_a_user_gives_is_for_nodes_that_are_on(node, kind):
    do, world = functions(protocol_of(), Of(FRAME=FRAME)), world_of()
    assert do.take_input(world, Of(node=node, value=1, index=6, at=70)) == kind
    assert (world.sample[0].seq, world.sample[0].made_at) == (2, 9)


@pytest.mark.parametrize(("at", "made_at"), [(70, 70), (0, 1), (MASK30 + 1, 1), (MASK30 + 71, 70)])
def test_what_is_given_or_sensed_knows_when_it_was(at, made_at):
    do, world = functions(protocol_of(), Of(FRAME=TIMED)), world_of()
    assert do.take_input(world, Of(node=0, value=1, index=6, at=at)) == 6
    assert (world.sample[0].seq, world.sample[0].made_at) == (2, made_at)
    world.sample[0].made_at = 9
    do.sense(world, 0, at)
    assert world.sample[0].made_at == made_at
    functions(protocol_of(), Of(FRAME=FRAME)).sense(world, 0, 5)
    assert world.sample[0].made_at == made_at


@pytest.mark.parametrize(("fields", "made_at", "time", "latency"), [
    (FRAME, 60, 90, -1), (TIMED, 60, 90, 30), (TIMED, 0, 90, -1), (TIMED, 1, 1, 0),
    (TIMED, 5, MASK30 + 26, 20), (TIMED, MASK30 - 9, MASK30 + 11, 20),
])  # fmt: skip
def test_a_delivery_took_as_long_as_since_it_was_handed_in(fields, made_at, time, latency):
    do, world = functions(protocol_of(), Of(FRAME=fields)), world_of()
    do.on_deliver(world, time, 1, 2, frame(7, made_at=made_at))
    row = {"time": time, "node": 1, "port": 2, "kind": 4, "latency": latency}
    assert vars(world.deliveries[0]) == row
    assert world.delays[0].count == (latency >= 0)
    assert sum(world.watch.counts) == (latency >= 0 and time - latency >= 60)


@pytest.mark.parametrize(("node", "broken", "seen"), [(0, 64, [99]), (1, BROKEN_RANGE, [])])
def test_after_a_call_ranges_are_checked_before_own_invariants_by_the_nodes_clock(
    node, broken, seen
):
    found = []

    def holds(state, params, now):
        found.append(now)
        return False

    do, world = functions(protocol_of(), Of(FRAME=FRAME), {"it holds": holds}), world_of()
    do.check(world, node)
    assert (world.run[0].broken, world.run[0].broken_node, found) == (broken, node, seen)


def test_handlers_are_told_the_time_of_their_nodes_clock():
    said = []
    protocol = protocol_of()
    protocol.on_frame = lambda *what: said.append(("frame", *what[:5]))
    protocol.on_input = lambda *what: said.append(("input", *what[:5]))
    do, world = functions(protocol, Of(FRAME=FRAME)), world_of()
    world.cells, world.params, world.out = ["a", "b"], ["p"], Of(count=[0])
    one = frame(7)
    do.on_frame(world, 1, MASK30, 3, one)
    do.on_input(world, 0, 50, 6)
    assert said == [("frame", "b", "p", 99, 3, one), ("input", "a", "p", 50, 6, world.sample[0])]


@pytest.mark.parametrize(("own", "room"), [({}, 16), ({"OUTBOX": 21}, 21)])
def test_what_users_give_is_put_among_the_commands(monkeypatch, own, room):
    plan = plan_of(line(2))
    state = (("number", 0, 0, 65535, "", ""), ("rng", 0, 0, (1 << 30) - 1, "", ""))
    fields = Of(STATE=state, FRAME=FRAME, PARAMS=())
    network = Of(fields=fields, protocol=protocol_of(**own))
    monkeypatch.setattr(declared, "networks", lambda: {"skin": network})
    given = Of(at_us=70, node=1, kind=6, item={"seq": 8, "path": [2, 3]})
    inputs = [Of(at_us=90, node=0, kind=5, item={"seq": 9}), given]

    class Plan:
        def __getattr__(self, name):
            return inputs if name == "inputs" else getattr(plan, name)

    world = declared.world_of(Plan(), True, Recorded())
    rows = [(one.at, one.action, one.node, one.value, one.index) for one in world.commands]
    assert rows == [(0, -1, -1, 0, -1), (70, GIVE, 1, 1, 6), (90, GIVE, 0, 0, 5)]
    assert [(one.seq, one.path) for one in world.carrier[:2]] == [(9, [0, 0]), (8, [2, 3])]
    assert (world.out.limit[0], len(world.delays), world.pc) == (room, 1, ())
