"""What runs of a sweep have in common, what goes before a plan file, and how each run ends."""

import json
import math
import shlex
from pathlib import Path
from types import SimpleNamespace

import pytest

from innervate.running import RunError
from innervate.scenario import ScenarioError
from innervate.sweeping import SweepError, make_plan, planfile, scheduler, sweep, work
from innervate.sweeping import plan as plans
from innervate.sweeping.base import Base, base_of
from innervate.sweeping.scheduler import DEATHS_MAX, Scheduler
from innervate.sweeping.vary import Named
from innervate.sweeping.work import Job
from tests.sweeping.test_plan import SKIN

RADIO = {"kind": "radio", "stations": 3, "seed": 9}


def test_a_base_is_told_from_others_by_all_that_it_is():
    one = Base("text", "a.toml", "/here", (("k", 1),))
    marks = [
        one.mark(), Base("other", "a.toml", "/here", (("k", 1),)).mark(),
        Base("text", "a.toml", "/there", (("k", 1),)).mark(),
        Base("text", "a.toml", "/here", (("k", 2),)).mark(),
    ]  # fmt: skip
    assert len(set(marks)) == 4
    assert Base("text", "b.toml", "/here", (("k", 1),)).mark() == marks[0]


@pytest.mark.parametrize(
    ("value", "word"),
    [(3, "3"), (0.5, "0.5"), (True, "true"), ("paper", "paper"), ("3", '"3"'), (" x", '" x"'),
     ("true", '"true"'), ([1, 2], "[1, 2]"), ("a b", "a b")],
)  # fmt: skip
def test_the_command_of_a_run_has_all_that_differs_from_its_file(value, word):
    base = Base("text", "a.toml", "/here", (("first", 1),))
    words = shlex.split(base.command((("key", value),), 77))
    assert words == ["innervate", "run", "a.toml", "--set", "first=1", "--set", f"key={word}",
                     "--seed", "77"]  # fmt: skip


def test_settings_come_from_texts_and_from_tables():
    assert base_of(RADIO, ["a = 3", "b.c=x"]).settings == (("a", 3), ("b.c", "x"))
    assert base_of(RADIO, {"a": 3, "b": [1]}).settings == (("a", 3), ("b", [1]))
    with pytest.raises(ScenarioError, match="--set a: write it as key=value"):
        base_of(RADIO, ["a"])


@pytest.mark.parametrize("name", ["sweep", "jobs"])
def test_a_scenario_that_is_called_as_what_a_sweep_writes_keeps_its_name(tmp_path, name):
    path = tmp_path / {"sweep": "sweep.toml", "jobs": "jobs.sqlite"}[name]
    path.write_text('kind = "radio"\nstations = 3\n')
    base = base_of(path, {"stations": 4})
    assert base.file == "scenario.toml"
    assert base.settings == (("name", name), ("stations", 4))
    assert base.folder == str(tmp_path)
    assert base.scenario().name == name
    assert base.scenario([("stations", 5)], seed=6).seed == 6


def plan_file(tmp_path, text):
    (tmp_path / "team.toml").write_text('kind = "radio"\nstations = 3\nseed = 9\n')
    path = tmp_path / "plan.toml"
    path.write_text(f'scenario = "team.toml"\n{text}')
    return path


FILE = """\
name = "mine"
seed = 5
repeat = 3
batch = 2
until = "throughput.ci=5%"
paired = ["packet_slots"]
[set]
duration_s = 2.0
stations = 4
[vary]
packet_slots = [3, 5]
[derive]
channel.loss = "1 / 4"
"""


def test_what_is_said_goes_before_what_the_plan_file_says(tmp_path):
    path = plan_file(tmp_path, FILE)
    plain = make_plan(path)
    assert (plain.name, plain.root, plain.repeat, plain.batch) == ("mine", 5, 3, 2)
    assert plain.keys == ("packet_slots", "channel.loss")
    assert dict(plain.base.settings) == {"duration_s": 2.0, "stations": 4}
    assert plain.points[0].columns == {"packet_slots": 3, "channel.loss": 0.25}
    said = make_plan(path, seed=0, repeat=7, batch=4, until="x.ci=1", paired="all",
                     overrides={"stations": 6}, vary={"channel.loss": [0.0, 0.1]})  # fmt: skip
    assert (said.root, said.repeat, said.batch, said.paired) == (0, 7, 4, ("all",))
    assert [str(rule) for rule in said.until] == ["x.ci=1"]
    assert dict(said.base.settings) == {"duration_s": 2.0, "stations": 6}
    assert said.keys == ("packet_slots", "channel.loss"), "what is varied is not derived"
    assert len(said.points) == 4
    fixed = make_plan(path, overrides=["packet_slots=9"])
    assert fixed.keys == ("channel.loss",)
    derived = make_plan(path, derive={"channel.loss": "1 / 2"})
    assert derived.points[0].columns["channel.loss"] == 0.5


