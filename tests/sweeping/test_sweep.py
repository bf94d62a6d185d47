"""What a sweep's table says, and what is said when it cannot be made."""

import json
import os
import resource
import shlex
import signal
import sqlite3
import subprocess
import sys
import threading
from contextlib import suppress
from multiprocessing import forkserver
from pathlib import Path

import pytest

import innervate
from innervate.cli import main
from innervate.scenario import ScenarioError
from innervate.sweeping import SweepError, engines
from innervate.sweeping.flat import flat
from innervate.sweeping.jobs import Jobs
from innervate.sweeping.sweep import _writing
from innervate.sweeping.words import headline_lines
from tests.sweeping.conftest import TIMEOUT_S, environment, start, until

VARY = {"protocol.k": [2, 4]}


def figures(row):
    aside = ("point", "repeat", "status", "reason", "command", "protocol.k")
    return {k: v for k, v in row.items() if k not in aside}


def test_rows_are_the_runs(four):
    done = innervate.sweep(four, vary=VARY, repeat=2, seed=3, workers=1)
    assert done.results.select("point", "repeat").rows() == [(0, 0), (0, 1), (1, 0), (1, 1)]
    for row in done.results.iter_rows(named=True):
        run = innervate.run(four, seed=row["seed"], overrides={"protocol.k": row["protocol.k"]})
        expected = flat(run.summary) | {"seed": row["seed"]}
        assert figures(row) == {name: expected.get(name) for name in figures(row)}
        assert row["fingerprint"] == run.summary["fingerprint"]
    assert set(done.timings.columns) >= {"point", "repeat", "wall_s", "began_s", "host", "python"}


def test_other_kinds_go_through_the_same_door(four):
    done = innervate.sweep("radio-disaster", vary={"stations": "2..4"}, repeat=2, workers=1)
    assert done.failed.height == 0
    assert done.results["stations"].to_list() == [2, 2, 3, 3, 4, 4]
    assert done.results["throughput"].min() > 0
    assert set(done.results["headline.level"]) == {"ok"}
    assert headline_lines(done) == []


def test_latencies_are_those_of_a_run_whatever_the_network():
    """Babel's summary and measures are made of the rows of what was delivered."""
    done = innervate.sweep("babel-patch", repeat=1, workers=1)
    run = innervate.run("babel-patch", seed=done.results["seed"][0])
    latency = run.summary["messages"]["latency_ms"]
    assert latency["p50"] > 0
    row = done.results.row(0, named=True)
    assert {word: row[f"messages.latency_ms.{word}"] for word in latency} == latency


def test_runs_that_are_not_well_are_said(four):
    vary = {"duration_s": [60, 0.101]}
    done = innervate.sweep("radio-disaster", vary=vary, repeat=2, workers=1)
    assert done.results["headline.level"].to_list() == ["ok", "ok", "down", "down"]
    seed = done.results["seed"][2]
    assert headline_lines(done) == [
        f"2 of 4 runs: down; the first, point 1 with seed {seed}: "
        "Nothing got through; of 10 packets none was delivered."
    ]


def test_a_rows_command_runs_it_again(four, capsys):
    vary = {"protocol.k": [4], "interface": [[{"row": 0, "column": 0}, {"row": 0, "column": 3}]]}
    done = innervate.sweep(four, vary=vary, repeat=2, out="out", overrides=["data.rate_hz=50"])
    row = done.results.row(1, named=True)
    words = shlex.split(row["command"])
    assert words[:2] == ["innervate", "run"]
    os.chdir("out")
    assert main([*words[1:], "--json", "--no-report"]) == 0
    assert json.loads(capsys.readouterr().out)["fingerprint"] == row["fingerprint"]


def test_a_failed_run_is_a_row_with_its_reason(four):
    done = innervate.sweep(four, vary={"protocol.k": [0, 3, 1000]}, repeat=2, workers=1)
    assert done.results["status"].to_list() == ["failed"] * 2 + ["done"] * 2 + ["failed"] * 2
    assert set(done.failed["reason"]) == {
        "--vary protocol.k=0: protocol.k must be a whole number of missed beacons, 1 to 94, not 0",
        "--vary protocol.k=1000: protocol.k must be at most 94, not 1000",
    }
    assert done.complete


def test_failed_runs_are_run_again_if_asked_for(four):
    innervate.sweep(four, vary={"protocol.k": [0, 3]}, repeat=2, out="out", workers=1)
    again = innervate.sweep(four, vary={"protocol.k": [0, 3]}, repeat=2, out="out", workers=1)
    assert again.ran == 0
    retried = innervate.sweep(
        four, vary={"protocol.k": [0, 3]}, repeat=2, out="out", workers=1, retry=True
    )
    assert retried.ran == 2


