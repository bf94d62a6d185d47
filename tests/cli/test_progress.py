import re
import time
from types import SimpleNamespace as Of

import pytest

from innervate.cli import progress
from innervate.kernel import compilation


@pytest.fixture
def clock(monkeypatch):
    """Time that moves by hand."""

    class Clock:
        now = 100.0

        def monotonic(self):
            return self.now

    made = Clock()
    monkeypatch.setattr(progress, "time", made)
    return made


def test_short_runs_show_nothing(clock, capsys):
    with progress.Progress() as show:
        for step in range(5):
            clock.now += 1
            show(step * 200_000, 1_000_000)
    assert capsys.readouterr().err == ""


def test_long_runs_tell_how_long_they_take(clock, capsys):
    with progress.Progress() as show:
        for step in range(1, 101):
            clock.now += 1
            show(step * 10_000, 1_000_000)
    lines = capsys.readouterr().err.splitlines()
    assert 8 <= len(lines) <= 10
    assert re.fullmatch(r"simulated 0\.\d\d of 1 s, about \d+ s left", lines[0])
    left = [int(line.split("about ")[1].split()[0]) for line in lines]
    assert left == sorted(left, reverse=True)


def test_how_long_it_takes_goes_by_what_was_done_since_the_first_word(clock, capsys):
    with progress.Progress() as show:
        show(500_000, 1_000_000)
        clock.now += 30
        show(600_000, 1_000_000)
    assert capsys.readouterr().err == "simulated 0.60 of 1 s, about 120 s left\n"


def test_json_is_silent_unless_somebody_watches(clock, capsys):
    with progress.Progress(quiet=True) as show:
        for step in range(1, 101):
            clock.now += 1
            show(step * 10_000, 1_000_000)
    assert capsys.readouterr().err == ""


def test_a_terminal_gets_bars(monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    with progress.Progress("skin", quiet=True) as show:
        task = show._bars.tasks[0]
        assert "half a minute" in task.description
        show(500_000, 2_000_000)
        assert task.description == "simulated 0.50 of 2 s"
        assert (task.completed, task.total) == (500_000, 2_000_000)


@pytest.mark.parametrize(("done", "ends"), [(None, "0:00:04"), (5, "0:00:04 0:00:08 left")])
def test_a_bar_says_how_long_it_took_and_how_long_is_left(monkeypatch, done, ends):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    now = [0.0]
    with progress.Display() as display:
        display.begin("looking", line=False)
        bars = display._bars
        bars.get_time = display._bars.tasks[0]._get_time = lambda: now[0]
        bars.reset(display._task)
        for step in range(1, 6) if done else ():
            now[0] = 0.8 * step
            display.show("looking", step, 15, None)
        now[0] = 4.0
        row = [column(bars.tasks[0]) for column in bars.columns[3:]]
    assert " ".join(str(cell) for cell in row).strip() == ends


@pytest.mark.parametrize(("total", "lines"), [(0, 1), (3, 0), (4, 1)])
def test_lines_come_where_there_is_more_to_do_or_nobody_knows(clock, capsys, total, lines):
    with progress.Display() as display:
        clock.now += progress.LINE_EVERY_S
        display.show("too early", 3, total, None)
        clock.now += 0.1
        display.show("working", 3, total, None)
        display.show("too soon", 3, total, None)
    assert capsys.readouterr().err == lines * "working\n"


def test_a_bar_of_which_nobody_knows_the_end_has_none(monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    with progress.Display() as display:
        display.begin("looking", line=False)
        display.show("looking on", 7, 0, None)
        (task,) = display._bars.tasks
        assert (task.description, task.completed, task.total) == ("looking on", 7, None)
        display.show("looking on", 8, 9, 1.0)
        assert (task.completed, task.total) == (8, 9)


@pytest.mark.parametrize(("kind", "loop", "is_compiled", "told"), [
    ("skin", "skin", False, "skin"), ("mesh", "mesh-32", False, "mesh-32"),
    ("radio", "dcf", False, "radio, dcf"), ("radio", "dcf", True, ""), ("skin", "", False, ""),
])  # fmt: skip
def test_what_has_to_be_compiled_is_named(monkeypatch, kind, loop, is_compiled, told):
    monkeypatch.setattr(progress, "networks", lambda: {kind: Of(loop_name=lambda _: loop)})
    monkeypatch.setattr(compilation, "is_compiled", lambda _: is_compiled)
    assert progress.uncompiled(Of(kind=kind)) == told


def test_while_something_compiles_a_line_comes_now_and_then_and_none_afterwards(
    monkeypatch, capsys
):
    monkeypatch.setattr(progress, "STILL_EVERY_S", 0.01)
    for loop, quiet, some in (("skin", False, True), ("", False, False), ("skin", True, False)):
        with progress.Progress(loop, quiet) as show:
            end = time.monotonic() + (10 if some else 0.1)
            said = ""
            while time.monotonic() < end and "still compiling, after 0 s" not in said:
                time.sleep(0.01)
                said += capsys.readouterr().err
            show(0, 1_000_000)
            time.sleep(0.05)
            capsys.readouterr()
            time.sleep(0.05)
            assert capsys.readouterr().err == ""
        assert ("still compiling" in said) == some
