"""The command says what was recorded, word for word, with the same exit codes.

A change that is meant to alter what is said records anew: python -m tests.recorded.commands
"""

import pytest

from tests.recorded import commands


@pytest.mark.parametrize("name", commands.NAMES)
def test_the_command_says_what_was_recorded(name, tmp_path):
    assert not commands.changes(name, tmp_path.resolve())


def test_a_line_that_differs_is_named_by_its_command():
    kept = commands.by_command("$ check a.toml\nfine\n(0)\n")
    found = commands.by_command("$ check a.toml\nfine\n(2)\n")
    assert commands.differences("files", kept, found) == [
        "files.1 check a.toml line 1: was '(0)', is '(2)'"
    ]
