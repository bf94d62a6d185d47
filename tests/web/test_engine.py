"""What is done to a watched network happens as if it had stood in the scenario."""

from dataclasses import replace

import numpy as np
import pytest

from innervate import scenario
from innervate.network import networks
from innervate.running import run
from innervate.web.engine import engine_of, twin
from innervate.web.errors import Refused, WatchError
from innervate.web.history import History
from innervate.web.messages import Cut, Heal, Kill, Revive
from innervate.web.saving import saved
from tests.networks.skin.runs import free
from tests.web.runs import KINDS, MESH, RADIO, SKIN, plan_of

BUDGETS = (64, 1000, 100_000)


def view_of(engine, history):
    return networks()[engine.plan.kind].view(engine, history)


def ready(kind, **more):
    engine = engine_of(plan_of(KINDS[kind], **more))
    engine.running.prepare()
    return engine


def go(engine, until_us, budget=5_000):
    while engine.now_us < until_us and not engine.running.is_complete():
        engine.advance(until_us, budget)


def to_end(engine, budget=5_000):
    go(engine, engine.plan.duration_us, budget)
    return engine.running.fingerprint


@pytest.mark.parametrize("kind", KINDS)
def test_however_it_is_cut_into_slices_it_is_the_batch_run(kind):
    batch = run(KINDS[kind]).result.fingerprint
    assert {to_end(ready(kind), budget) for budget in BUDGETS} == {batch}


@pytest.mark.parametrize("kind", KINDS)
def test_it_stops_after_its_budget_at_what_it_came_to(kind):
    engine = ready(kind)
    engine.advance(engine.plan.duration_us, 64)
    assert 0 < engine.now_us < engine.plan.duration_us
    assert engine.now_us == engine.running.clock_us() + 1


@pytest.mark.parametrize("kind", KINDS)
def test_one_event_after_the_other_is_the_same_network(kind):
    engine, whole = ready(kind), ready(kind)
    steps = 0
    while (at := engine.running.next_us()) is not None and at < 200_000 and steps < 400:
        assert at >= engine.now_us
        engine.advance(at + 1, 1)
        assert engine.now_us == at + 1
        steps += 1
    go(whole, engine.now_us)
    assert steps > 5
    assert engine.running.fingerprint == whole.running.fingerprint


# Commands with their moments, by kind; links and nodes by number.
DONE = {
    "skin": [(0.3, Cut(0)), (0.31, Kill(8)), (0.5, Heal(0)), (0.6, Revive(8)), (0.8, Cut(50))],
    "radio": [(0.5, Kill(2)), (0.9, Kill(3)), (2.0, Revive(2))],
    "mesh": [(2.5, Cut(1)), (3.0, Kill(5)), (5.0, Heal(1)), (6.0, Revive(5))],
}
# What the scenario itself brings, drawn or not.
OWN = {
    "skin": [{"at_s": [0.2, 0.9], "action": "cut", "random": "link"},
             {"at_s": 0.55, "action": "cut", "random": "link"},
             {"at_s": 0.7, "action": "loose", "interface": 1, "loss": 0.3}],
    "radio": [{"at_s": [1.0, 3.0], "action": "kill", "station": "random"},
              {"at_s": 2.5, "action": "garble", "station": 0, "frames": 2}],
    "mesh": [{"at_s": [3.5, 4.5], "action": "kill", "random": 2},
             {"at_s": 7.0, "action": "revive", "random": 1},
             {"at_s": 7.5, "action": "cut", "random": 2}],
}  # fmt: skip


def watched(kind, events=(), go_back=False):
    """A network to which something was done, at its end, and its view."""
    engine = ready(kind, event=list(events))
    view = view_of(engine, History())
    mark = engine.mark()
    for at_s, command in DONE[kind]:
        go(engine, round(1e6 * at_s))
        engine.add(view.fault(command))
        engine.advance(engine.now_us + 1, 1)
    if go_back:
        engine.back_to(mark)
    to_end(engine)
    return engine, view


