"""Small parts: when a point is finished, rows from summaries, the table on a terminal."""

import os
import pty
import re
import signal
import statistics
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.cli import live_table
from innervate.cli.live_table import LiveTable
from innervate.sweeping import engines
from innervate.sweeping.engines import Pool, engine
from innervate.sweeping.errors import SweepError
from innervate.sweeping.flat import flat
from innervate.sweeping.until import parse
from tests.sweeping.conftest import TIMEOUT_S, environment

VALUES = st.lists(st.floats(1, 100), min_size=3, max_size=30)


@given(VALUES, st.floats(0.001, 2))
def test_a_rule_is_met_where_the_interval_is_that_narrow(values, share):
    scipy_t = {3: 4.303, 4: 3.182, 5: 2.776, 10: 2.262, 30: 2.045}
    relative, absolute = parse(f"x.y.ci={100 * share}%"), parse(f"x.y.ci={share}")
    assert relative.measure == absolute.measure == "x.y"
    if len(values) not in scipy_t:
        return
    half = scipy_t[len(values)] * statistics.stdev(values) / len(values) ** 0.5
    mean = statistics.fmean(values)
    for rule, bound in ((relative, share * mean), (absolute, share)):
        if abs(half - bound) > 0.01 * bound:
            assert rule.met(values) == (half < bound)


def test_few_values_are_never_enough_and_equal_ones_are():
    rule = parse("x.ci=5%")
    assert not rule.met([])
    assert not rule.met([3.0])
    assert rule.met([3.0, 3.0])
    assert parse("x.ci=5%").met([0.0, 0.0])
    assert str(rule) == "x.ci=5%"
    assert str(parse("x.ci=0.5")) == "x.ci=0.5"


def test_how_many_more_it_takes():
    rule = parse("x.ci=1")
    few = [0.0, 4.0] * 5
    assert rule.needed(few) > len(few)
    assert rule.met([0.0, 4.0] * (rule.needed(few) // 2 + 5))


def test_a_summary_as_a_row():
    summary = {
        "wall_s": 1.0, "seed": 3, "cells": 4, "data": {"sent": 10, "lost_by": {"cut": 1}},
        "recoveries": [
            {"at_s": 1.0, "routed_ms": 10.0, "detected_ms": None, "action": "cut"},
            {"at_s": 2.0, "routed_ms": None, "detected_ms": None, "action": "kill"},
            {"at_s": 6.0, "routed_ms": 30.0, "detected_ms": None, "action": "cut"},
        ],
        "port_loads": [2, 2], "order": list(range(1000)), "balance_factor": None,
    }  # fmt: skip
    row = flat(summary)
    assert "wall_s" not in row
    assert "order" not in row
    assert row["data.lost_by.cut"] == 1
    assert row["port_loads"] == "[2, 2]"
    assert row["recoveries.count"] == 3
    assert (row["recoveries.routed_ms"], row["recoveries.max.routed_ms"]) == (20.0, 30.0)
    assert row["recoveries.detected_ms"] is None
    assert (row["recoveries.1.routed_ms"], row["recoveries.2.routed_ms"]) == (None, 30.0)
    assert row["recoveries.0.action"] == "cut"
    assert row["balance_factor"] is None
    assert "recoveries.0.at_s" not in flat({"recoveries": summary["recoveries"][:1]})


def test_a_terminal_shows_a_table_with_the_means(four):
    above, below = pty.openpty()
    command = [sys.executable, "-m", "innervate.cli", "sweep", "four.toml", "--vary",
               "protocol.k=2,4", "--repeat", "20", "--workers", "1"]  # fmt: skip
    size = {"COLUMNS": "120", "LINES": "30", "TERM": "xterm"}
    process = subprocess.Popen(command, cwd=four.parent, env=environment() | size, stderr=below,
                               stdout=subprocess.PIPE, text=True)  # fmt: skip
    os.close(below)
    shown = b""
    while True:
        try:
            part = os.read(above, 65536)
        except OSError:  # Linux: nobody has the other end open any more
            break
        if not part:
            break
        shown += part
    os.close(above)
    out, _ = process.communicate(timeout=TIMEOUT_S)
    text = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown.decode())
    assert process.returncode == 0
    assert "four: 40 of 40 runs done" in text
    assert re.search(r"protocol\.k=2 +20/20 done +[\d.]+ \+- [\d.]+", text)
    assert "Written: sweeps/four/report.html" in out


class Clock:
    now = 100.0

    def monotonic(self):
        return self.now


class Conducted:
    """As far as a display looks at it."""

    done, failed, total, left_s, lacks = 30, 2, 100, 250.0, ""

    class plan:
        until = ()


def test_elsewhere_a_line_comes_now_and_then(monkeypatch, capsys):
    clock = Clock()
    monkeypatch.setattr(live_table, "time", clock)
    with LiveTable("mine", (), Path("there")) as table:
        for _ in range(25):
            clock.now += 1
            table(Conducted())
    lines = capsys.readouterr().err.splitlines()
    assert lines == ["mine: 30 of 100 runs done, 2 failed, about 4 min left"] * 2


def test_what_is_kept_is_said_only_of_what_is_done():
    table = LiveTable("mine", (), Path("there"))
    assert table.kept == "nothing is done yet"
    table(Conducted())
    assert table.kept.startswith("30 of 100 runs done, 2 failed; they are kept in ")


@pytest.mark.parametrize(("left", "words"), [
    (None, ""), (0.2, ""), (42.4, ", about 42 s left"), (90_000.0, ", about 25 h left"),
])  # fmt: skip
def test_time_left_in_words(left, words):
    conducted = Conducted()
    conducted.left_s = left
    assert live_table._left(conducted) == words


def test_new_workers_take_the_place_of_all_that_were_there():
    made = []

    def make():
        made.append(ThreadPoolExecutor(1))
        return made[-1]

    pool = Pool(make, 1)
    assert (pool.workers, pool.ahead, Pool(make, 3).ahead) == (1, 2, 6)
    made.pop().shutdown()
    assert pool.submit(len, "ab").result() == 2
    pool.renew()
    old, new = made
    with pytest.raises(RuntimeError, match="after shutdown"):
        old.submit(len, "")
    assert pool.submit(len, "abc").result() == new.submit(len, "abc").result() == 3
    pool.close()


def test_ctrl_c_while_the_first_worker_starts_ends_it():
    ended, now, pressed = [], threading.Event(), threading.Event()

    def hear():  # a thread of some library, which Ctrl-C reaches first
        now.wait()
        signal.raise_signal(signal.SIGINT)
        pressed.set()

    threading.Thread(target=hear).start()

    class Starting(ThreadPoolExecutor):
        def submit(self, work):
            now.set()
            pressed.wait()
            self._processes = {1: SimpleNamespace(terminate=lambda: ended.append("worker"))}
            return super().submit(work)

        def shutdown(self, **how):
            ended.append(how)

    with pytest.raises(KeyboardInterrupt):
        Pool(lambda: Starting(1), 1, engines._starting)
    assert ended == [{"wait": False, "cancel_futures": True}, "worker"]


@pytest.mark.parametrize(
    ("own", "option"), [({"workers": 2}, "--workers"), ({"kind": "threads"}, "--engine")]
)
def test_what_is_for_this_machine_is_refused_beside_a_cluster(own, option):
    said = f"^{option} is for this machine, and --dask for a cluster; leave one out$"
    with pytest.raises(SweepError, match=said), engine(dask="tcp://127.0.0.1:1", **own):
        pass
