"""Tests in forked processes: each once, whatever becomes of its process, and said as it was."""

import os
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as Tree
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.conftest import ROOM, is_roomy
from tests.fixtures.forks import in_order

SUITE = {
    "test_one.py": """
import os, warnings
import pytest

@pytest.fixture(scope="module")
def made():
    with open("made", "a") as file:
        file.write(f"{os.getpid()}\\n")
    yield
    with open("gone", "a") as file:
        file.write(f"{os.getpid()}\\n")

@pytest.mark.parametrize("number", range(9))
def test_passes(made, number, tmp_path):
    assert not list(tmp_path.iterdir())
    (tmp_path / "mine").touch()

def test_fails():
    print("said", "before")
    warnings.warn("not so", DeprecationWarning)
    assert {"here": 1} == {"here": 2}

def test_skips():
    pytest.skip("no reason")
""",
    "test_two.py": """
import os, signal
import pytest

tries = []

def test_kills_its_process():
    os.kill(os.getpid(), signal.SIGKILL)

@pytest.mark.parametrize("number", range(5))
def test_comes_after_it(number):
    pass

@pytest.mark.flaky(reruns=1)
def test_at_the_second_try():
    tries.append(0)
    assert len(tries) == 2
""",
}
WAITS = {
    "test_waits.py": """
import time
import pytest

@pytest.fixture(scope="session")
def left():
    yield
    open("torn_down", "w").close()

def test_waits(left):
    open("begun", "w").close()
    time.sleep(60)
"""
}
SWALLOWS = {
    "test_waits.py": WAITS["test_waits.py"].replace(
        "    time.sleep(60)",
        """
    try:
        time.sleep(60)
    except KeyboardInterrupt:
        time.sleep(60)
""",
    )
}


SLOW = {
    "conftest.py": """
import os, time
until = time.monotonic() + 1.5

def wait():  # an interrupt that comes here is swallowed
    time.sleep(max(0, until - time.monotonic()))

def count():
    global forks
    forks += 1

forks = 0
os.register_at_fork(before=count, after_in_child=lambda: forks == 2 and wait())
"""
}


def begin(folder, suite, *options):
    for name, text in suite.items():
        (folder / name).write_text(text)
    # A folder of its own: it would tidy up what earlier runs of all tests have left.
    options = ["--basetemp", "left", *options]
    command = [sys.executable, "-m", "pytest", "-p", "tests.fixtures.forks", *options]
    root = str(Path(__file__).parents[1])
    return subprocess.Popen(
        command, cwd=folder, env={"PYTHONPATH": root}, text=True, start_new_session=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """What two processes say of tests that pass, fail, are skipped, are killed, or come back."""
    folder = tmp_path_factory.mktemp("forked")
    process = begin(folder, SUITE, "--forks", "2", "--junitxml=out.xml")
    return folder, process.communicate()[0], process.returncode


def test_each_runs_once_and_is_counted(run):
    folder, said, status = run
    assert "2 failed, 15 passed, 1 skipped, 1 warning, 1 rerun" in said.splitlines()[-1], said
    assert status == 1
    cases = [case.get("name") for case in Tree.parse(folder / "out.xml").iter("testcase")]
    assert len(set(cases)) == 18
    assert len(cases) == 18 + 1  # of which one was tried twice


def test_what_failed_says_why(run):
    _, said, _ = run
    assert "assert {'here': 1} == {'here': 2}" in said
    assert said.count("said before") == 1
    assert "DeprecationWarning: not so" in said
    assert "test_two.py::test_kills_its_process: the process that ran it ended (-9)" in said


def test_fixtures_of_a_file_are_made_once_in_a_process_and_torn_down(run):
    folder, _, _ = run
    made = (folder / "made").read_text().split()
    assert 1 <= len(made) == len(set(made)) <= 3
    assert sorted(made) == sorted((folder / "gone").read_text().split())


def test_it_ends_at_the_first_that_fails(tmp_path):
    process = begin(tmp_path, SUITE, "--forks", "1", "-x", "-k", "fails or passes or skips")
    said, _ = process.communicate()
    assert "stopping after 1 failures" in said
    assert "1 failed, 9 passed" in said.splitlines()[-1]
    assert (tmp_path / "gone").exists()


@pytest.mark.parametrize("suite", [WAITS, WAITS | SLOW, SWALLOWS],
                         ids=["", "as a worker begins", "which a test swallows"])  # fmt: skip
def test_ctrl_c_ends_it_and_tears_down(tmp_path, suite):
    process = begin(tmp_path, suite, "--forks", "2")
    while not (tmp_path / "begun").exists():
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=30)
    assert process.returncode == pytest.ExitCode.INTERRUPTED
    assert "KeyboardInterrupt" in said
    assert (tmp_path / "torn_down").exists()


def test_the_last_files_are_short_ones():
    paths = [Path("tests", folder, f"test_{number}.py")
             for folder in ("live", "networks/skin") for number in range(50)]  # fmt: skip
    found = in_order(paths)
    assert sorted(found) == sorted(paths)
    short = ["networks" in path.parts for path in found]
    assert all(short[-25:])
    assert {True, False} == set(short[:20])
    assert found[:10] != sorted(found[:10])


LOOPS = """
import sys, time

def compiled(group, number):
    with open("loops", "a") as file:
        file.write(f", read {{group}} {{number}}")

if __name__ == "__main__":
    with open("loops", "w") as file:
        file.write(sys.argv[1])
    print(0, 0, flush=True)
    while "read 0 0" not in open("loops").read():  # as it comes, not at the end
        time.sleep(0.01)
    print(1, 0)
    sys.exit({status})
"""

AHEAD = """
import sys, time
time.sleep(2)  # longer than the test
open(f"{sys.argv[1]}/made_ahead", "x").close()
"""


@pytest.mark.parametrize(("status", "said"), [
    (0, "1 passed"), (3, "Exit: python -m tests.loops ended with 3"),
])  # fmt: skip
def test_loops_come_first(tmp_path, status, said):
    (tmp_path / "tests").mkdir()
    loops = LOOPS.format(status=status)
    (tmp_path / "tests" / "loops.py").write_text(loops)
    (tmp_path / "tests" / "ahead.py").write_text(AHEAD)
    suite = {
        "test_it.py": "def test_it():\n    assert open('loops').read() == '7, read 0 0, read 1 0'\n"
    }
    process = begin(tmp_path, suite, "--forks", "1", "--loops", "7")
    assert said in process.communicate(timeout=60)[0]
    assert process.returncode == bool(status)
    assert (tmp_path / "left" / "made_ahead").exists()  # it is waited for at the end


@pytest.mark.parametrize(("free", "flags", "lies_there"), [
    (ROOM, 0, True), (ROOM - 1, 0, False), (ROOM, os.ST_NOEXEC, False),
])  # fmt: skip
def test_files_lie_in_memory_where_there_is_room_and_programs_can_be_run(
    tmp_path, monkeypatch, free, flags, lies_there
):
    told = SimpleNamespace(f_flag=flags, f_bavail=free, f_frsize=1)
    monkeypatch.setattr(os, "statvfs", lambda _: told)
    assert is_roomy(tmp_path) == lies_there


def test_a_machine_without_such_a_folder_has_its_disk(tmp_path):
    assert not is_roomy(tmp_path / "shm")