def test_more_values_and_repeats_run_only_what_is_new(four):
    first = innervate.sweep(four, vary=VARY, repeat=2, out="out", workers=1)
    more = innervate.sweep(four, vary={"protocol.k": "2..4"}, repeat=3, out="out", workers=1)
    assert (first.ran, more.ran) == (4, 5)
    fresh = innervate.sweep(four, vary={"protocol.k": "2..4"}, repeat=3, workers=1)
    assert more.results.equals(fresh.results)
    less = innervate.sweep(four, vary={"protocol.k": [3]}, repeat=1, out="out", workers=1)
    assert (less.ran, less.results.height) == (0, 1)


def test_until_ends_a_point_where_its_interval_is_narrow(four):
    rules = {"until": "recoveries.routed_ms.ci=6%", "repeat": 60, "batch": 5}
    done = innervate.sweep(four, vary=VARY, workers=1, **rules)
    for point in done.plan.points:
        values = done.results.filter(done.results["point"] == point.index)["recoveries.routed_ms"]
        (rule,) = done.plan.until
        counts = [n for n in range(5, 61, 5) if rule.met(values[:n].to_list())]
        assert len(values) == (counts[0] if counts else 60)
    assert done.results.height < 120
    widest = done.points("recoveries.routed_ms")
    assert all((widest["high"] - widest["low"]) / 2 <= 0.06 * widest["mean"])


def test_a_rule_about_a_figure_that_runs_do_not_have(four):
    with pytest.raises(SweepError, match=r'did you mean "recoveries\.routed_ms"'):
        innervate.sweep(four, until="recoveries.routed.ci=5%", workers=1)
    some = r'no figure "zzz"; it knows balance_factor, .*, commands\.delivered, and \d+ more$'
    with pytest.raises(SweepError, match=some):
        innervate.sweep(four, until="zzz.ci=5%", workers=1)


@pytest.mark.parametrize(("vary", "sets", "option"), [
    (["nothing.k=1"], [], "--vary nothing.k=1: a scenario has no key"),
    (["protocol.k=3"], ["nothing.k=1"], "--set nothing.k=1: a scenario has no key"),
])  # fmt: skip
def test_a_key_that_is_none_is_told_by_the_option_that_names_it(four, vary, sets, option):
    with pytest.raises(ScenarioError) as caught:
        innervate.sweep(four, vary=vary, overrides=sets, workers=1)
    assert str(caught.value).startswith(option)


def test_no_valid_point_is_the_scenarios_error(four):
    with pytest.raises(ScenarioError, match='did you mean "k"'):
        innervate.sweep(four, vary={"protocol.kk": [2, 3]}, out="out")
    assert not Path("out").exists()


@pytest.mark.parametrize(("change", "words"), [
    (lambda path: path.write_text(path.read_text().replace("0.4", "0.5")), "the scenario changed"),
    (lambda path: {"overrides": ["data.rate_hz=10"]}, "what --set says changed"),
    (lambda path: {"seed": 9}, "the root seed changed"),
    (lambda path: {"paired": "all"}, "what is paired changed"),
], ids=["scenario", "set", "seed", "paired"])  # fmt: skip
def test_a_changed_sweep_is_not_mixed_with_what_is_there(four, change, words):
    innervate.sweep(four, vary=VARY, out="out", workers=1)
    before = {path.name: path.read_bytes() for path in Path("out").iterdir()}
    changed = change(four)
    with pytest.raises(SweepError, match=words):
        innervate.sweep(four, vary=VARY, out="out", workers=1,
                        **(changed if isinstance(changed, dict) else {}))  # fmt: skip
    assert {path.name: path.read_bytes() for path in Path("out").iterdir()} == before


def test_a_file_that_the_scenario_names_is_a_part_of_it(four):
    """Edited since, it gives other runs; one that is only varied may come later."""
    links = {name: four.parent / f"{name}.txt" for name in ("one", "other")}
    for path in links.values():
        path.write_text("n0 n1 0.9\nn1 n2 0.9\nn0 n2 0.9\n")
    mesh = {"kind": "mesh", "duration_s": 0.1, "import": {"file": "one.txt"}}
    vary = {"protocol.retry": [True]}
    innervate.sweep(mesh, vary=vary, out="out", workers=1)
    assert innervate.sweep(mesh, vary=vary, out="out", workers=1).ran == 0
    links["one"].write_text("n0 n1 0.5\nn1 n2 0.9\nn0 n2 0.9\n")
    with pytest.raises(SweepError, match=r"the file .*/one\.txt changed since the sweep in out"):
        innervate.sweep(mesh, vary=vary, out="out", workers=1)
    varied = {"import.file": ["other.txt"]}
    innervate.sweep(mesh, vary=varied, out="varied", workers=1)
    varied["import.file"].append("one.txt")
    assert innervate.sweep(mesh, vary=varied, out="varied", workers=1).ran == 1
    links["other"].write_text(links["one"].read_text())
    with pytest.raises(SweepError, match=r"the file .*/other\.txt changed"):
        innervate.sweep(mesh, vary=varied, out="varied", workers=1)


