"""Mistakes planted in a copy of the sources are caught by the commands as anybody types them."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

import innervate
from innervate.networks.skin.prove.faults import MUTANTS

FIVE = MUTANTS[:5]  # planted by an independent check: a reduced search on trust finds none of them
COMMANDS = {"verify": ("verify", "--graph", "triangle"), "prove": ("prove",)}
SOURCES = Path(innervate.__file__).resolve().parent


def planted(fault, home):
    """A copy of all sources with a mistake in it."""
    shutil.copytree(SOURCES, home / "innervate", ignore=shutil.ignore_patterns("__pycache__"))
    protocol = home / "innervate" / "networks" / "skin" / "protocol"
    (path,) = (path for path in protocol.glob("*.py") if fault.old in path.read_text("utf-8"))
    path.write_text(path.read_text("utf-8").replace(fault.old, fault.new), "utf-8")


def typed(command, fault, home):
    """Exit code and all that is printed where the sources at hand, in a folder, have a fault."""
    planted(fault, home)
    main = "import sys; from innervate.cli import main; sys.exit(main())"
    env = {**os.environ, "PYTHONPATH": str(home)}
    done = subprocess.run([sys.executable, "-c", main, *COMMANDS[command]], env=env, text=True,
                          capture_output=True, cwd=home)  # fmt: skip
    return done.returncode, done.stdout + done.stderr


# No reduced search begins on a protocol that lemmas refute; the proof of the skin refutes five.
REFUSED = [("verify", fault, 2, "; --no-reduce explores it without resting on the rule")
           for fault in MUTANTS]  # fmt: skip
REFUTED = [("prove", fault, 1, "REFUTED") for fault in FIVE]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "fault", "code", "says"),
    [pytest.param(*row, id=f"{row[0]}, {row[1].name}") for row in REFUSED + REFUTED],
)
def test_a_planted_fault_is_told(command, fault, code, says, tmp_path):
    ended, told = typed(command, fault, tmp_path)
    assert ended == code
    assert says in told
    assert "nothing broken" not in told.lower()


if __name__ == "__main__":  # python -m tests.networks.skin.verify.test_planted FOLDER
    for number, fault in enumerate(MUTANTS):
        for command in ("verify", "prove"):
            begun, before = time.perf_counter(), os.times().children_user
            home = Path(sys.argv[1]) / f"{number}-{command}"
            code, told = typed(command, fault, home)
            hit = next((line for line in told.splitlines() if "--no-reduce" in line or
                        "REFUTED" in line), "NOT CAUGHT")  # fmt: skip
            used = os.times().children_user - before
            print(f"{number + 1}|{fault.name}|{command}|{code}|{hit.strip()}|{used:.1f}|"
                  f"{time.perf_counter() - begun:.1f}", flush=True)  # fmt: skip
            shutil.rmtree(home)