def test_a_plan_written_out_and_read_gives_the_same_points(tmp_path):
    path = plan_file(tmp_path, FILE.replace("[3, 5]", '[3, { name = "long", value = 25 }]'))
    plan = make_plan(path)
    (tmp_path / "again.toml").write_text(planfile.dump(plan))
    again = make_plan(tmp_path / "again.toml")
    assert [point.settings for point in again.points] == [point.settings for point in plan.points]
    assert [point.label for point in again.points] == [point.label for point in plan.points]
    assert plan.points[1].columns["packet_slots"] == "long"
    assert (again.root, again.repeat, again.batch, again.name) == (5, 3, 2, "mine")


def test_lists_of_a_plan_file_and_leaves_of_its_tables():
    assert planfile.listed("1..3, 7", "here") == [1, 2, 3, 7]
    assert planfile.listed(range(2), "here") == [0, 1]
    assert planfile.listed([{"name": "x", "value": 1}], "here") == [Named("x", 1)]
    other = {"name": "x", "value": 1, "more": 2}
    assert planfile.listed([other], "here") == [other]
    assert list(planfile.leaves({"a": {"b": 1, "c": {"d": 2}}, "e.f": 3})) == [
        ("a.b", 1), ("a.c.d", 2), ("e.f", 3),
    ]  # fmt: skip
    assert not planfile.is_plan("kind = 1")
    assert not planfile.is_plan("= broken")


@pytest.mark.parametrize(
    ("what", "changed"),
    [({}, []), ({"seed": 2}, ["the root seed"]), ({"paired": "all"}, ["what is paired"]),
     ({"overrides": {"duration_s": 0.3}}, ["what --set says"]), ({"repeat": 5}, []),
     ({"vary": {"protocol.k": [2]}}, [])],
)  # fmt: skip
def test_what_may_not_change_between_two_parts_of_a_sweep(what, changed):
    one, other = make_plan(SKIN, seed=1).identity(), make_plan(SKIN, **{"seed": 1, **what})
    differ = [name for name, mark in other.identity().items() if one[name] != mark]
    assert differ == changed


@pytest.fixture
def ran(monkeypatch):
    """Runs in name only: their scenarios, and what comes of each."""
    seen, comes = [], {}

    def run(scenario, received):
        seen.append((scenario.seed, scenario.model.protocol.k))
        error = comes.get(scenario.seed)
        if error is not None:
            raise error
        x = math.nan if scenario.seed == 98 else scenario.seed
        return SimpleNamespace(interrupted=scenario.seed == 99, summary={"x": x})

    monkeypatch.setattr(work.runs, "run", run)
    monkeypatch.setattr(work, "_kept", work.OrderedDict())
    return seen, comes


def job(repeat, seed, k=3):
    return Job(f"k{k}", (("protocol.k", k),), repeat, seed)


def test_every_run_has_its_points_settings_and_its_own_seed(ran):
    seen, comes = ran
    comes |= {12: RunError("no\n  port"), 13: MemoryError(), 14: ValueError("x" * 900)}
    base = base_of(SKIN, {"protocol.k": 9})
    done = work.run_batch(base, [job(0, 10), job(1, 11), job(0, 12, k=4), job(1, 13), job(2, 14)])
    assert seen == [(10, 3), (11, 3), (12, 4), (13, 3), (14, 3)]
    assert [json.loads(one.row) if one.row else None for one in done.outcomes] == [
        {"x": 10}, {"x": 11}, None, None, None,
    ]  # fmt: skip
    reasons = [one.reason for one in done.outcomes]
    assert reasons[:4] == ["", "", "no port", "not enough memory"]
    assert reasons[4] == ("ValueError: " + "x" * 900)[: work.REASON_MAX]
    assert [(one.point, one.repeat, one.seed) for one in done.outcomes][2] == ("k4", 0, 12)
    with pytest.raises(KeyboardInterrupt):
        work.run_batch(base, [job(0, 99)])
    other = work.run_batch(base_of(SKIN, {"duration_s": 0.1}), [job(0, 20)])
    assert other.outcomes[0].seed == 20
    assert len(work._kept) == 3, "of another base it is another scenario"


