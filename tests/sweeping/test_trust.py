"""The same final table whatever order, crashes and engine; nothing lost, nothing done twice."""

import os
import random
import re
import signal
import sqlite3
from concurrent.futures import Future
from contextlib import nullcontext
from importlib import import_module
from pathlib import Path

import pytest

import innervate
from innervate.cli import main
from innervate.sweeping import scheduler as conduct
from innervate.sweeping.engines import Here
from tests.sweeping.conftest import FOUR, TIMEOUT_S, start, until

VARY = {"protocol.beacon_hz": [100, 250], "protocol.k": "2..4"}
COMMAND = ("sweep", "four.toml", "--vary", "protocol.beacon_hz=100,250", "--vary",
           "protocol.k=2..4")  # fmt: skip
RULES = {"until": "recoveries.routed_ms.ci=8%", "repeat": 24, "batch": 6}
REPEATS = 40
STARTS_MAX = 12  # the first ones can be killed before anything is done
KILLS = 2  # the second comes to what was left by one


def table(folder):
    return (Path(folder) / "results.parquet").read_bytes()


@pytest.fixture(scope="module")
def one(tmp_path_factory):
    """The table of one worker: its bytes do not say in which folder it was made."""
    folder = tmp_path_factory.mktemp("one")
    (folder / "four.toml").write_text(FOUR)
    innervate.sweep(folder / "four.toml", vary=VARY, out=folder / "out", workers=1, **RULES)
    return table(folder / "out")


def stored(folder):
    """When each run began, by (point, repeat), from the job table that nobody is at work on."""
    with sqlite3.connect(Path(folder) / "jobs.sqlite") as db:
        rows = db.execute("SELECT point, repeat, began_s FROM runs").fetchall()
    db.close()
    return {(point, repeat): began for point, repeat, began in rows}


@pytest.mark.parametrize("how", [
    {"workers": 2}, {"workers": 3, "kind": "threads"}, {"kind": "here"},
], ids=["processes", "threads", "here"])  # fmt: skip
def test_every_engine_gives_the_same_bytes(one, four, how):
    innervate.sweep(four, vary=VARY, out="other", **how, **RULES)
    assert table("other") == one


class Later(Future):
    """A result that is not worked out before somebody says so."""

    def __init__(self, work, args):
        super().__init__()
        self.finish = lambda: self.set_result(work(*args))


class Shuffled(Here):
    """Hands results back in another order than it was given the work."""

    ahead = 7

    def __init__(self, seed):
        self._random = random.Random(seed)
        self._waiting = []

    def submit(self, work, *args):
        self._waiting.append(Later(work, args))
        return self._waiting[-1]

    def settle(self):
        count = self._random.randint(1, len(self._waiting))
        self._random.shuffle(self._waiting)
        for _ in range(count):
            self._waiting.pop().finish()


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.few(1)
def test_any_order_gives_the_same_bytes(one, four, seed, monkeypatch):
    made = Shuffled(seed)

    def settle(futures, **_):
        made.settle()
        return {future for future in futures if future.done()}, set()

    monkeypatch.setattr(
        import_module("innervate.sweeping.sweep"), "engine", lambda *_: nullcontext(made)
    )
    monkeypatch.setattr(conduct, "wait", settle)
    innervate.sweep(four, vary=VARY, out="other", **RULES)
    assert table("other") == one


def test_kill_9_at_any_moment_loses_nothing_and_does_nothing_twice(four):
    """Killed again and again, at some moment between two results, until it is through."""
    innervate.sweep(four, vary=VARY, repeat=REPEATS, out="whole")
    seen, kills = {}, 0
    for starts in range(STARTS_MAX):
        growth = Growth(3 + starts)
        process = start(*COMMAND, "--repeat", REPEATS, "--out", "killed", cwd=four.parent,
                        start_new_session=True)  # fmt: skip
        if kills < KILLS:
            until(lambda g=growth, p=process: g() or p.poll() is not None, "results")
            os.kill(process.pid, signal.SIGKILL)
        _, err = process.communicate(timeout=TIMEOUT_S)
        until(lambda p=process: not alive(p.pid), "the workers' end")
        now = stored("killed")
        assert seen.items() <= now.items()  # there still, and not run anew
        kills += process.returncode == -signal.SIGKILL and len(now) > len(seen)
        seen = now
        if process.returncode == 0:
            break
    assert process.returncode == 0, err
    assert kills == KILLS
    assert len(seen) == 6 * REPEATS
    assert table("killed") == table("whole")


class Growth:
    """Whether the job table was written to a few times since this was made."""

    def __init__(self, times):
        self._times = times
        self._last = self._look()

    def _look(self):
        log = Path("killed/jobs.sqlite-wal")
        return log.stat().st_mtime_ns if log.exists() else 0

    def __call__(self):
        now = self._look()
        self._times -= now != self._last
        self._last = now
        return self._times <= 0


def alive(group):
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def test_a_torn_row_of_the_job_table_is_named_and_run_again(four, capsys):
    asked = ["sweep", "four.toml", "--vary", "protocol.k=2,4", "--repeat", "2", "--workers", "1",
             "--out", "out"]  # fmt: skip
    assert main(asked) == 0
    before = table("out")
    with sqlite3.connect("out/jobs.sqlite") as rows:
        point = innervate.load_sweep("out").plan.points[1].digest
        rows.execute("UPDATE runs SET figures = '{' WHERE point = ? AND repeat = 0", (point,))
    rows.close()
    capsys.readouterr()
    assert main(asked) == 0
    said = capsys.readouterr().err
    assert "out/jobs.sqlite had damaged rows: point 1, repeat 0, which was run again" in said
    assert table("out") == before
    assert main(asked) == 0
    assert "damaged" not in capsys.readouterr().err


def test_a_damaged_page_of_the_job_table_costs_the_runs_on_it_and_no_others(four, capsys):
    asked = ["sweep", "four.toml", "--vary", "protocol.k=2,4", "--repeat", "8", "--workers", "1",
             "--out", "out"]  # fmt: skip
    assert main(asked) == 0
    before, path = table("out"), Path("out/jobs.sqlite")
    data = bytearray(path.read_bytes())
    leaf = [at for at in range(4 * 4096, len(data), 4096) if data[at] == 10][-1]
    data[leaf : leaf + 4096] = b"\xff" * 4096
    path.write_bytes(data)
    capsys.readouterr()
    assert main(asked) == 0
    said = capsys.readouterr().err
    words = "had damaged rows: whole pages: ([0-9]+) runs could be read and are kept, ([0-9]+) were"
    found = re.search(f"out/jobs.sqlite {words} run now .jobs.sqlite.damaged-1 is the file", said)
    kept, ran = map(int, found.groups())
    assert kept + ran == 16 > kept > 0
    assert table("out") == before
    assert bytes(data) == Path("out/jobs.sqlite.damaged-1").read_bytes()
    assert main(asked) == 0
    assert "damaged" not in capsys.readouterr().err
