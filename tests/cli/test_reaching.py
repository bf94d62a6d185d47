"""Which functions of some files a folder's tests call, as `check-protocol` asks it."""

import json
import sys

import pytest

from innervate.cli import reaching

SOURCE = """\
LIMIT = 3


def first(value):
    def inner():
        return value
    return inner()


def second(value):
    return -value


def third(value):
    return second(value)
"""
EVERY = [["first", 4], ["second", 10], ["third", 14]]


@pytest.mark.parametrize(("calls", "code", "unreached"), [
    ("first(1) == 1", 0, EVERY[1:]),
    ("first(1) == 2", 1, EVERY[1:]),
    ("second(1) == -1", 0, [EVERY[0], EVERY[2]]),
    ("third(1) == -1", 0, EVERY[:1]),
    ("first(third(1)) == -1", 0, []),
    ("True", 0, EVERY),
])  # fmt: skip
def test_functions_that_tests_call_are_reached_and_the_others_told_with_their_lines(
    calls, code, unreached, tmp_path, monkeypatch
):
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    source, out = tmp_path / "reached_here.py", tmp_path / "out.json"
    source.write_text(SOURCE)
    (tmp_path / "test_reached_here.py").write_text(
        f"from reached_here import first, second, third\n\n\ndef test_it():\n    assert {calls}\n"
    )
    try:
        assert reaching.main(str(out), str(tmp_path), str(source)) == code
    finally:
        for name in ("reached_here", "test_reached_here"):
            sys.modules.pop(name, None)
    told = json.loads(out.read_text())
    assert told == {
        "code": code,
        "reached": 3 - len(unreached),
        "unreached": [[name, str(source), line] for name, line in unreached],
    }
