"""The tool that plants faults finds what a test notices, and only that."""

import ast
import random
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.mutants.draw import SOURCES, drawn, faults

ROOT = Path(__file__).resolve().parents[2]
CODE = """\
def is_full(queued, room=4):
    return queued >= room


def unseen(number):
    return number + number
"""
TESTS = """\
import pytest

from innervate.wire.edge import is_full


@pytest.mark.parametrize(("queued", "full"), [(3, False), (4, True), (9, True)])
def test_full_at_its_edge(queued, full):
    assert is_full(queued) == full
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


@pytest.mark.slow
def test_what_a_test_notices_is_found_and_nothing_else(tmp_path):
    project = made(tmp_path)
    ran = subprocess.run(
        [sys.executable, "-m", "tests.mutants", "--room", "wire", "--workers", "1", "--least", "1"],
        cwd=project, capture_output=True, text=True, check=False,
        env={"PYTHONPATH": str(project / "src"), "PATH": "/usr/bin:/bin"},
    )  # fmt: skip
    said = ran.stdout + ran.stderr
    assert ran.returncode == 1, said
    assert "found: src/innervate/wire/edge.py:2: '>=' -> '>' tests/test_edge.py" in said
    assert "found: src/innervate/wire/edge.py:1: '4' -> '5' tests/test_edge.py" in said
    assert "not run by any test: src/innervate/wire/edge.py:6: '+' -> '-' (0 tests)" in said
    assert "| wire | 4 | 3 | 75% |" in said


def made(tmp_path):
    """A project of one file and one test, with the tool in it."""
    project = tmp_path / "project"
    for name, text in (("src/innervate/wire/edge.py", CODE), ("tests/test_edge.py", TESTS)):
        (project / name).parent.mkdir(parents=True)
        (project / name).write_text(text)
    for name in ("src/innervate/__init__.py", "src/innervate/wire/__init__.py"):
        (project / name).touch()
    tool = project / "tests" / "mutants"
    tool.mkdir()
    for name in ("__main__.py", "cover.py", "draw.py", "trial.py", "equivalent.toml"):
        shutil.copyfile(ROOT / "tests" / "mutants" / name, tool / name)
    kernel = project / "src/innervate/kernel"
    kernel.mkdir()
    (kernel / "__init__.py").touch()
    (kernel / "compilation.py").write_text(
        "from pathlib import Path\n"
        "ROOT = Path(__file__).parents[1]\n"
        "def source_files():\n    return []\n"
    )
    (project / "pyproject.toml").write_text("[tool.pytest.ini_options]\npythonpath = ['.']\n")
    subprocess.run(["git", "init", "-q"], cwd=project, check=True)
    return project