def test_folders_that_cannot_be_used(four):
    Path("full").mkdir()
    Path("full/notes.txt").write_text("mine")
    with pytest.raises(SweepError, match="not empty"):
        innervate.sweep(four, out="full", workers=1)
    assert [path.name for path in Path("full").iterdir()] == ["notes.txt"]
    with pytest.raises(SweepError, match=r"four\.toml/x cannot be used"):
        innervate.sweep(four, out="four.toml/x", workers=1)
    Path("odd").mkdir()
    Path("odd/jobs.sqlite").write_bytes(b"no database" * 100)
    with pytest.raises(SweepError, match="no job table, or damaged"):
        innervate.sweep(four, out="odd", workers=1)


def test_a_read_only_folder_is_one_line(four):
    innervate.sweep(four, vary=VARY, out="fixed", workers=1)
    for path in [*Path("fixed").iterdir(), Path("fixed"), four.parent]:
        path.chmod(0o755 if path == four.parent else 0o555)
    before = {path.name: path.read_bytes() for path in Path("fixed").iterdir()}
    code = (  # root may write everywhere, so it becomes nobody once everything is loaded
        "import os, sys, innervate.sweeping.work, innervate.sweeping.sweep\n"
        "from innervate.cli import app, main, sweeping\n"
        "main(['sweep', 'four.toml', '--out', 'other', '--workers', '1'])\n"
        "if os.geteuid() == 0: os.setgid(65534); os.setuid(65534)\n"
        "sys.exit(main(sys.argv[1:]))"
    )
    tokens = ("sweep", "four.toml", "--vary", "protocol.k=2..9", "--workers", "1", "--out", "fixed")
    done = subprocess.run([sys.executable, "-c", code, *tokens], cwd=four.parent, text=True,
                          env=environment(), capture_output=True, timeout=TIMEOUT_S,
                          check=False)  # fmt: skip
    assert done.returncode == 2, done.stderr
    assert done.stderr.count("\n") == 1
    assert "no permission to write in fixed" in done.stderr
    assert {path.name: path.read_bytes() for path in Path("fixed").iterdir()} == before


def test_a_full_disk_is_one_line_and_loses_nothing(four):
    """No file may grow beyond 150 kB: what SQLite does then is what it does on a full disk."""
    command = ("sweep", "four.toml", "--vary", "protocol.k=2..5", "--repeat", 60, "--workers", 1,
               "--out", "out")  # fmt: skip
    limit = (150_000, 150_000)

    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)

    process = start(*command, cwd=four.parent, preexec_fn=limited)
    _, err = process.communicate(timeout=TIMEOUT_S)
    assert process.returncode == 2
    assert "no space left on the disk, or it fails" in err
    assert "Traceback" not in err
    with sqlite3.connect("out/jobs.sqlite") as db:
        (kept,) = db.execute("SELECT count(*) FROM runs").fetchone()
    db.close()
    assert 0 < kept < 240
    done = innervate.sweep(four, vary={"protocol.k": "2..5"}, repeat=60, out="out")
    assert done.ran == 240 - kept
    assert done.complete


def test_sqlites_own_full_disk(tmp_path):
    from innervate.sweeping.work import Outcome

    with Jobs(tmp_path) as jobs:
        jobs._db.execute("PRAGMA max_page_count = 8")
        rows = [Outcome("p", r, 1, "{}" + " " * 3000, "", 0.0, 0.0) for r in range(50)]
        jobs.add(rows[:1], "{}")
        with pytest.raises(SweepError, match="no space left"):
            jobs.add(rows[1:], "{}")
        assert list(jobs.runs("p", 100)) == [0]


def test_two_sweeps_do_not_share_a_folder(four):
    Path("out").mkdir()
    with Jobs(Path("out")), pytest.raises(SweepError, match="another sweep is at work in out"):
        innervate.sweep(four, out="out", workers=1)


def test_ctrl_c_keeps_what_is_done(four):
    command = (
        "sweep",
        "four.toml",
        "--vary",
        "protocol.k=2..5",
        "--repeat",
        20_000,
        "--out",
        "out",
    )
    process = start(*command, cwd=four.parent, start_new_session=True)
    log = Path("out/jobs.sqlite-wal")
    until(lambda: log.exists() and log.stat().st_size > 50_000, "results")
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to everybody
    _, err = process.communicate(timeout=TIMEOUT_S)
    assert process.returncode == 130
    assert "are kept in out, and the same command goes on" in err
    assert "Traceback" not in err
    there = innervate.load_sweep("out")
    assert 0 < there.results.height < 32_000
    assert not there.complete


