"""A network's time: held, stepped, taken back, and gone through again in a recorded run."""

import signal

import numpy as np
import pytest

from innervate import scenario
from innervate.running import run
from innervate.sim.driver import InvariantBroken
from innervate.web import messages
from innervate.web.errors import Refused, WatchError
from innervate.web.history import LOG, SERIES, TIMELINE
from innervate.web.recorded import Recorded
from innervate.web.recorded import plan_of as plan_of_folder
from innervate.web.saving import saved
from tests.web.runs import KINDS, RADIO, SKIN, few_points, go_to, items, plan_of, simulated, texts

__all__ = ["few_points"]


@pytest.mark.parametrize("kind", KINDS)
def test_going_back_shows_what_was(kind):
    made, straight = simulated(KINDS[kind]), simulated(KINDS[kind])
    go_to(straight, 0.7)
    made.run_to_end()
    assert made.at_end
    go_to(made, 0.7)
    assert not made.at_end
    there, was = made.fields(), straight.fields()
    assert there.keys() == was.keys()
    for name, value in was.items():
        assert np.array_equal(there[name], value), name
    for stream in (LOG, SERIES, TIMELINE):
        assert [i.what for i in items(made, stream)] == [i.what for i in items(straight, stream)]


@pytest.mark.usefixtures("few_points")
def test_what_was_done_stays_done_when_one_goes_back():
    made = simulated(SKIN)
    go_to(made, 0.6)
    made.carry_out(messages.Cut(0))
    made.run_to_end()
    end = made.engine.running.fingerprint
    go_to(made, 0.3)
    assert made.fields()["link_up"][0] == 1
    made.run_to_end()
    assert made.fields()["link_up"][0] == 0
    assert made.engine.running.fingerprint == end
    go_to(made, 0.3)
    made.carry_out(messages.Cut(5))  # something else before it
    made.run_to_end()
    again = run(scenario.loads(saved(made.view)))
    assert again.result.fingerprint == made.engine.running.fingerprint != end


def test_a_step_is_one_event():
    made = simulated(SKIN)
    go_to(made, 0.4)
    for _ in range(20):
        due, handled = made.engine.running.next_us(), handled_by(made)
        made.carry_out(messages.Step())
        assert made.playback.paused
        made.work()
        assert made.engine.now_us == due + 1  # right behind it
        assert handled_by(made) > handled
        assert made.engine.running.next_us() > due


def handled_by(made):
    """How much nodes have done so far."""
    return int(made.engine.world.run[0]["handled"])


@pytest.mark.usefixtures("few_points")
def test_nothing_can_be_done_after_the_end():
    made = simulated(SKIN)
    made.run_to_end()
    for command in (messages.Cut(0), messages.Step()):
        with pytest.raises(Refused):
            made.carry_out(command)


def test_a_held_network_stays_where_it_is():
    made = simulated(SKIN, speed=1.0)
    go_to(made, 0.2)
    made.carry_out(messages.Pause())
    for _ in range(3):
        assert made.work() > 0
    assert made.fields()["paused"]
    assert made.engine.now_us == 200_000
    made.carry_out(messages.Cut(1))
    assert made.fields()["link_up"][1] == 0


