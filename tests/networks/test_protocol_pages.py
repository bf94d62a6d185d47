"""Each network's protocol opens with a page; what it says of names, values and handlers is so."""

import ast
import importlib
import re
from functools import cache
from pathlib import Path

import pytest

import innervate
from innervate.dialect import access
from innervate.network import networks

HOME = Path(innervate.__file__).parent / "networks"
NAMES = sorted(name for name in networks() if (HOME / name / "protocol").is_dir())
EQUAL = re.compile(r"`([A-Z][A-Z0-9_]*) = (-?\d+)`")
QUOTED = re.compile(r"`([^`\n]+)`")
SECTIONS = (
    "Theory of operation",
    "States",
    "Events and transitions",
    "Timers",
    "Frames",
    "Inputs and reports",
    "Constants and settings",
    "What holds, and under what assumption",
)
EVENTS = ("mode", "kind", "timer")
FEW = {"flooding": 0}  # one handler for all its frames
# Handlers call these beside what they hand an event on to.
HELPERS = {
    "arm",
    "copy_frame",
    "distance",
    "hand_up",
    "packet_us",
    "turn_timeout",
    "join_after",
    "frame_from",
}


def page_of(name):
    page = ast.get_docstring(ast.parse((HOME / name / "protocol" / "__init__.py").read_text()))
    assert page is not None
    return page


def rows_of(page):
    """Rows of all tables, each as the set of what stands in backticks; `NAME = 1` as NAME.

    A row whose first cell is empty goes on with the one above it.
    """
    rows = []
    for line in page.splitlines():
        if line.startswith("|"):
            words = {word.split(" = ")[0] for word in QUOTED.findall(line)}
            if line.split("|")[1].strip():
                rows.append(words)
            else:
                rows[-1] |= words
    return rows


def modules_of(name):
    for path in sorted((HOME / name / "protocol").glob("*.py")):
        if path.stem != "__init__":
            yield path, importlib.import_module(f"innervate.networks.{name}.protocol.{path.stem}")


@cache
def constants_of(name):
    """(name, value) of every whole number that a module of the protocol defines."""
    found = set()
    for path, module in modules_of(name):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.Assign):
                value = getattr(module, node.targets[0].id)
                if isinstance(value, int):
                    found.add((node.targets[0].id, value))
    return found


@cache
def functions_of(name):
    return [
        node
        for path, _ in modules_of(name)
        for node in ast.parse(path.read_text()).body
        if isinstance(node, ast.FunctionDef)
    ]


@cache
def names_of(name):
    return {function.name for function in functions_of(name)}


def event_of(test):
    """Constants that a condition compares a mode, kind or timer with."""
    found = set()
    for node in ast.walk(test):
        if isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.Eq):
            what = node.left
            left = what.attr if isinstance(what, ast.Attribute) else getattr(what, "id", "")
            right = node.comparators[0]
            name = right.attr if isinstance(right, ast.Attribute) else getattr(right, "id", "")
            if left in EVENTS and name.isupper():
                found.add(name)
    return found


def calls_of(statements):
    """Names that are called, but not where another event is asked for."""
    found = set()
    for node in statements:
        if isinstance(node, ast.If) and event_of(node.test):
            found |= calls_of(node.orelse)
        elif isinstance(node, ast.Call):
            found.add(getattr(node.func, "id", getattr(node.func, "attr", "")))
            found |= calls_of(node.args)
        else:
            found |= calls_of(ast.iter_child_nodes(node))
    return found


def dispatched(name):
    """(constant, function) of every branch by which a handler hands an event on."""
    found = set()
    for function in functions_of(name):
        if not function.name.startswith(("on_", "sink_", "carrier_")):
            continue
        for node in ast.walk(function):
            if isinstance(node, ast.If):
                called = (calls_of(node.body) & names_of(name)) - HELPERS
                found |= {(event, to) for event in event_of(node.test) for to in called}
    return found


def test_every_network_has_a_page():
    assert len(NAMES) >= 3


@pytest.mark.parametrize("name", NAMES)
def test_a_page_has_all_its_sections(name):
    lines = page_of(name).splitlines()
    heads = [lines[i] for i in range(len(lines) - 1) if lines[i + 1].startswith("====")]
    assert [head for head in heads if head in SECTIONS] == list(SECTIONS)


@pytest.mark.parametrize("name", NAMES)
def test_every_constant_stands_on_the_page_with_its_value(name):
    said = {(word, int(value)) for word, value in EQUAL.findall(page_of(name))}
    assert sorted(constants_of(name) - said) == []
    assert sorted(said - constants_of(name)) == []


@pytest.mark.parametrize("name", NAMES)
def test_every_setting_stands_on_the_page(name):
    quoted = set(QUOTED.findall(page_of(name)))
    settings = {
        field[0]
        for path, module in modules_of(name)
        if path.stem.endswith("fields")
        for field in module.PARAMS
    }
    assert sorted(settings - quoted) == []


@pytest.mark.parametrize("name", NAMES)
def test_every_event_stands_in_a_row_with_what_handles_it(name):
    rows = rows_of(page_of(name))
    missing = [pair for pair in dispatched(name) if not any(set(pair) <= row for row in rows)]
    assert sorted(missing) == []
    assert len(dispatched(name)) > FEW.get(name, 5)


def needed(make):
    """How many arguments a function must be given."""
    return make.__code__.co_argcount - len(make.__defaults__ or ())


@pytest.mark.parametrize("name", NAMES)
def test_what_the_page_names_is_there(name):
    known = names_of(name) | {name for name, _ in constants_of(name)} | set(vars(access))
    known |= {path.name for path, _ in modules_of(name)}
    for path, module in modules_of(name):
        if path.stem.endswith("fields"):
            tables = [table for table in vars(module).values() if isinstance(table, tuple)]
            called = {key: one for key, one in vars(module).items() if callable(one)}
            makers = [make for key, make in called.items() if key != "silent_us"]  # takes params
            tables += [make(8) for make in makers if needed(make) == 1]
            for table in tables:
                if isinstance(table, tuple):
                    known |= {field[0] for field in table if isinstance(field, tuple)}
    words = {word.split(" = ")[0] for word in QUOTED.findall(page_of(name))}
    plain = {word for word in words if re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*|\w+\.py", word)}
    assert sorted(plain - known) == []


@pytest.mark.parametrize("name", ["babel", "flooding", "rpl"])
def test_settings_are_by_themselves_as_the_page_has_them(name):
    fields = importlib.import_module(f"innervate.networks.{name}.protocol.fields")
    table = page_of(name).partition("| setting ")[2].partition("\n\n")[0]
    said = {}
    for line in table.splitlines()[2:]:
        words, value = line.split("|")[1:3]
        said[words.strip().strip("`")] = value.strip().replace(",", "")
    assert set(said) == {field[0] for field in fields.PARAMS}
    assert {key: int(value) for key, value in said.items() if value} == fields.DEFAULTS
