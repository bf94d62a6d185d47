"""A million calls of each protocol: C, here and on emulated processors, does what is recorded of
plain Python, and the record is that of the sources."""

import ast
import io
import json
import shutil

import pytest

from boards.errors import BoardFailed
from boards.firmware import qemu
from boards.firmware.native import SANITIZED, Native
from boards.firmware.play import Player
from boards.firmware.script import Script
from innervate.firmware.emit import Library
from tests.recorded import calls

ANEW = "something was changed that has a part in it: python -m tests.recorded.calls --only {}"
EMULATED = 100_000  # calls, half of them drawn


@pytest.fixture(autouse=True)
def compilers():
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")


def script_of(name, folder, runs, pieces):
    """Write a script of the first simulations and drawn calls; the hashes and calls wanted."""
    record, told = calls.kept(name), calls.told(name)
    size = record.kept + sum(run.size for run in record.runs[:runs])
    end = io.BytesIO()
    Script(end).end()
    (folder / "script").write_bytes(told[:size] + calls.pieces(0, pieces) + end.getvalue())
    marks = [mark for run in record.runs[:runs] for mark in run.marks] + record.drawn[:pieces]
    return marks, sum(run.calls for run in record.runs[:runs]) + pieces * calls.PIECE


def all_in_c(name, folder, made=None, checks=()):
    """Play a million calls in C, and compare: what differs, and how many calls there were."""
    wanted, count = script_of(name, folder, None, calls.DRAWN // calls.PIECE)
    found = qemu.on_host(made or calls.library(name), folder, folder / "script", checks)
    assert sum(found.calls.values()) == count == 1_000_000
    pairs = zip(wanted, calls.hexadecimal(found.marks), strict=True)
    return [(was, is_now) for was, is_now in pairs if was != is_now]


@pytest.mark.parametrize("name", calls.NAMES)
def test_the_record_is_of_these_sources(name):
    wanted = calls.sources(calls.library(name), calls.told(name))
    assert calls.kept(name).sources == wanted, ANEW.format(name)


@pytest.mark.parametrize("name", calls.NAMES)
def test_c_does_in_a_million_calls_what_python_does(name, tmp_path):
    assert all_in_c(name, tmp_path) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", calls.NAMES)
def test_no_sum_shift_index_or_address_leaves_its_bounds(name, tmp_path):
    assert all_in_c(name, tmp_path, checks=(*SANITIZED, "-fsanitize=address")) == []


@pytest.mark.parametrize("name", calls.NAMES)
def test_python_does_in_some_of_them_what_is_recorded(name):
    assert calls.in_python(name, 1, 1, 3, 1) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", calls.NAMES)
def test_python_does_in_all_of_them_what_is_recorded(name):
    runs = len(calls.kept(name).runs)
    assert calls.in_python(name, runs, 0, 0, calls.DRAWN // calls.PIECE) == []


# The emulated Cortex-M3 runs a Cortex-M0's code, too; of its own, one protocol's is enough.
TARGETS = [(name, target) for name in calls.NAMES for target in qemu.TARGETS]
RARE = {(name, "cortex-m3") for name in ("skin", "radio", "mesh")}


@pytest.mark.parametrize(
    ("name", "target"),
    [pytest.param(*one, marks=[pytest.mark.slow] * (one in RARE)) for one in TARGETS],
)
def test_emulated_processors_do_what_python_does(name, target, tmp_path):
    for tool in (qemu.TARGETS[target].compiler, qemu.TARGETS[target].emulator[0]):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed")
    runs, replayed = 0, 0
    while replayed < EMULATED // 2:
        replayed += calls.kept(name).runs[runs].calls
        runs += 1
    pieces = -(-(EMULATED - replayed) // calls.PIECE)
    wanted, count = script_of(name, tmp_path, runs, max(1, pieces))
    found = qemu.on_target(calls.library(name), tmp_path, tmp_path / "script", target)
    assert sum(found.calls.values()) == count >= EMULATED
    assert calls.hexadecimal(found.marks) == wanted


# One mistake each, as it would stand in C.
MISTAKES = {
    "skin": ("cell->countdown <= 0", "cell->countdown <= 1"),
    "csma": ("station->busy >= params->busy_max", "station->busy > params->busy_max"),
    "radio": ("station->fails >= RADIO_FAILS_MOST", "station->fails > RADIO_FAILS_MOST"),
    "mesh": ("if (node->rank >= 0)", "if (node->rank > 0)"),
}


@pytest.mark.parametrize(
    "name", [*list(MISTAKES)[:-1], pytest.param("mesh", marks=pytest.mark.slow)]
)
def test_a_mistake_in_c_is_found(name, tmp_path, monkeypatch):
    old, new = MISTAKES[name]
    text = Library.source(calls.library(name))
    assert old in text
    monkeypatch.setattr(Library, "source", lambda self: text.replace(old, new, 1))
    assert all_in_c(name, tmp_path)


def test_a_change_in_python_needs_a_new_record():
    """Of a comparison, and of a constant."""
    made, told = Library(calls.library("skin").role, {}), calls.told("skin")
    before = calls.sources(made, told)
    assert before == calls.kept("skin").sources
    name, number = next(iter(made.constants.items()))
    made.constants[name] = (number[0] + 1, number[1])
    assert calls.sources(made, told) != before
    made.constants[name] = number
    nodes = (node for function in made.program.sources.values() for node in ast.walk(function.node))
    comparison = next(node for node in nodes if isinstance(node, ast.Compare))
    was, comparison.ops = comparison.ops, [ast.NotIn()]
    assert calls.sources(made, told) != before
    comparison.ops = was
    assert calls.sources(made, told) == before
    assert calls.sources(made, told + b"\0") != before


@pytest.mark.parametrize("where", ["runs", "drawn"])
def test_a_wrong_record_is_found(where, tmp_path, monkeypatch):
    for path in calls.FOLDER.glob("skin.*"):
        shutil.copy(path, tmp_path)
    record = json.loads((tmp_path / "skin.json").read_text())
    if where == "runs":
        record["runs"][0][2] = "00000000" + record["runs"][0][2][8:]
    else:
        record["drawn"][3] = "00000000"
    (tmp_path / "skin.json").write_text(json.dumps(record))
    monkeypatch.setattr(calls, "FOLDER", tmp_path)
    assert len(calls.in_python("skin", 1, 1, 3, 1)) == 1


def test_played_beside_c_it_says_in_which_call_what_differs(tmp_path, monkeypatch):
    old, new = MISTAKES["skin"]
    text = calls.library("skin").source()
    monkeypatch.setattr(Library, "source", lambda self: text.replace(old, new, 1))
    player = Player(calls.library("skin"), Native(calls.library("skin"), tmp_path))
    with pytest.raises(BoardFailed, match=r"^call \d+, on_timer: .* but in C"):
        list(player.play(calls.told("skin")))
