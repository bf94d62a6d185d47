"""House rules that a reader would otherwise have to remember (CONTRIBUTING.md)."""

import ast
import importlib.util
from functools import cache
from pathlib import Path

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


@cache
def tree(path):
    """A file as Python reads it; three tests look at hundreds of them."""
    return ast.parse(path.read_text())


def own_lines(function):
    """Lines of a function without those of the functions that it builds (factories)."""
    inner = [
        node
        for node in ast.walk(function)
        if node is not function and isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    ]
    lines = set(range(function.lineno, function.end_lineno + 1))
    return len(lines.difference(*(range(f.lineno, f.end_lineno + 1) for f in inner)))


def parameters(function):
    """How many things a function is told, besides whose method it is."""
    names = [a.arg for a in (*function.args.posonlyargs, *function.args.args)]
    return len(names[names[:1] in (["self"], ["cls"]) :]) + len(function.args.kwonlyargs)


@cache
def functions(path):
    """All functions of a file."""
    kinds = ast.FunctionDef | ast.AsyncFunctionDef
    return [node for node in ast.walk(tree(path)) if isinstance(node, kinds)]


def test_functions_are_short():
    """Beyond a screen a ratchet: lower its numbers when fewer are left, never raise them."""
    ours = [f for path in sources("src/innervate", suffixes={".py"}) for f in functions(path)]
    long = [one for one in ours if one.end_lineno - one.lineno >= LINES_WANTED]
    assert sum(own_lines(function) > LINES_WANTED for function in long) <= LONG_MAX
    assert sum(parameters(function) > PARAMETERS_WANTED for function in ours) <= WIDE_MAX
    assert [
        f"{path.relative_to(ROOT)}:{node.lineno} {node.name}"
        for path in PYTHON
        for node in functions(path)
        if node.end_lineno - node.lineno >= FUNCTION_LINES_MAX
        and own_lines(node) > FUNCTION_LINES_MAX
    ] == []


def test_files_are_short():
    assert [
        str(path.relative_to(ROOT))
        for path in PYTHON
        if len(path.read_text().splitlines()) > FILE_LINES_MAX
    ] == []


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


def docstrings(path):
    """(line, docstring) of a module and of all classes and functions in it, but `__special__`."""
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            said = ast.get_docstring(node)
            if said is not None and not getattr(node, "name", "").startswith("__"):
                yield getattr(node, "lineno", 1), said


def test_docstrings_say_something():
    assert [
        f"{path.relative_to(ROOT)}:{line} {said}"
        for path in sources("src", suffixes={".py"})
        for line, said in docstrings(path)
        if len(said.split()) < DOCSTRING_WORDS_MIN
    ] == []