def test_a_run_with_a_figure_that_is_no_number_fails_and_names_it(ran):
    fine, strange = work.run_batch(base_of(SKIN, ()), [job(0, 97), job(1, 98)]).outcomes
    assert (json.loads(fine.row), fine.reason) == ({"x": 97}, "")
    assert (strange.row, strange.reason) == (None, "its x is nan, no finite number")


def test_scenarios_of_the_newest_points_are_kept(ran, monkeypatch):
    monkeypatch.setattr(work, "SCENARIOS_KEPT", 2)
    base = base_of(SKIN, ())
    work.run_batch(base, [job(0, k, k=k) for k in (2, 3, 4)])
    assert [point for _, point in work._kept] == ["k3", "k4"]


def conducted(deaths, together=True):
    """A scheduler whose workers died with some batches so often, and what it has in mind."""
    plan = make_plan(SKIN, repeat=4)
    renewed, kept = [], []
    engine = SimpleNamespace(renew=lambda: renewed.append(1))
    made = Scheduler(plan, SimpleNamespace(), engine)
    made._keep = lambda done: kept.extend(done.outcomes)
    for batch in deaths:
        made._suspects.clear()
        made._isolate([[Job("p", (), repeat, 1) for repeat in one] for one in batch])
    return [one.repeat for one in made._suspects], kept, len(renewed)


def test_a_run_is_given_up_when_its_worker_has_died_so_often_with_it_alone():
    assert conducted([[[0, 1]]] * 9) == ([0, 1], [], 9), "it may be the other's fault"
    assert conducted([[[0], [1]]] * 9) == ([0, 1], [], 9)
    alone = [[0]]
    assert conducted([alone] * (DEATHS_MAX - 1)) == ([0], [], DEATHS_MAX - 1)
    left, kept, renewed = conducted([alone] * DEATHS_MAX)
    assert (left, [one.repeat for one in kept], renewed) == ([], [0], DEATHS_MAX)
    assert kept[0].row is None
    assert kept[0].reason == "its worker died 3 times, killed or out of memory"


def test_what_is_suspected_goes_alone_before_all_else():
    made = Scheduler(make_plan(SKIN, repeat=9), SimpleNamespace(), SimpleNamespace(ahead=4))
    given = []
    made._submit = lambda jobs: (
        given.append([one.repeat for one in jobs]) or made._running.update({len(given): jobs})
    )
    made._ready.extend((made.states[0], repeat) for repeat in range(5))
    made._suspects.extend(Job("p", (), repeat, 1) for repeat in (7, 8))
    assert made._hand_out()
    assert made._hand_out()
    assert given == [[7]], "one at a time"
    made._running.clear()
    assert made._hand_out()
    made._running.clear()
    assert made._hand_out()
    assert given == [[7], [8], [0], [1], [2], [3]]
    assert scheduler.BATCH_MAX == 500


def test_a_plan_is_checked_by_its_first_points_and_goes_on_past_those_that_cannot_be(tmp_path):
    some = {"protocol.k": [0, 0.5, 3]}
    plan = sweep_checked(make_plan({**SKIN, "seed": 4}, vary=some))
    assert plan.root == 4
    assert sweep_checked(make_plan({**SKIN, "seed": 4}, vary=some, seed=7)).root == 7
    with pytest.raises(ScenarioError, match=r"protocol\.k"):
        sweep_checked(make_plan(SKIN, vary={"protocol.k": [0, -1]}))
    for name, is_ours in (("other.txt", False), ("jobs.sqlite", True)):
        folder = tmp_path / name.partition(".")[0]
        folder.mkdir()
        (folder / name).touch()
        if is_ours:
            module()._prepare(folder)
        else:
            with pytest.raises(SweepError, match="no sweep's folder and not empty"):
                module()._prepare(folder)


def module():
    from importlib import import_module

    return import_module(sweep.__module__)


def sweep_checked(plan):
    return module()._checked(plan)[0]


