"""The tool that plants faults finds what a test notices, and only that."""

import ast
import json
import random
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.mutants.choose import Choice, shared, words_of
from tests.mutants.draw import SOURCES, drawn, faults
from tests.mutants.planting import sitecustomize
from tests.mutants.trial import LATE, Seen, seen_in
from tests.mutants.turns import Turns, rounds, turn

ROOT = Path(__file__).resolve().parents[2]
SUITE = """\
<testsuites><testsuite name="pytest">
<testcase classname="tests.test_edge" name="test_that_takes_long" time="1.000"/>
<testcase classname="tests.test_edge" name="test_full_at_its_edge[9-True]" time="0.002"/>
</testsuite></testsuites>
"""
CODE = """\
def is_full(queued, room=4):
    return queued >= room


def unseen(number):
    return number + number


def said(number):
    return number * 7
"""
TESTS = """\
import subprocess
import sys
import tomllib

import pytest

from innervate.wire.edge import is_full, unseen


def test_that_fails_anyhow():
    assert unseen(2) == 5


def test_that_takes_long():
    assert [is_full(queued) for queued in (3, 4, 9)] == [False, True, True]


@pytest.mark.parametrize(("queued", "full"), [(3, False), (4, True), (9, True)])
def test_full_at_its_edge(queued, full):
    assert is_full(queued) == full


def test_what_another_process_says():
    code = "from innervate.wire import edge; print(edge.said(2))"
    assert subprocess.check_output([sys.executable, "-c", code], text=True) == "14\\n"
"""


def test_every_fault_is_one_edit_that_still_parses():
    stream = random.Random(5)
    for path in stream.sample(sorted((ROOT / SOURCES).rglob("*.py")), 40):
        source = path.read_bytes()
        sound = ast.dump(ast.parse(source))
        every = faults(path, path.relative_to(ROOT).as_posix())
        for fault in stream.sample(every, min(5, len(every))):
            assert source[fault.start : fault.end].decode() == fault.old, fault
            edited = source[: fault.start] + fault.new.encode() + source[fault.end :]
            assert ast.dump(ast.parse(edited)) != sound, fault


def test_the_same_seed_draws_the_same_and_an_edit_elsewhere_changes_nothing(tmp_path):
    project = made(tmp_path)
    before = [fault.key for fault in drawn(project, 1, 8)]
    assert [fault.key for fault in drawn(project, 1, 8)] == before
    assert [fault.key for fault in drawn(project, 2, 8)] != before
    source = project / "src/innervate/wire/edge.py"
    source.write_text("# a line more\n" + source.read_text())
    assert [fault.key for fault in drawn(project, 1, 8)] == before


def test_strings_annotations_and_looks_are_left_alone(tmp_path):
    path = tmp_path / "plot" / "x.py"
    path.parent.mkdir()
    path.write_text('def f(x: "int | None" = None) -> int | None:\n    draw(f"{x + 1}", width=3)\n')
    assert [fault.new for fault in faults(path, "src/innervate/plot/x.py")] == ["pass"]


def test_asked_to_run_plain_or_not_it_does():
    source = 'def run(plan, *, plain: bool = False):\n    """Runs."""\n    return plan, plain\n'
    found = {}
    exec(compile(sitecustomize.always_plain(ast.parse(source)), "run", "exec"), found)
    assert found["run"](1) == found["run"](1, plain=False) == (1, True)
    assert found["run"].__doc__ == "Runs."


def test_tests_that_lie_near_come_first(tmp_path):
    project = made(tmp_path)
    for name, text in (
        ("src/innervate/wire/far.py", "from innervate.wire import edge\n"),
        ("tests/wire/test_far.py", "from innervate.wire.far import edge\n"),
        ("tests/wire/test_edge.py", "import innervate.wire.edge\n"),
        ("tests/wire/test_apart.py", "import pytest\n"),
        ("tests/cli/test_apart.py", "import pytest\n"),
        ("tests/recorded/test_kept.py", "import pytest\n"),
    ):
        (project / name).parent.mkdir(exist_ok=True)
        (project / name).write_text(text)
    assert Choice(project).tests_for("src/innervate/wire/edge.py", {"wire", "edge"}) == [
        "tests/wire/test_edge.py", "tests/test_edge.py", "tests/wire/test_far.py",
        "tests/wire/test_apart.py", "tests/recorded/test_kept.py",
    ]  # fmt: skip


def test_a_line_is_known_by_its_place_its_function_and_its_names(tmp_path):
    project = made(tmp_path)
    name = "src/innervate/wire/edge.py"
    (fault,) = (one for one in faults(project / name, name) if one.old == ">=")
    words = words_of(project, fault)
    assert words == {"wire", "edge", "full", "return", "queued", "room"}
    assert shared("tests/wire/test_room.py::test_full[queued_0]", words) == 4


