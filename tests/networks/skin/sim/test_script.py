"""A scenario's steps in place of the clock, by hand: what each takes, loses, and leaves behind."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.outbox import URGENT
from innervate.networks.skin.protocol.constants import BEACON, ONE, RULE_STATIC, SOON, TICK
from innervate.networks.skin.scenario.script import (
    DELIVER,
    DETECT,
    DRAW,
    STEP_CUT,
    STEP_LOSE,
    STEP_RESTART,
    STEP_RESTORE,
    Step,
)
from innervate.networks.skin.scenario.script import SOON as STEP_SOON
from innervate.networks.skin.scenario.script import TICK as STEP_TICK
from innervate.networks.skin.sim import script, simulate, static_stack
from innervate.networks.skin.sim import stack as skin_stack
from innervate.scenario import ScenarioError
from innervate.sim import wheel
from innervate.sim.cables import calls, wires
from innervate.sim.cables.wires import DOWN, LOST_CUT, LOST_NOISE, URGENT_BLOCK
from innervate.sim.driver import InvariantBroken
from tests.networks.skin.runs import free, plan_of

LINKS = [("pc.0", "n0"), ("n0", "n1"), ("n1", "pc.1")]
A, B = 1, 4  # n0 to n1
PC = 2


def planned(*steps, **keys):
    plan = plan_of(free(LINKS, **keys))
    plan.script = steps
    plan.scenario = Of(
        model=Of(script=Of(keepalive=False)),
        source=Of(error=lambda key, what: ScenarioError(f"{key[-1]}: {what}")),
    )
    return plan


def played(*steps, stack=skin_stack, checks=True):
    return script.play(planned(*steps), stack, checks, True)


def stage_of(*steps, keepalive=False):
    plan = planned()
    plan.scenario.model.script.keepalive = keepalive
    world, _ = script.play(plan, skin_stack, True, False)
    stage = script._Stage(plan, world, skin_stack, set())
    for number, step in enumerate(steps):
        script._take(stage, number, step, 1_000 * (number + 1))
    return stage


def flights(world):
    """(slot, sent to which end) of the frames that are on their way."""
    first = world.run[0].pool_slots
    return [(slot, world.wheel.events[slot].target) for slot in range(first, world.wheel.pool[1])
            if world.wheel.events[slot].bucket != wheel.NIL]  # fmt: skip


def to(world, end):
    return sum(target == end for _, target in flights(world))


def test_before_the_first_step_all_are_on_at_time_0():
    world, time = played()
    assert (time, world.alive) == (0, [1, 1, 1])
    assert flights(world) == []
    assert [row.handler for row in world.trail[: world.run[0].trail]] == [0, 0, 0]


def test_a_step_takes_a_millisecond():
    world, time = played(Step(STEP_TICK, 0), Step(STEP_TICK, 1))
    assert time == 2_000
    rows = world.trail[3 : world.run[0].trail]
    assert [(row.time, row.node) for row in rows] == [(1_000, 0), (2_000, 1)]
    assert world.run[0].status == 0


def test_frames_are_taken_in_the_order_in_which_they_were_sent():
    stage = stage_of(Step(STEP_TICK, 0))
    world = stage.world
    assert to(world, B) == 1
    wires.transmit(world, skin_stack, A, world.frames[0], 1_500, URGENT)
    first, second = [slot for slot, target in flights(world) if target == B]
    script._take(stage, 2, Step(STEP_LOSE, 1, A), 3_000)
    assert [slot for slot, target in flights(world) if target == B] == [second]
    assert world.counters[LOST_NOISE + URGENT_BLOCK] == 1
    assert world.wheel.pool[wheel.FREE] == first  # for another frame
    script._take(stage, 3, Step(DELIVER, 1, A), 4_000)
    assert to(world, B) == 0
    assert world.frames[second - world.run[0].pool_slots].kind == BEACON


@pytest.mark.parametrize(("step", "says"), [
    (Step(DELIVER, 1, A), "no frame is on its way from n0 E to n1"),
    (Step(STEP_LOSE, 1, A), "no frame is on its way from n0 E to n1"),
    (Step(STEP_SOON, 1), "n1 has nothing to send soon"),
])  # fmt: skip
def test_what_is_not_there_cannot_be_taken(step, says):
    with pytest.raises(ScenarioError, match=f"1: script.steps.1: {says}"):
        played(Step(STEP_TICK, 1), step)


@pytest.mark.parametrize(("action", "timer"), [(STEP_TICK, TICK), (STEP_SOON, SOON)])
def test_a_step_is_of_its_own_timer(monkeypatch, action, timer):
    stage, due = stage_of(), []
    slot = timer * 3 + 1
    if timer == SOON:
        wheel.insert(stage.world.wheel, slot, 9_000)
    monkeypatch.setattr(calls, "on_event", lambda _world, _stack, *what: due.append(what))
    script._take(stage, 0, Step(action, 1), 1_000)
    assert due == [(slot, 1_000)]
    assert stage.world.wheel.events[slot].bucket == wheel.NIL


def test_a_draw_is_for_the_next_step_alone():
    stage = stage_of(Step(DRAW, value=6))
    assert [cell.choice for cell in stage.world.cells] == [6, 6]
    script._take(stage, 1, Step(STEP_TICK, 0), 2_000)
    assert [cell.choice for cell in stage.world.cells] == [-1, -1]


@pytest.mark.parametrize(("pf", "after"), [(0, ONE - 1), (ONE, ONE), (ONE - 2, ONE - 1)])
def test_who_is_to_find_a_port_broken_heard_nothing_on_it(pf, after):
    stage = stage_of()
    cell = stage.world.cells[0]
    cell.heard[1], cell.pf[1] = 1, pf
    script._take(stage, 0, Step(DETECT, 0, A), 1_000)
    assert (cell.heard[1], cell.pf[1], stage.missed) == (0, after, {A})


@pytest.mark.parametrize(("missed", "is_down", "pf", "heard"), [
    (set(), 0, 0, 1), ({A}, 0, 0, 0), (set(), DOWN, 0, 1), (set(), DOWN, ONE, 0),
    (set(), 0, ONE, 1),
])  # fmt: skip
def test_cables_that_are_kept_alive_have_brought_something(missed, is_down, pf, heard):
    stage = stage_of()
    world, cell = stage.world, stage.world.cells[0]
    cell.heard[:], cell.pf[1], world.ends[A].impaired = [5, 5, 5, 5], pf, is_down
    script._keep_alive(world, 0, missed)
    assert cell.heard == [1, heard, 5, 5]  # where there is no cable nothing is said
    assert missed == set()
    script._keep_alive(world, PC, missed)


@pytest.mark.parametrize("keepalive", [False, True])
def test_before_a_tick_cables_are_kept_alive_if_it_is_said_so(monkeypatch, keepalive):
    kept = []
    monkeypatch.setattr(script, "_keep_alive", lambda _world, node, _missed: kept.append(node))
    stage_of(Step(STEP_TICK, 1), Step(STEP_TICK, 0), keepalive=keepalive)
    assert kept == ([1, 0] if keepalive else [])


def test_a_cable_that_is_cut_loses_what_is_on_it_both_ways_and_no_more():
    stage = stage_of(Step(STEP_TICK, 0), Step(STEP_TICK, 1), Step(STEP_CUT, end=A))
    world = stage.world
    assert sorted({target for _, target in flights(world)}) == [8, 9]
    assert world.counters[LOST_CUT + URGENT_BLOCK] == 2
    assert [world.epoch[end] for end in (A, B)] == [1, 1]
    script._take(stage, 3, Step(STEP_RESTORE, end=A), 4_000)
    assert [world.epoch[end] for end in (A, B)] == [2, 2]


def test_who_is_restarted_begins_again():
    world, _ = played(Step(STEP_TICK, 0), Step(STEP_RESTART, 0))
    rows = world.trail[: world.run[0].trail]
    assert [(row.time, row.node, row.handler, row.port) for row in rows][-1] == (2_000, 0, 0, 1)


def test_what_breaks_ends_a_script_at_its_step(monkeypatch):
    plan = planned(Step(STEP_TICK, 0), Step(STEP_TICK, 1), Step(STEP_TICK, 0))

    def tick(world, _stack, slot, time):
        world.run[0].broken, world.run[0].broken_node = (4, 1) if time == 2_000 else (0, -1)

    monkeypatch.setattr(calls, "on_event", tick)
    with pytest.raises(InvariantBroken, match=r"broken at 0\.002000 s .*: outbox of n1 overflowed"):
        simulate.simulate(plan)


def test_a_script_leaves_what_a_run_does():
    plan = planned(Step(STEP_TICK, 0), Step(DELIVER, 1, A))
    result = simulate.simulate(plan, trail=True)
    assert (result.ended_us, result.interrupted, result.has_deliveries) == (2_000, False, False)
    assert len(result.trail) == 5
    assert len(simulate.simulate(plan).trail) == 0
    assert result.plan is plan


@pytest.mark.parametrize(("rule", "stack"), [(RULE_STATIC, static_stack), (0, skin_stack)])
def test_a_script_is_played_by_the_rule_of_its_plan(monkeypatch, rule, stack):
    asked = []

    def play(plan, stack, *kept):
        asked.append((stack, *kept))
        raise KeyError

    monkeypatch.setattr(script, "play", play)
    plan = planned(Step(STEP_TICK, 0))
    plan.params = {**plan.params, "rule": rule}
    with pytest.raises(KeyError):
        simulate.simulate(plan, checks=False, trail=True)
    assert asked == [(stack, False, True)]


# The static baseline.


def test_the_baselines_handlers_are_told_the_time_of_their_nodes_clock(monkeypatch):
    said = []

    def note(room, name):
        monkeypatch.setattr(room, name, lambda *what: said.append((name, what[0], *what[2:-1])))

    for name in ("on_start", "on_frame", "on_timer", "sink_frame", "sink_timer"):
        note(static_stack.skin_static, name)
    monkeypatch.setattr(
        static_stack.skin_sink, "on_start", lambda *what: said.append(("pc", what[2]))
    )
    world = Of(run=[Of(cells=2)], cells=["a", "b"], pc="pc", params=[None], out=None,
               clocks=[Of(offset=100, rate=0)] * 3)  # fmt: skip
    frame = Of(kind=BEACON)
    for node in (1, PC):
        static_stack.on_start(world, node, 500, 1)
        static_stack.on_frame(world, node, 900, 3, frame)
        static_stack.on_timer(world, node, 500, TICK)
    assert said == [
        ("on_start", "b", 500, 1), ("on_frame", "b", 1_000, 3, frame), ("on_timer", "b", 500, TICK),
        ("pc", 500), ("sink_frame", "pc", 1_000, 3, frame), ("sink_timer", "pc", 500, TICK),
    ]  # fmt: skip