@pytest.mark.parametrize("events", [False, True], ids=["alone", "among others"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_saved_network_is_replayed(kind, events):
    engine, view = watched(kind, OWN[kind] if events else ())
    again = run(scenario.loads(saved(view)))
    assert again.result.fingerprint == engine.running.fingerprint
    planned = [replace(fault, index=0) for fault in again.plan.faults]
    assert [fault for fault in engine.given if replace(fault, index=0) not in planned] == []
    untouched = run({**KINDS[kind], "event": OWN[kind] if events else []})
    assert untouched.result.fingerprint != engine.running.fingerprint


@pytest.mark.parametrize("kind", KINDS)
def test_taken_back_and_gone_on_it_is_the_same_network(kind):
    assert (
        watched(kind, go_back=True)[0].running.fingerprint == watched(kind)[0].running.fingerprint
    )


def test_what_is_saved_without_commands_is_the_scenario():
    made = plan_of(SKIN, event=[{"at_s": 0.5, "action": "cut", "interface": 0}])
    view = view_of(engine_of(made), History())
    assert scenario.loads(saved(view)) == made.scenario


@pytest.mark.parametrize(
    ("kind", "first", "second"),
    [
        ("skin", Cut(3), Cut(3)),
        ("skin", None, Heal(3)),
        ("skin", Kill(4), Kill(4)),
        ("skin", None, Revive(4)),
        ("skin", None, Kill(30)),  # an interface port
        ("skin", None, Kill(-1)),
        ("skin", None, Cut(100_000)),
        ("skin", Kill(0), Heal(0)),  # its cell is off
        ("radio", Kill(1), Kill(1)),
        ("radio", None, Revive(1)),
        ("radio", None, Cut(0)),
        ("radio", None, Kill(6)),
        ("mesh", Cut(1), Cut(1)),
        ("mesh", None, Heal(1)),
        ("mesh", Kill(4), Kill(4)),
        ("mesh", None, Revive(4)),
        ("mesh", None, Kill(12)),
    ],
)
def test_what_is_so_already_is_refused(kind, first, second):
    engine = ready(kind)
    view = view_of(engine, History())
    go(engine, 200_000)
    if first is not None:
        engine.add(view.fault(first))
        engine.advance(engine.now_us + 1, 1)
    with pytest.raises(Refused):
        view.fault(second)


def test_before_its_start_a_node_of_a_mesh_is_left_alone():
    """Its first event would make the scenario's node one that is away at first."""
    engine = ready("mesh")
    view = view_of(engine, History())
    for command in (Kill(0), Revive(0)):
        with pytest.raises(Refused):
            view.fault(command)


def test_what_has_no_clock_cannot_be_watched():
    scripted = free([("pc.0", "n1")], script={"steps": ["tick n1"]})
    with pytest.raises(WatchError, match="script"):
        engine_of(plan_of(scripted))
    with pytest.raises(WatchError, match="slotted"):
        engine_of(plan_of(RADIO, channel={"level": "slotted"}))


def test_a_copy_keeps_views_of_the_same_memory():
    engine = ready("mesh", **{k: v for k, v in MESH.items() if k == "nodes"})
    made, size = twin(engine.world, tuple(engine.running.tables))
    assert size > made.nodes.nbytes
    made.nodes["seq"][3] = 77
    assert 77 in made.words[3]
    assert engine.world.nodes["seq"][3] == 0
    assert made.rows is engine.world.rows
    assert not np.shares_memory(made.heap.keys, engine.world.heap.keys)


def test_a_team_that_is_done_goes_on_when_somebody_dies():
    engine = ready("radio")
    to_end(engine)
    assert engine.running.is_complete()
    assert engine.now_us < engine.plan.duration_us
    view = view_of(engine, History())
    engine.add(view.fault(Kill(3)))
    assert not engine.running.is_complete()
    to_end(engine)
    assert engine.now_us == engine.plan.duration_us
    assert run(scenario.loads(saved(view))).result.fingerprint == engine.running.fingerprint
