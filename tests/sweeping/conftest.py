import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.fixtures.scenarios import FOUR_CELLS

SOURCES = Path(__file__).resolve().parents[2] / "src"
TIMEOUT_S = 120
FOUR = f"""\
{FOUR_CELLS}
[[event]]
at_s = [0.25, 0.3]
action = "cut"
interface = 1
"""


def environment():
    path = os.pathsep.join(filter(None, [str(SOURCES), os.environ.get("PYTHONPATH")]))
    return {**os.environ, "PYTHONPATH": path}


def start(*tokens, cwd, module="innervate.cli", **options):
    return subprocess.Popen(
        [sys.executable, "-m", module, *map(str, tokens)],
        cwd=cwd,
        env=environment(),
        stdout=options.pop("stdout", subprocess.PIPE),
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )


def until(condition, what):
    """Wait until something is so that another process brings about."""
    end = time.monotonic() + TIMEOUT_S
    while not condition():
        assert time.monotonic() < end, f"waited in vain for {what}"
        time.sleep(0.02)


@pytest.fixture
def four(tmp_path, monkeypatch):
    """The scenario four.toml in an empty working folder."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "four.toml"
    path.write_text(FOUR)
    return path