def test_paths_of_a_scenario_are_made_full_but_for_those_that_are_varied(tmp_path, monkeypatch):
    (tmp_path / "links.json").write_text("{}")
    base = Base("text", "a.toml", str(tmp_path), (("network.file", "links.json"), ("k", 1)))
    plain = {"network": {"file": "links.json"}, "nodes": [{"file": "x"}], "k": 1}
    full = {"network": {"file": "/full/links.json"}, "nodes": [{"file": "/full/x"}], "k": 2}
    from innervate.sweeping import base as room

    monkeypatch.setattr(room.msgspec, "to_builtins", lambda _: plain)
    monkeypatch.setattr(room.tomllib, "loads", lambda _: full)
    monkeypatch.setattr(room.scenarios, "dump", lambda _: "")
    monkeypatch.setattr(room.scenarios, "loads", lambda *_: SimpleNamespace(model=None))
    moved = (("k", 1), ("network.file", "/full/links.json"), ("nodes.0.file", "/full/x"))
    assert base.anywhere(()).settings == moved
    assert base.anywhere((("network.file", "y"),)).settings == (
        ("network.file", "links.json"), ("k", 1), ("nodes.0.file", "/full/x"),
    )  # fmt: skip
    assert Path(base.folder) == tmp_path


def test_seeds_are_the_first_bits_of_a_streams_first_number_and_no_others():
    plan = make_plan(SKIN, seed=3)
    (point,) = plan.points
    number = plans.stream(3, f"sweep/{point.stream}/4").next64()
    assert plan.seed(point, 4) == number >> 16


@pytest.mark.parametrize(("until", "blocks"), [
    ((), [(0, 25)]), ("x.ci=5%", [(0, 10), (10, 20), (20, 25)]),
])  # fmt: skip
def test_repeats_are_decided_on_in_batches(until, blocks):
    plan = make_plan(SKIN, repeat=25, until=until)
    assert list(plans.blocks(plan)) == blocks
    assert plan.first_block == blocks[0][1]
    assert make_plan(SKIN, repeat=4, until="x.ci=5%").first_block == 4


def test_repeats_are_a_thousand_at_most_if_nobody_says_how_many():
    """docs/sweeps.md: `--repeat` is then the most, 1,000 if left out."""
    assert make_plan(SKIN, until="x.ci=5%").repeat == 1000
    assert make_plan(SKIN).repeat == 1


def test_how_many_runs_there_will_be_is_no_more_than_may_be():
    plan = make_plan(SKIN, repeat=50, until="x.ci=1")
    made = Scheduler(plan, SimpleNamespace(), SimpleNamespace())
    (state,) = made.states
    state.goal, state.values = 10, {"x": {k: 100.0 * (k % 2) for k in range(10)}}
    assert made.total == 50
    state.values = {"x": dict.fromkeys(range(10), 1.0)}
    assert made.total == 10
    state.values = {"x": {k: 4.0 * (k % 2) for k in range(10)}}
    needed = made.plan.until[0].needed(state.series("x"))
    assert 10 < needed == made.total < 50
    state.finished = True
    assert made.total == 10


class Died(Exception):
    """A worker died."""


@pytest.mark.parametrize(("together", "lost"), [(True, [0, 1]), (False, [0])])
def test_with_a_worker_all_batches_under_way_may_be_lost(monkeypatch, together, lost):
    engine = SimpleNamespace(died=(Died,), falls_together=together, look_s=None,
                             renew=lambda: None)  # fmt: skip
    made = Scheduler(make_plan(SKIN, repeat=4), SimpleNamespace(), engine)
    futures = []
    for repeat in range(2):
        future = scheduler.Future()
        future.set_exception(Died())
        made._running[future] = [Job("p", (), repeat, 1)]
        futures.append(future)

    def wait(running, timeout=None, return_when=None):
        return (set(futures[:1]) if return_when else set(running)), set()

    monkeypatch.setattr(scheduler, "wait", wait)
    made._collect()
    assert [job.repeat for job in made._suspects] == lost
    assert len(made._running) == 2 - len(lost)
    assert made.left_s is None, "nothing has run yet"


@pytest.mark.parametrize(("line", "says"), [
    (f"name = {'[' * 400}{']' * 400}", "3: name.0.0... is nested too deeply"),
    (f"vary.a = {'[' * 18}{']' * 18}", "3: vary.a.0... is nested too deeply"),
    (f"seed = {2**63}", "3: seed must be a number below 2^63"),
    ("set.duration_s = nan", "3: set.duration_s must be a finite number, not nan"),
])  # fmt: skip
def test_what_no_scenario_can_hold_is_refused_in_a_plan_file_too(line, says):
    with pytest.raises(ScenarioError) as caught:
        planfile.read(f'scenario = "a.toml"\n\n{line}\n', "p.toml")
    assert str(caught.value) == f"p.toml:{says}"
    assert planfile.read(f'scenario = "a.toml"\nseed = {2**63 - 1}\n', "").seed == 2**63 - 1
