"""A real scheduler and real workers; one of them killed in the middle."""

import json
import os
import re
import signal
import subprocess
import threading
from importlib.util import find_spec
from pathlib import Path

import pytest

import innervate
from innervate.sweeping import SweepError, engines
from tests.sweeping.conftest import TIMEOUT_S, start, until

if find_spec("distributed") is None:
    pytest.skip("distributed is missing", allow_module_level=True)
VARY = {"protocol.beacon_hz": [100, 250], "protocol.k": "2..4"}
RULES = {"repeat": 40, "until": "recoveries.routed_ms.ci=4%"}
QUIET = {"stdout": subprocess.DEVNULL}


@pytest.fixture
def scheduler(four):
    """The address of a scheduler, and its process."""
    options = ("--port", 0, "--no-dashboard", "--scheduler-file", "scheduler.json")
    process = start(*options, cwd=four.parent, module="distributed.cli.dask_scheduler", **QUIET)
    reader = drain(process)
    until(lambda: readable(Path("scheduler.json")), "the scheduler")
    yield json.loads(Path("scheduler.json").read_text())["address"], process
    process.kill()
    process.wait(TIMEOUT_S)
    reader.join(TIMEOUT_S)
    process.stderr.close()


@pytest.fixture
def workers(scheduler, four):
    """Two worker processes of one thread each."""
    address, _ = scheduler
    options = (address, "--no-nanny", "--no-dashboard", "--nthreads", 1)
    made = [start(*options, cwd=four.parent, module="distributed.cli.dask_worker", **QUIET)
            for _ in range(2)]  # fmt: skip
    readers = [drain(process) for process in made]
    yield made
    for process, reader in zip(made, readers, strict=True):
        process.kill()
        process.wait(TIMEOUT_S)
        reader.join(TIMEOUT_S)
        process.stderr.close()


def drain(process):
    """Read what a process says, so that it never waits for a reader."""
    reader = threading.Thread(target=process.stderr.read, daemon=True)
    reader.start()
    return reader


def readable(path):
    return path.exists() and path.read_text().rstrip().endswith("}")


def table(folder):
    return (Path(folder) / "results.parquet").read_bytes()


def test_a_cluster_loses_a_worker_then_its_scheduler_and_no_run(scheduler, workers, four):
    """The same bytes though a worker is killed; one line where all is gone, and what was done."""
    check_worker_killed(scheduler, workers, four)
    check_scheduler_killed(scheduler, four)


def check_worker_killed(scheduler, workers, four):
    address, _ = scheduler
    killed = []

    def kill_one(scheduler):
        """Once a few runs have come from both of them."""
        if not killed and scheduler.ran > 20:
            os.kill(workers[0].pid, signal.SIGKILL)
            killed.append(scheduler.ran)

    done = innervate.sweep(four, vary=VARY, out="cluster", dask=address, progress=kill_one, **RULES)
    innervate.sweep(four, vary=VARY, out="here", workers=1, **RULES)
    assert killed
    assert killed[0] < done.ran
    assert done.complete
    assert done.failed.height == 0
    assert table("cluster") == table("here")
    assert set(done.timings["pid"]) <= {process.pid for process in workers}


def check_scheduler_killed(scheduler, four):
    address, process = scheduler

    def stop(scheduler):
        if scheduler.ran > 10:
            process.kill()

    with pytest.raises(SweepError, match="what is done is kept"):
        innervate.sweep(four, vary=VARY, out="out", dask=address, progress=stop, repeat=300)
    before = innervate.load_sweep("out")
    assert 10 < before.results.height < 1800
    assert not before.complete
    done = innervate.sweep(four, vary=VARY, out="out", repeat=4, workers=1)
    assert done.ran == 24 - before.results.filter(before.results["repeat"] < 4).height


def test_a_scheduler_without_workers_is_told_and_waited_for(scheduler, four):
    """Ctrl-C ends the wait; or a worker comes, and all is run."""
    address, _ = scheduler
    asked = ("sweep", four.name, "--repeat", 2, "--dask", address)
    sweep = start(*asked, cwd=four.parent)
    assert sweep.stderr.readline() == (
        f"four: waits, as the scheduler has no workers; start one with: dask worker {address}\n"
    )
    sweep.send_signal(signal.SIGINT)
    _, told = sweep.communicate(timeout=TIMEOUT_S)
    assert sweep.returncode == 130
    assert re.fullmatch(r"innervate: interrupted; 0 of 2 runs done; they are kept in .*\n", told)
    sweep = start(*asked, cwd=four.parent)
    assert "no workers" in sweep.stderr.readline()
    options = (address, "--no-nanny", "--no-dashboard", "--nthreads", 1)
    worker = start(*options, cwd=four.parent, module="distributed.cli.dask_worker", **QUIET)
    reader = drain(worker)
    assert "Written:" in sweep.communicate(timeout=TIMEOUT_S)[0]
    worker.kill()
    worker.wait(TIMEOUT_S)
    reader.join(TIMEOUT_S)
    worker.stderr.close()


def test_no_scheduler_there(four, monkeypatch):
    monkeypatch.setattr(engines, "_CONNECT_S", 1)
    with pytest.raises(SweepError, match="no scheduler answers there"):
        innervate.sweep(four, dask="tcp://127.0.0.1:1")


@pytest.mark.parametrize(("address", "why"), [
    ("nonsense", "missing port number"), ("http://localhost:8787", "unknown address scheme"),
    ("tls://127.0.0.1:3", "no certificates"),
])  # fmt: skip
def test_no_client_is_made_for_what_is_no_address(four, address, why, monkeypatch):
    """It would be half made, and end 20 s later with a traceback."""
    made = []
    monkeypatch.setattr("distributed.Client", lambda *args, **options: made.append(args))
    with pytest.raises(SweepError, match=f"no scheduler answers there .*{why}"):
        innervate.sweep(four, dask=address)
    assert not made