def test_a_broken_invariant_holds_the_network_and_is_said(monkeypatch):
    made = simulated(SKIN)

    def breaks(until_us, budget):
        raise InvariantBroken("invariant broken at 0.1 s")

    monkeypatch.setattr(made.engine, "advance", breaks)
    made.run_to_end()
    assert made.broken
    assert made.fields()["at_end"]
    assert texts(made) == ["invariant broken at 0.1 s"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.usefixtures("few_points")
def test_a_run_folder_is_shown_as_it_was(kind, tmp_path):
    events = {"skin": [{"at_s": 0.5, "action": "cut", "interface": 0}], "radio": [], "mesh": []}
    done = run({**KINDS[kind], "event": events[kind]}, out=tmp_path / "run")
    made = Recorded(tmp_path / "run", plan_of_folder(tmp_path / "run"))
    made.replay()
    assert made.engine.now_us == 0
    assert made.scene()["source"] == "run"
    assert made.scene()["report"]
    made.run_to_end()
    assert made.engine.running.fingerprint == done.summary["fingerprint"]
    if kind == "skin":
        shown = made.fields()["recovery"]
        assert shown["recovered_ms"] == done.summary["recoveries"][0]["routed_ms"]
    with pytest.raises(Refused):
        made.carry_out(messages.Kill(0))


@pytest.mark.parametrize("least_us", [0, 120_000])
def test_a_team_that_was_interrupted_has_not_ended_on_its_page_either(
    tmp_path, monkeypatch, least_us
):
    monkeypatch.setattr("innervate.sim.driver.Simulation.slice_events", 20)

    def interrupt(now_us, _end_us):
        if now_us > least_us:
            signal.raise_signal(signal.SIGINT)

    done = run({"kind": "radio", "stations": 5, "duration_s": 9}, out=tmp_path / "run",
               progress=interrupt)  # fmt: skip
    assert done.summary["interrupted_at_s"] < 0.5
    made = Recorded(tmp_path / "run", plan_of_folder(tmp_path / "run"))
    made.replay()
    made.run_to_end()
    said = {name: made.fields()["headline"][name] for name in ("level", "text")}
    assert said == {name: done.summary["headline"][name] for name in ("level", "text")}
    assert said["level"] == "ok"


def test_of_an_interrupted_run_only_what_was_is_simulated_and_shown(tmp_path, monkeypatch):
    monkeypatch.setattr("innervate.sim.driver.Simulation.slice_events", 2_000)

    def interrupt(now_us, _end_us):
        if now_us > 200_000:
            signal.raise_signal(signal.SIGINT)

    event = [{"at_s": 0.9, "action": "cut", "interface": 0}]
    done = run({**SKIN, "event": event}, out=tmp_path / "run", progress=interrupt)
    ended_s = done.summary["interrupted_at_s"]
    assert 0.2 < ended_s < 0.9
    made = Recorded(tmp_path / "run", plan_of_folder(tmp_path / "run"))
    reached = []
    made.replay(lambda now_us, _end_us: reached.append(now_us))
    assert max(reached) <= 1e6 * ended_s + 1
    assert made.scene()["duration_s"] == pytest.approx(ended_s, abs=2e-6)
    assert texts(made)[0] == f"the run was interrupted at {ended_s:g} of 1 s"
    made.run_to_end()
    shown = made.fields()
    assert shown["at_end"]
    assert shown["t_s"] == pytest.approx(ended_s, abs=2e-6)
    assert shown["since_cut_s"] is None
    assert shown["headline"]["level"] == done.summary["headline"]["level"]


@pytest.mark.usefixtures("few_points")
def test_another_run_than_the_recorded_one_is_refused(tmp_path):
    done = run(SKIN, out=tmp_path / "run")
    other = tmp_path / "run" / "scenario.toml"
    other.write_text(other.read_text().replace("seed = 1", "seed = 2"))
    made = Recorded(tmp_path / "run", plan_of_folder(tmp_path / "run"))
    with pytest.raises(WatchError, match=done.summary["fingerprint"]):
        made.replay()


def test_a_skin_of_more_cells_than_memory_for_marks_keeps_few(monkeypatch):
    monkeypatch.setattr("innervate.web.simulated.MARKS_BYTES", 1)
    made = simulated(SKIN)
    made.run_to_end()
    assert len(made._marks) <= 2
    assert made._marks[0].engine.now_us == 0
    go_to(made, 0.2)
    assert made.engine.now_us == 200_000


def test_as_many_moments_are_kept_as_there_may_be_then_every_other(monkeypatch):
    monkeypatch.setattr("innervate.web.simulated.MARKS", 4)
    made = simulated(SKIN)
    kept = []
    for k in range(1, 50):
        go_to(made, 0.02 * k)
        kept.append(tuple(mark.engine.now_us for mark in made._marks))
    first = next(k for k, marks in enumerate(kept) if len(marks) == 4)
    assert {len(marks) for marks in kept[first:]} == {3, 4}
    thinned = next(marks for marks in kept[first:] if len(marks) == 3)
    assert thinned[:2] == kept[first][::2]


def test_plans_are_not_altered():
    plan = plan_of(SKIN)
    before = (list(plan.faults), list(plan.graph.peer))
    made = simulated(SKIN)
    made.carry_out(messages.Cut(0))
    assert (plan.faults, list(plan.graph.peer)) == before


@pytest.mark.parametrize("touch", [{}, {"touch": {"path": [[0.0, 0.0, 0.0], [0.9, 80.0, 50.0]]}}])
@pytest.mark.usefixtures("few_points")
def test_a_touch_by_hand_is_felt_and_replayed(touch):
    made = simulated(SKIN, **touch)
    go_to(made, 0.3)
    made.carry_out(messages.Touch(20, 255))
    go_to(made, 0.5)
    felt = made.fields()["touch"]
    assert felt[20] == felt.max() > 200
    assert felt[0] == 0
    made.carry_out(messages.Touch(20, 0))
    go_to(made, 0.8)
    assert made.fields()["touch"].max() == 0
    go_to(made, 0.4)  # and again
    assert made.fields()["touch"][20] > 200
    made.run_to_end()
    again = run(scenario.loads(saved(made.view)))
    assert again.result.fingerprint == made.engine.running.fingerprint
    assert again.result.fingerprint != run({**SKIN, **touch}).result.fingerprint


@pytest.mark.parametrize(("speed", "every_s"), [(0, 1.2), (0.1, 0.01), (0.002, 0.01), (1, 0.1)])
def test_plots_have_points_enough_for_who_looks_on(speed, every_s):
    made = simulated(SKIN, speed, duration_s=600.0)
    assert made._next_point_us == round(1e6 * every_s)
    made.carry_out(messages.Speed(0.5))
    assert made._next_point_us == 50_000


def test_moments_to_go_back_to_lie_over_the_whole_time():
    made = simulated(SKIN)
    made.run_to_end()
    kept = [mark.engine.now_us for mark in made._marks]
    assert 16 <= len(kept) <= 32
    assert kept[0] == 0
    assert max(b - a for a, b in zip(kept, [*kept[1:], 1_000_000], strict=True)) <= 2 * 40_000


def newest_point(made):
    return items(made, SERIES)[-1]


@pytest.mark.parametrize("speed", [0, 0.1])
def test_plots_tell_of_where_one_goes_holds_and_ends(speed):
    """And not only of the last of the moments at which points are made."""
    burst = {**RADIO, "duration_s": 60.0, "traffic": {"kind": "disaster"}}
    made = simulated(burst, speed)
    go_to(made, 0.14)
    assert newest_point(made).at_us == 140_000
    assert newest_point(made).what["throughput"] > 0
    made.carry_out(messages.Pause())
    assert [point.at_us for point in items(made, SERIES)].count(140_000) == 1
    made.carry_out(messages.Step())
    assert newest_point(made).at_us == 140_000  # too little has happened since
    go_to(made, 0.1)
    assert newest_point(made).at_us == 100_000
    made.run_to_end()
    assert 140_000 < newest_point(made).at_us == made.engine.now_us < 60_000_000
    go_to(made, 60.0)
    assert [point.at_us for point in items(made, SERIES)].count(made.engine.now_us) == 1
