"""What a worker does: run a batch of runs of one sweep; the same on threads, processes, clusters.

Nothing here loads polars, whose threads do not outlive the fork that worker processes come from.
"""

import json
import math
import os
import platform
import socket
import threading
import time
from collections import OrderedDict
from contextlib import nullcontext, suppress
from functools import cache
from importlib import metadata
from typing import Any, NamedTuple

import msgspec

import innervate
from innervate import running as runs
from innervate.running import RunError
from innervate.scenario import Scenario, ScenarioError
from innervate.sweeping.base import Base, Settings, of_vary
from innervate.sweeping.flat import flat
from innervate.sweeping.sources import sources_of, texts
from innervate.trace.provenance import PACKAGES

SCENARIOS_KEPT = 256
REASON_MAX = 500


class Job(NamedTuple):
    """One run to do: the point's digest and settings, which repeat, its seed."""

    point: str
    settings: Settings
    repeat: int
    seed: int


class Outcome(NamedTuple):
    """What came of one run."""

    point: str
    repeat: int
    seed: int
    row: str | None  # its figures as JSON; None if it failed
    reason: str  # why it failed; "" if it did not
    wall_s: float  # how long it took, s
    began_s: float  # when it began, s since 1970


class Done(NamedTuple):
    """A batch done: the outcomes, and on what (see place())."""

    outcomes: list[Outcome]
    place: str
    sources: str


_kept: OrderedDict[tuple[str, str], Scenario] = OrderedDict()
_keeping = threading.Lock()
_first = threading.Lock()
_loaded: set[frozenset[str]] = set()


def run_batch(base: Base, jobs: list[Job]) -> Done:
    """Run these; what fails is an outcome as well, Ctrl-C is none."""
    mark = base.mark()
    return Done([_run(base, mark, job) for job in jobs], place(), sources_of(base.kind))


def _run(base: Base, mark: str, job: Job) -> Outcome:
    began, started = time.time(), time.perf_counter()
    row, reason = None, ""
    try:
        row = _row(_scenario(base, mark, job))
    except ScenarioError as error:
        reason = str(of_vary(error, (key for key, _ in job.settings)))
    except RunError as error:
        reason = str(error)
    except MemoryError:
        reason = "not enough memory"
    except Exception as error:  # whatever it is, it is this run's, and the others go on
        reason = f"{type(error).__name__}: {error}"
    took = time.perf_counter() - started
    reason = " ".join(reason.split())[:REASON_MAX]
    return Outcome(job.point, job.repeat, job.seed, row, reason, took, began)


def _scenario(base: Base, mark: str, job: Job) -> Scenario:
    """The point's scenario, read once for all its repeats, with the seed of this one."""
    key = (mark, job.point)
    with _keeping:
        made = _kept.get(key)
    if made is None:
        made = base.scenario(job.settings)
        with _keeping:
            _kept[key] = made
            while len(_kept) > SCENARIOS_KEPT:
                _kept.popitem(last=False)
    return Scenario(msgspec.structs.replace(made.model, seed=job.seed), made.source)


def _row(scenario: Scenario) -> str:
    """The run's figures as JSON."""
    words = frozenset(texts(msgspec.to_builtins(scenario.model)))
    # Which loop is compiled depends on words (rule, mac, ...) and on no number. Threads that want
    # the same one for the first time wait for each other; processes share Numba's cache.
    with nullcontext() if words in _loaded else _first:
        run = runs.run(scenario, received=False)
    _loaded.add(words)
    if run.interrupted:
        raise KeyboardInterrupt
    figures = flat(run.summary)
    for name, value in figures.items():
        if isinstance(value, float) and not math.isfinite(value):
            raise RunError(f"its {name} is {value}, no finite number")
    return json.dumps(figures, ensure_ascii=False, allow_nan=False)


@cache
def place() -> str:
    """The machine and the process that this is, and what runs on it, as JSON."""
    facts: dict[str, Any] = {
        "host": socket.gethostname(),
        "pid": os.getpid(),
        "cores": os.cpu_count(),
        "machine": platform.machine(),
        "system": f"{platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "innervate": innervate.__version__,
    }
    for name in PACKAGES:
        with suppress(metadata.PackageNotFoundError):
            facts[name] = metadata.version(name)
    return json.dumps(facts)
