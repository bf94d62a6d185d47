"""What every test may rely on: INNERVATE_NO_SKIP, and the marks for what a machine may lack."""

import gc
import logging
import os
import shutil
import signal
import subprocess
from functools import cache
from pathlib import Path

import pytest

pytest_plugins = [
    "tests.fixtures.disk",
    "tests.fixtures.forks",
    "tests.fixtures.papers",
    "tests.fixtures.plots",
    "tests.fixtures.scenarios",
]
HERE = Path(__file__).parent
REAL_TIME = {"browser", "live", "sweeping"}  # folders of tests with processes and sockets
NEEDS = {"needs_root": "root", "needs_netns": "network namespaces", "needs_gpu": "an NVIDIA GPU"}


# What a worker has gathered stays to its end, and is not looked through again for what is in use:
# that took a fifteenth of all time, and of livesim's runs at the end of a long day half.
gc.set_threshold(100_000, 20, 20)


MEMORY = Path("/dev/shm")
ROOM = 2 << 30  # bytes; the tests leave a twentieth of that


def pytest_configure():
    if is_roomy(MEMORY):
        os.environ.setdefault("PYTEST_DEBUG_TEMPROOT", str(MEMORY))
    os.environ.pop("PYTHONUNBUFFERED", None)  # what is printed waits, as it does at users'
    # Who was started in the background by a script ignores Ctrl-C, and so would all that it starts.
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def is_roomy(folder):
    """True for a folder in memory where tests can lay files, and run them; a disk takes longer."""
    try:
        there = os.statvfs(folder)
    except OSError:
        return False
    is_open = os.access(folder, os.W_OK | os.X_OK) and not there.f_flag & os.ST_NOEXEC
    return is_open and there.f_bavail * there.f_frsize >= ROOM


def pytest_collection_finish():
    gc.collect()
    gc.freeze()


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item, nextitem):
    if nextitem is None or nextitem.path != item.path:
        gc.collect()
        gc.freeze()


def pytest_addoption(parser):
    parser.addoption(
        "--no-skip",
        action="store_true",
        default=os.environ.get("INNERVATE_NO_SKIP", "") not in ("", "0"),
        help="a skipped test fails, unless it is marked needs_* (also: INNERVATE_NO_SKIP=1)",
    )


@cache
def machine_has(need):
    if need == "needs_root":
        return hasattr(os, "geteuid") and os.geteuid() == 0
    if need == "needs_gpu":
        return succeeds("nvidia-smi", "-L")
    return succeeds("unshare", "--net", "true") and all(map(shutil.which, ("ip", "nft")))


def succeeds(*command):
    if shutil.which(command[0]) is None:
        return False
    return subprocess.run(command, capture_output=True, timeout=20, check=False).returncode == 0


def pytest_runtest_setup(item):
    for need, what in NEEDS.items():
        if item.get_closest_marker(need) and not machine_has(need):
            pytest.skip(f"this machine lacks {what}")


def fail_instead(report):
    """Turn a skip into a failure that says what to do."""
    reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
    report.outcome = "failed"
    report.longrepr = (
        f"{report.nodeid} was skipped, which counts as a failure here.\n{reason}\n"
        "Install what is missing: pip install -e '.[all,dev]' for Python packages, the list "
        "in .ci/run for Debian packages."
    )


def spread_out(items):
    """Of tests marked `few(count)` so many of the parameters stay; the others are slow."""
    families = {}
    for item in items:
        if few := item.get_closest_marker("few"):
            _, members = families.setdefault(item.nodeid.split("[")[0], (few.args[0], []))
            members.append(item)
    for count, members in families.values():
        kept = {round(k * (len(members) - 1) / max(count - 1, 1)) for k in range(count)}
        for place, item in enumerate(members):
            if place not in kept:
                item.add_marker(pytest.mark.slow)


@cache
def is_in_real_time(path):
    return not REAL_TIME.isdisjoint(path.relative_to(HERE).parts)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """What works against a clock outside this process has a second try, which is counted."""
    spread_out(items)
    for item in items:
        if is_in_real_time(item.path):
            item.add_marker(pytest.mark.flaky(reruns=1))


@pytest.fixture(autouse=True)
def said_by_loops():
    """What fails in a callback of an event loop, nobody waits for: it fails the test."""
    said = Said()
    logging.getLogger("asyncio").addHandler(said)
    yield said.records
    logging.getLogger("asyncio").removeHandler(said)
    assert not said.records, "\n".join(map(said.format, said.records))


class Said(logging.Handler):
    """Keeps what an event loop says of errors."""

    def __init__(self):
        super().__init__(logging.ERROR)
        self.records = []

    def emit(self, record):
        self.records.append(record)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    report = yield
    is_expected = hasattr(report, "wasxfail") or any(map(item.get_closest_marker, NEEDS))
    if report.skipped and not is_expected and item.config.getoption("--no-skip"):
        fail_instead(report)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector):
    report = yield
    if report.skipped and collector.config.getoption("--no-skip"):
        fail_instead(report)
    return report


def pytest_terminal_summary(terminalreporter):
    skipped = terminalreporter.stats.get("skipped", [])
    for need, what in NEEDS.items():
        count = sum(need in getattr(report, "keywords", ()) for report in skipped)
        if count:
            terminalreporter.write_line(f"{count} not run for want of {what}")
