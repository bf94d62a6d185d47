"""House rules that a reader would otherwise have to remember (CONTRIBUTING.md)."""

import ast
import importlib.util
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parent.parent
FUNCTION_LINES_MAX = 70
FILE_LINES_MAX = 400
LINES_WANTED, LONG_MAX = 40, 20
PARAMETERS_WANTED, WIDE_MAX = 6, 20
COLUMNS_MAX = 100
DOCSTRING_WORDS_MIN = 5
SUFFIXES = {".py", ".c", ".toml", ".sh"}
UNFINISHED = ("TO" + "DO", "FIX" + "ME", "X" * 3)
FIELD_MAX = 1 << 30
FUNCTION = ast.FunctionDef | ast.AsyncFunctionDef
BODIES = ("body", "orelse", "handlers", "finalbody", "cases")  # where statements have statements


def sources(*folders, suffixes=SUFFIXES):
    return sorted(
        path for folder in folders for path in (ROOT / folder).rglob("*") if path.suffix in suffixes
    )


CODE = sources("src", "tests", "benchmarks", "boards", "examples")
PYTHON = [path for path in CODE if path.suffix == ".py"]


def lines_with(paths, is_bad):
    return [
        f"{path.relative_to(ROOT)}:{number}"
        for path in paths
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if is_bad(line)
    ]


class Described(NamedTuple):
    """A module, a class or a function, without its tree: of a thousand files those are large."""

    line: int
    name: str
    said: str | None
    lines: int = 0
    own_lines: int = 0
    parameters: int = 0


@cache
def described(path):
    """A file as Python reads it: the module, and all classes and functions in it."""
    module = ast.parse(path.read_text())
    found = [Described(1, "", ast.get_docstring(module, clean=False))]
    for node in statements(module):
        if isinstance(node, ast.ClassDef | FUNCTION):
            said = ast.get_docstring(node, clean=False)
            sizes = sizes_of(node) if isinstance(node, FUNCTION) else ()
            found.append(Described(node.lineno, node.name, said, *sizes))
    return found


def statements(node):
    """All statements below one, without a look into what they compute: most of a file is that."""
    for part in BODIES:
        for below in getattr(node, part, ()):
            yield below
            yield from statements(below)


def sizes_of(function):
    """All lines of a function; those not of functions that it builds; parameters, self too."""
    lines = set(range(function.lineno, function.end_lineno + 1))
    inner = [node for node in statements(function) if isinstance(node, FUNCTION)]
    own = lines.difference(*(range(f.lineno, f.end_lineno + 1) for f in inner))
    told = function.args
    return len(lines), len(own), len(told.posonlyargs) + len(told.args) + len(told.kwonlyargs)


def test_functions_are_short():
    """Beyond a screen a ratchet: lower its numbers when fewer are left, never raise them."""
    ours = [one for path in sources("src/innervate", suffixes={".py"}) for one in described(path)]
    assert sum(one.lines > LINES_WANTED for one in ours) <= LONG_MAX
    assert sum(one.parameters > PARAMETERS_WANTED for one in ours) <= WIDE_MAX
    assert [
        f"{path.relative_to(ROOT)}:{one.line} {one.name}"
        for path in PYTHON
        for one in described(path)
        if one.own_lines > FUNCTION_LINES_MAX
    ] == []


def test_files_are_short():
    assert [
        str(path.relative_to(ROOT))
        for path in PYTHON
        if len(path.read_text().splitlines()) > FILE_LINES_MAX
    ] == []


def test_the_architecture_is_said_in_half_the_words_it_once_took():
    """Before networks were folders it had 118 lines and 10,646 bytes."""
    text = (ROOT / "ARCHITECTURE.md").read_text()
    assert len(text.splitlines()) <= 59
    assert len(text.encode()) <= 5_323


def test_lines_are_short():
    assert lines_with(CODE, lambda line: len(line) > COLUMNS_MAX) == []


def test_nothing_is_left_unfinished():
    assert lines_with(CODE, lambda line: any(mark in line for mark in UNFINISHED)) == []


def test_no_path_of_somebodys_machine():
    folders = tuple("/" + name + "/" for name in ("work", "root", "tmp", "home"))
    paths = sources("src", "docs", "examples", suffixes=SUFFIXES | {".md"})
    assert lines_with(paths, lambda line: any(folder in line for folder in folders)) == []


def field_tables():
    for path in sorted((ROOT / "src/innervate/networks").rglob("protocol/*fields.py")):
        spec = importlib.util.spec_from_file_location(path.stem, path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        for name, table in vars(module).items():
            if name.isupper() and name != "GIVEN" and isinstance(table, tuple):
                yield pytest.param(table, id=f"{path.stem}.{name}")


def test_there_are_field_tables():
    assert len(list(field_tables())) >= 3


@pytest.mark.parametrize("table", list(field_tables()))
def test_every_field_says_what_it_is(table):
    names = [field[0] for field in table]
    assert len(set(names)) == len(names)
    for name, length, low, high, unit, meaning in table:
        assert name.isidentifier(), name
        assert length == "ports" or length >= 0, name
        assert -FIELD_MAX < low <= high < FIELD_MAX, name
        assert unit.strip(), name
        assert meaning.strip(), name


def test_docstrings_say_something():
    assert [
        f"{path.relative_to(ROOT)}:{one.line} {one.said}"
        for path in sources("src", suffixes={".py"})
        for one in described(path)
        if one.said is not None
        if len(one.said.split()) < DOCSTRING_WORDS_MIN
    ] == []
