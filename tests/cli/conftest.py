import os
import subprocess
import sys
from pathlib import Path

import pytest

from innervate.cli import main
from tests.fixtures.scenarios import FOUR_CELLS

SOURCES = Path(__file__).resolve().parents[2] / "src"
FOUR = f"""\
{FOUR_CELLS}
[data]
rate_hz = 100

[[event]]
at_s = 0.3
action = "cut"
interface = 1
"""


class Shell:
    """Runs command lines in this process; keeps what they print."""

    def __init__(self, capsys):
        self._capsys = capsys

    def __call__(self, *tokens):
        self.code = main([str(token) for token in tokens])
        self.out, self.err = self._capsys.readouterr()
        return self.code


@pytest.fixture
def sh(capsys, monkeypatch, tmp_path):
    """A shell in an empty folder with the scenario four.toml."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("INNERVATE_TRACEBACK", raising=False)
    (tmp_path / "four.toml").write_text(FOUR)
    return Shell(capsys)


def run_process(*tokens, code=None, cwd=None, **environment):
    """The command in a process of its own."""
    path = os.pathsep.join(filter(None, [str(SOURCES), os.environ.get("PYTHONPATH")]))
    command = [sys.executable, *(["-c", code] if code else ["-m", "innervate.cli"]), *tokens]
    return subprocess.Popen(
        command,
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": path, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.fixture
def process():
    return run_process