@pytest.mark.slow
def test_what_a_test_notices_is_found_and_nothing_else(tmp_path):
    project = made(tmp_path)
    ran = subprocess.run(
        [sys.executable, "-m", "tests.mutants", "--room", "wire", "--workers", "1", "--least", "1"],
        cwd=project, capture_output=True, text=True, check=False,
    )  # fmt: skip
    said = ran.stdout + ran.stderr
    assert ran.returncode == 1, said
    for edit, by in (
        ("edge.py:2: '>=' -> '>'", "test_full_at_its_edge[4-True]"),
        ("edge.py:1: '4' -> '5'", "test_full_at_its_edge[4-True]"),
        ("edge.py:10: '*' -> '+'", "test_what_another_process_says"),
    ):
        assert f"src/innervate/wire/{edit} tests/test_edge.py::{by}\n" in said
    assert "\nsurvived: src/innervate/wire/edge.py:6: '+' -> '-' (5 tests)" in said
    assert "| wire | 7 | 6 | 86% |" in said
    assert (project / "src/innervate/wire/edge.py").read_text() == CODE
    took_s = Turns(project, project / ".mutants/took.jsonl").took_s()
    assert took_s["tests/test_edge.py::test_that_takes_long"] < 1  # told 1.0 by the whole suite
    assert 0 <= took_s["tests/test_edge.py::test_full_at_its_edge[3-False]"] < 1
    assert "tests/test_edge.py::test_that_fails_anyhow" not in took_s


@pytest.mark.parametrize(("place", "took_s", "number"), [
    (0, 0.0, 0), (14, 0.099, 0), (14, 0.1, 1), (0, 0.99, 1), (14, 1.0, 2), (0, 90.0, 2),
    (15, 0.0, 1), (29, 0.1, 2), (15, 1.0, 3), (29, 90.0, 3),
])  # fmt: skip
def test_a_cheap_test_has_its_turn_before_a_dear_one_and_a_near_one_before_others(
    place, took_s, number
):
    assert turn("tests/wire/test_edge.py::test_it", place, took_s) == number
    assert turn("tests/recorded/test_kept.py::test_it", place, 4 * took_s) == number


def test_in_every_turn_files_are_collected_in_their_order():
    files = [str(place) for place in range(17)]
    assert list(rounds(files)) == [
        (0, files[:3]), (0, files[3:15]), (1, files), (2, files), (3, files),
    ]  # fmt: skip


def test_of_how_long_tests_took_the_longest_is_kept(tmp_path):
    (tmp_path / ".mutants").mkdir()
    (tmp_path / ".mutants/suite.xml").write_text(SUITE)
    long, short = (f"tests/test_edge.py::test_{name}" for name in (
        "that_takes_long", "full_at_its_edge[9-True]",
    ))  # fmt: skip
    turns = Turns(tmp_path, tmp_path / "took.jsonl")
    assert turns.took_s() == {long: 1.0, short: 0.002}
    for took_s in (0.0, 0.2, 0.3, 0.1):
        turns.keep({long: took_s, "tests/test_other.py::test_other": 1.0})
    assert turns.took_s() == {long: 0.3, short: 0.002, "tests/test_other.py::test_other": 1.0}
    assert (tmp_path / "took.jsonl").read_text().count("\n") == 4


def test_a_test_that_failed_has_not_passed_though_it_was_taken_down(tmp_path):
    lines = [("begins", "a", ""), ("ended", "a", 0.5), ("begins", "b", ""), ("failed", "b", "so"),
             ("ended", "b", 0.7), ("begins", "c", "")]  # fmt: skip
    log = tmp_path / "log"
    for count, failed in ((2, ("", "")), (5, ("b", "so")), (6, ("b", "so"))):
        log.write_text("".join(json.dumps(line) + "\n" for line in lines[:count]))
        assert seen_in(log) == Seen(*failed, {"a": 0.5})
    log.write_text(json.dumps(lines[0]) + "\n")
    assert seen_in(log) == Seen("a", LATE, {})


def test_every_fault_that_changes_nothing_is_in_a_line_that_there_is():
    told = tomllib.loads((ROOT / "tests/mutants/equivalent.toml").read_text("utf-8"))
    for fault in told["fault"]:
        lines = (ROOT / fault["path"]).read_text("utf-8").splitlines()
        assert fault["line"] in (line.strip() for line in lines), fault


def made(tmp_path):
    """A project of one file and one test file, with the tool in it."""
    project = tmp_path / "project"
    for name, text in (
        ("src/innervate/wire/edge.py", CODE),
        ("tests/test_edge.py", TESTS),
        ("src/innervate/__init__.py", ""),
        ("src/innervate/wire/__init__.py", ""),
        (".mutants/suite.xml", SUITE),
        ("pyproject.toml", "[tool.pytest.ini_options]\npythonpath = ['.']\n"),
    ):
        (project / name).parent.mkdir(parents=True, exist_ok=True)
        (project / name).write_text(text)
    tool = Path("tests/mutants")
    shutil.copytree(ROOT / tool, project / tool, ignore=shutil.ignore_patterns("test_*", "__py*"))
    return project
