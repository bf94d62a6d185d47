import json
import re
import signal

import pytest

import innervate
from innervate import scenario
from innervate.networks.skin import run as skin
from innervate.running import RunError, run
from innervate.scenario import ScenarioError
from tests.fixtures.loading import loaded_by


@pytest.mark.parametrize("how", ["dict", "scenario", "file", "path"])
def test_takes_what_a_scenario_may_be(four, tmp_path, how):
    made = scenario.from_dict(four())
    file = tmp_path / "four.toml"
    file.write_text(scenario.dump(made))
    given = {"dict": four(), "scenario": made, "file": str(file), "path": file}[how]
    assert run(given).summary["fingerprint"] == run(four()).summary["fingerprint"]


def test_bundled_names():
    assert run("line", overrides={"duration_s": 2.1}).summary["name"] == "line"


def test_same_seed_same_run(four):
    runs = [run(four(), seed=seed).summary["fingerprint"] for seed in (5, 5, 6)]
    assert runs[0] == runs[1] != runs[2]


@pytest.mark.parametrize("overrides", [["protocol.k=3"], {"protocol.k": 3}])
def test_overrides_of_every_kind(four, overrides):
    made = scenario.from_dict(four())
    for given in (made, four()):
        done = run(given, overrides=overrides, seed=9)
        assert (done.plan.params["k"], done.plan.seed) == (3, 9)
    assert made.model.protocol.k is None


def test_wrong_scenarios_pass_their_error_through(four, tmp_path):
    with pytest.raises(ScenarioError, match="durations"):
        run(four(durations=1), out=tmp_path / "x")
    with pytest.raises(ScenarioError):
        run("no-such-scenario")
    assert list(tmp_path.iterdir()) == []


def test_wrong_folder_is_found_out_before_the_run(four, tmp_path):
    (tmp_path / "letters.txt").write_text("dear")
    seen = []
    with pytest.raises(RunError, match="not a run folder"):
        run(four(), out=tmp_path, progress=lambda now, end: seen.append(now))
    assert not seen


def test_tables(four):
    done = run(four())
    names = ["routes", "links", "outages", "loops", "received"]
    assert list(done.tables) == names
    frames = {name: table.collect() for name, table in done.tables.items()}
    assert frames["received"].height == done.summary["data"]["delivered"]
    assert frames["received"]["cell"].unique().sort().to_list() == [0, 1, 2, 3]
    assert frames["links"].filter("broken")["to"].to_list()[-1] == 4
    assert frames["outages"]["unrouted"].to_list()[-1] == 0
    assert frames["routes"]["new"].is_between(-1, 3).all()


def test_samples_are_kept_as_asked(four):
    assert run(four(), received=False).tables["received"].collect().height == 0
    assert run(four(data={"rate_hz": 0})).tables["received"].collect().height == 0
    huge = scenario.plan(scenario.from_dict(four(duration_s=10_000.0)))
    assert skin.samples(huge) > skin.RECEIVED_MAX


def test_images(four):
    done = run(four(touch={"path": [(0.0, 0.0, 0.0)]}))
    assert done.received_image(0.29).known.all()


def test_folder(four, tmp_path, page):
    done = run(four(), out=tmp_path / "deep" / "er" / "run")
    folder = tmp_path / "deep" / "er" / "run"
    assert done.written == folder
    assert sorted(path.name for path in folder.iterdir()) == [
        "links.parquet", "loops.parquet", "outages.parquet", "provenance.json", "received.parquet",
        "report.html", "routes.parquet", "scenario.toml", "summary.json",
    ]  # fmt: skip
    assert json.loads((folder / "summary.json").read_text()) == done.summary
    assert (folder / "report.html").read_text() == "<html>four</html>"
    again = run(folder / "scenario.toml")
    assert again.summary["fingerprint"] == done.summary["fingerprint"]


def test_provenance_says_how_to_get_it_again(four, tmp_path, page):
    run(four(), seed=12, out=tmp_path / "a")
    said = json.loads((tmp_path / "a" / "provenance.json").read_text())
    assert said["innervate"] == innervate.__version__
    assert said["seeds"] == [12]
    assert said["fingerprint"] == run(four(), seed=12).summary["fingerprint"]
    assert set(said["packages"]) >= {"numba", "numpy", "polars"}
    assert str(tmp_path) not in json.dumps(said)


def test_no_samples_no_table_of_them(four, tmp_path, page):
    run(four(), out=tmp_path / "a", received=False)
    assert not (tmp_path / "a" / "received.parquet").exists()


def test_default_folder(four, tmp_path, page, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(four(), seed=3).write().as_posix() == "runs/four-3"
    assert (tmp_path / "runs" / "four-3" / "summary.json").exists()


def test_an_interrupted_run_keeps_what_was_done(four, tmp_path, page, monkeypatch):
    from innervate.networks.skin.sim import simulate as simulation

    loop = simulation.compiled_loop(False)

    def interrupted(world, until, budget):
        loop(world, until, 1200)
        if until > 0:  # the call that only loads the loop comes before anything can be kept
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(simulation, "compiled_loop", lambda static: interrupted)
    early = [{"at_s": 0.1, "action": "cut", "interface": 1}]
    done = run(four(event=early), out=tmp_path / "a")
    assert done.interrupted
    summary = json.loads((tmp_path / "a" / "summary.json").read_text())
    assert 0.1 < summary["interrupted_at_s"] < 0.5
    assert summary["duration_s"] == 0.5
    assert len(summary["recoveries"]) == 1
    assert json.loads((tmp_path / "a" / "provenance.json").read_text())["interrupted"] is True


def test_import_innervate_stays_cheap():
    assert loaded_by("import innervate", "numba", "numpy") == []


def test_running_needs_neither_polars_nor_matplotlib():
    assert loaded_by("import innervate; innervate.run('line')", "polars", "matplotlib") == []


@pytest.mark.parametrize("name", ["line", "radio-disaster"])
def test_tables_for_numpy_and_pandas(name):
    done = run(name, overrides={"duration_s": 2.5})
    for name, table in done.tables.items():
        whole = table.collect()
        arrays, frame = done.numpy(name), done.pandas(name)
        assert list(arrays) == list(frame.columns) == whole.columns
        assert all(len(column) == whole.height == len(frame) for column in arrays.values())
    with pytest.raises(RunError, match="there is no table 'roots'; there are "):
        done.numpy("roots")


@pytest.mark.parametrize(("more", "says"), [
    ({"overrides": {"protocol.k": 0}}, "override protocol.k=0: protocol.k must be a whole number"),
    ({"overrides": "protocol.k"}, "override protocol.k: write it as key=value"),
    ({"seed": -1}, "override seed=-1: seed must be a whole number from 0, not -1"),
])  # fmt: skip
def test_a_wrong_override_is_not_called_by_the_option_of_a_command(more, says):
    with pytest.raises(ScenarioError, match=f"^{re.escape(says)}"):
        run("line", **more)


def test_nor_where_it_is_found_wrong_later():
    loaded = innervate.load("line", overrides={"data.rate_hz": 1})
    assert str(loaded.source.error(("data", "rate_hz"), "no")) == "override data.rate_hz=1: no"
