"""What cannot be done is said before anything is done, and by the name that the user gave it."""

import builtins
import re
from types import SimpleNamespace as Of

import polars
import pytest

from innervate import scenario
from innervate.cli import capturing, errors, exporting, files, live, main, running, sizing
from innervate.cli.options import ExportOptions, SizeOptions, UpOptions
from innervate.export import recording
from innervate.network import networks
from innervate.running import folder as folders
from innervate.sweeping import SweepError, sweep
from tests.networks.skin.runs import line, patch, plan_of

TABLES = line(3, duration_s=0.05)


@pytest.mark.parametrize("seconds", [-3.0, float("nan"), float("inf")])
def test_live_commands_end_after_a_time_that_can_be(seconds):
    for command in (lambda: live.up("line", options=UpOptions(for_s=seconds)),
                    lambda: capturing.capture(for_=seconds)):  # fmt: skip
        with pytest.raises(errors.UserError, match="--for must be a number of seconds from 0"):
            command()


@pytest.mark.parametrize(("words", "said"), [
    (["--slot-us", "0"], "a slot of 0 us cannot be; 2000 to 1000000 us can"),
    (["--slot-us", "-1"], "a slot of -1 us cannot be"),
    (["--slot-us", "1999"], "a slot of 1999 us cannot be"),
    (["--slot-us", "1000001"], "a slot of 1000001 us cannot be"),
    (["--slot-us", "1" + 300 * "0"], "a slot of 1000000000"),
    (["--turnaround-us", "-1"], "a turnaround of -1 us cannot be; 0 to 10000000 us can"),
    (["--turnaround-us", "10000001"], "a turnaround of 10000001 us cannot be"),
])  # fmt: skip
def test_a_channel_has_slots_and_turnarounds_that_can_be_kept(words, said, capfd):
    assert main(["live", "medium", "127.0.0.1:0", *words]) == 2
    err = capfd.readouterr().err
    assert err.startswith(f"innervate: medium: {said}")
    assert err.count("\n") == 1


def test_a_missing_package_is_said_before_the_simulation(monkeypatch, tmp_path):
    real = builtins.__import__

    def without_mcap(name, *rest, **more):
        if name.startswith("mcap"):
            raise ModuleNotFoundError("No module named 'mcap'", name="mcap")
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without_mcap)
    monkeypatch.setattr(exporting._Source, "_frames", lambda _self: pytest.fail("simulated"))
    with pytest.raises(ModuleNotFoundError, match="mcap"):
        exporting.export("line", wanted=ExportOptions(mcap=tmp_path / "run.mcap"))


def test_every_bundled_scenario_has_a_whole_sentence(capsys):
    files.scenarios(as_json=False)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(scenario.bundled())
    for text in lines:
        assert re.fullmatch(r"[\w-]+ +[A-Z].*\.", text), text
    assert "exactly d-1 periods after the first has noticed." in "\n".join(lines)


def test_the_log_of_a_recording_says_whom(tmp_path):
    event = [{"at_s": [0.01, 0.04], "action": "kill", "random": "cell"},
             {"at_s": 0.04, "action": "cut", "interface": 0}]  # fmt: skip
    plan = plan_of(patch(3, 2, (0, 0), duration_s=0.05, event=event))
    told = [content["message"] for _, content in recording.events(plan)]
    who = plan.graph.label(next(fault.node for fault in plan.faults if fault.node >= 0))
    assert told == [f"kill {who}", f"cut pc.0 - {plan.graph.label_end(plan.graph.peer[24])}"]


def test_a_sweep_that_cannot_start_leaves_no_folder(tmp_path):
    target = tmp_path / "sweep"
    with pytest.raises(SweepError, match="0 workers cannot run anything"):
        sweep(TABLES, vary={"protocol.k": [2, 3]}, out=target, workers=0)
    assert not target.exists()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"rate": [250.0, -1.0]}, "--rate must be 0.01 to 10000, not -1"),
        ({"reach": 0.0}, "--reach must be 0.001 to 100000, not 0"),
        ({"pitch": 0.0}, "--pitch must be 0.5 to 100000, not 0"),
        ({"loss": 200.0}, "--loss must be 0 to 100, not 200"),
        ({"recovery": -1.0}, "--recovery must be 0.001 to 1e+09, not -1"),
    ],
)
def test_size_names_the_option(given, message):
    with pytest.raises(errors.UserError, match=re.escape(message)):
        sizing.size("none.urdf", options=SizeOptions(links="*", ports="1", **given))


def test_a_run_of_other_settings_is_kept(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def free(**keys):
        return folders.free_folder(scenario.from_dict({**TABLES, "name": "a", **keys}))

    first = free()
    assert first.as_posix() == "runs/a-1"
    first.mkdir(parents=True)
    (first / folders.SCENARIO).write_text(
        scenario.dump(scenario.from_dict({**TABLES, "name": "a"})), encoding="utf-8"
    )
    assert free() == first  # the same again is replaced
    assert free(duration_s=0.06).as_posix() == "runs/a-1-2"
    (first / folders.SCENARIO).write_text("no scenario", encoding="utf-8")
    assert free().as_posix() == "runs/a-1-2"


def test_a_figure_of_a_sweep_says_over_what_it_takes_means():
    done = sweep(TABLES, vary={"protocol.k": [2, 3], "protocol.beacon_hz": [100, 200]}, workers=1)
    assert done.averaged("protocol.k") == {"protocol.beacon_hz": 2}
    assert done.averaged("protocol.k", "protocol.beacon_hz") == {}
    measure = "start_up.routed_ms"
    drawn = done.plot("protocol.k", measure)
    assert "means over 2 values of protocol.beacon_hz" in drawn.axes[0].get_xlabel()
    alone = done.plot("protocol.k", measure, by="protocol.beacon_hz")
    assert "means over" not in alone.axes[0].get_xlabel()


@pytest.mark.parametrize(("given", "seed"), [(None, 1), (0, 0), (7, 7)])
def test_a_size_is_of_the_seed_that_was_given_or_of_the_first(tmp_path, monkeypatch, given, seed):
    asked, room = [], next(one.sizing for one in networks().values() if one.has("sizing"))
    answer = Of(
        sweep=Of(failed=polars.DataFrame({"reason": []})),
        lines=lambda: ["two are enough"],
        draw=lambda folder: folder / "a.svg",
        needed={250.0: 2},
    )
    monkeypatch.setattr(room, "size", lambda question, **how: asked.append(how) or answer)
    options = SizeOptions(links="*", ports="1..2", seed=given, repeat=5, out=tmp_path / "o")
    assert sizing.size("arm.urdf", options=options) == 0
    assert [(how["seed"], how["repeat"], how["out"]) for how in asked] == [
        (seed, 5, tmp_path / "o")]  # fmt: skip


@pytest.mark.parametrize(("quiet", "is_quiet"), [((), False), ((True,), True), ((False,), False)])
def test_a_run_says_how_far_it_is_unless_it_is_to_be_quiet(tmp_path, monkeypatch, quiet, is_quiet):
    shown = []

    class Display:
        def __init__(self, is_compiled, is_quiet):
            shown.append(is_quiet)

        def __enter__(self):
            return lambda now_us, duration_us: None

        def __exit__(self, *why):
            pass

    monkeypatch.setattr(running, "Progress", Display)
    monkeypatch.setattr("innervate.running.run", lambda loaded, progress, **how: "done")
    assert running.simulate("setup-1", [], None, tmp_path / "out", *quiet) == "done"
    assert shown == [is_quiet]