def test_a_worker_that_dies_takes_nothing_with_it(four):
    """Killed from outside, like for want of memory: its runs go to others, the table is whole."""
    killed = []

    def kill_one(scheduler):
        if not killed and scheduler.ran > 10:
            victim = next(iter(scheduler._engine._pool._processes))
            os.kill(victim, signal.SIGKILL)
            killed.append(victim)

    done = innervate.sweep(four, vary=VARY, repeat=60, workers=2, progress=kill_one)
    assert killed
    assert done.failed.height == 0
    assert done.results.equals(innervate.sweep(four, vary=VARY, repeat=60, workers=1).results)


def test_a_server_of_workers_that_dies_takes_nothing_with_it(four):
    """What workers are forked from is killed between two of them: the next one cannot be begun."""
    killed = []

    def kill_server(scheduler):
        if not killed:
            killed.append(forkserver._forkserver._forkserver_pid)
            os.kill(killed[0], signal.SIGSTOP)  # it takes the next order, and dies over it
            threading.Timer(0.2, os.kill, (killed[0], signal.SIGKILL)).start()

    done = innervate.sweep(four, vary=VARY, repeat=20, workers=2, progress=kill_server)
    assert killed
    assert done.failed.height == 0
    assert done.results.equals(innervate.sweep(four, vary=VARY, repeat=20, workers=1).results)


def test_who_is_begun_by_a_sweep_does_not_hear_ctrl_c_not_even_while_it_loads(four):
    process = start("sweep", "four.toml", "--repeat", 4, "--workers", 2, cwd=four.parent)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    while process.poll() is None:
        with suppress(OSError):  # some end by themselves
            for child in children.read_text().split():
                os.kill(int(child), signal.SIGINT)
    _, err = process.communicate(timeout=TIMEOUT_S)
    assert process.returncode == 0, err
    assert "Traceback" not in err


def test_a_run_that_kills_every_worker_is_a_failed_row(four):
    """A pool in which one point's work ends the process that does it."""
    done = innervate.sweep(
        four, vary={"protocol.k": "2..5"}, repeat=3, workers=2, progress=deadly_for("protocol.k", 4)
    )
    assert done.complete
    assert done.failed["protocol.k"].to_list() == [4, 4, 4]
    assert set(done.failed["reason"]) == {"its worker died 3 times, killed or out of memory"}


def deadly_for(key, value):
    """A progress function that makes the scheduler send deadly work for some points."""

    def arm(scheduler):
        deadly = {p.digest for p in scheduler.plan.points if p.columns[key] == value}
        submit = type(scheduler._engine).submit

        def armed(work, base, jobs):
            if any(job.point in deadly for job in jobs):
                return submit(scheduler._engine, os._exit, 9)
            return submit(scheduler._engine, work, base, jobs)

        scheduler._engine.submit = armed

    return arm


def test_a_script_without_a_guard_and_from_a_pipe(four):
    code = (
        "import innervate\n"
        "done = innervate.sweep('four.toml', repeat=4, workers=2)\n"
        "print(done.results['status'].to_list(), len(set(done.timings['pid'])) <= 2)\n"
    )
    Path("script.py").write_text(code)
    for command, given in (([sys.executable, "script.py"], ""), ([sys.executable, "-"], code)):
        done = subprocess.run(command, input=given, text=True, cwd=four.parent, env=environment(),
                              capture_output=True, timeout=TIMEOUT_S, check=False)  # fmt: skip
        assert done.stdout == "['done', 'done', 'done', 'done'] True\n", done.stderr


def test_more_workers_than_a_machine_can_bear_are_refused(four):
    with pytest.raises(SweepError, match="100,000 workers are more than a machine can bear"):
        innervate.sweep(four, workers=100_000, out="out")
    assert not Path("out").exists()


def test_workers_that_cannot_start_are_one_line(four, monkeypatch):
    monkeypatch.setattr(engines, "_settle", os.abort)
    with pytest.raises(SweepError, match="no worker can be started here"):
        innervate.sweep(four, workers=2, out="out")
    assert innervate.sweep(four, workers=1, out="out").ran == 1


@pytest.mark.parametrize(
    ("error", "why"),
    [(OSError(28, "No space left"), "No space left"), (TimeoutError(), "TimeoutError")],
)
def test_why_a_sweep_cannot_be_written_is_said(error, why):
    with (
        pytest.raises(SweepError, match=f"out cannot be written: {why}; what is done is kept"),
        _writing(Path("out")),
    ):
        raise error
