"""Who runs the batches: this process, threads, worker processes, or a Dask cluster.

All are executors of the standard library's kind, behind one function, `engine()`.
"""

import logging
import math
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import contextmanager, nullcontext, suppress
from importlib import import_module
from multiprocessing import resource_tracker
from types import ModuleType
from typing import Any

from innervate.sweeping.errors import SweepError

KINDS = ("processes", "threads", "here")
_CONNECT_S = 10
_ASK_EVERY_S = 2.0
WORKERS_MAX = 1024
_STARTS = 4
_AGAIN_S = 0.1  # a server that was killed is taken for a living one until it is gone
# A process cannot be begun: it, or the server that it would be forked from, died; no room for it.
_NOT_BEGUN = (BrokenExecutor, EOFError, OSError)


class Engine:
    """Takes batches, and has them run."""

    workers = 1  # batches it runs at the same time
    ahead = 1  # batches to hand out at most, so that nobody waits for the next one
    died: tuple[type[BaseException], ...] = ()  # errors of a batch whose worker died
    lost: tuple[type[BaseException], ...] = ()  # those of a batch when the whole engine is gone
    falls_together = False  # when a worker dies, all batches under way are lost with it
    look_s: float | None = None  # after so long without a result ask `lacks`; None = never

    def submit(self, work: Callable[..., Any], *args: Any) -> Future[Any]:
        """Run `work(*args)` on some worker; its result comes by the future."""
        raise NotImplementedError

    def renew(self) -> None:
        """Make it fit for work again after a worker died."""

    def lacks(self) -> str:
        """What it lacks to go on, in words; "" = nothing."""
        return ""

    def close(self) -> None:
        """End it without waiting for what it was given."""


class Here(Engine):
    """This process and thread: `submit` comes back when the work is done."""

    def submit(self, work: Callable[..., Any], *args: Any) -> Future[Any]:
        """Run `work(*args)` here and now; the future is done when it is returned."""
        future: Future[Any] = Future()
        try:
            future.set_result(work(*args))
        except Exception as error:
            future.set_exception(error)
        return future


class Pool(Engine):
    """Threads or processes of this machine."""

    died = (BrokenExecutor,)
    falls_together = True

    def __init__(
        self, make: Callable[[], Executor], workers: int, starting: Any = nullcontext
    ) -> None:
        self.workers = workers
        self._starting = starting
        self.ahead = 2 * workers
        self._make = make
        self._pool = self._start()

    def _start(self) -> Executor:
        """A pool that works; found out now, lest every run be taken for one that kills workers."""
        for start in range(_STARTS):
            time.sleep(_AGAIN_S if start else 0)
            pool = self._make()
            try:
                with self._starting():
                    pool.submit(os.getpid).result()
            except _NOT_BEGUN as error:
                why = error
                pool.shutdown(wait=False, cancel_futures=True)
            except BaseException:  # Ctrl-C: one that went on starting would miss what it needs
                _end(pool)
                raise
            else:
                return pool
        raise SweepError("no worker can be started here; use --workers 1") from why

    def submit(self, work: Callable[..., Any], *args: Any) -> Future[Any]:
        """Run `work(*args)` on a worker."""
        try:
            with self._starting():
                return self._pool.submit(work, *args)
        except _NOT_BEGUN as error:
            future: Future[Any] = Future()
            future.set_exception(BrokenExecutor(f"no worker: {error}"))
            return future

    def renew(self) -> None:
        """New workers in place of those that died and of those beside them."""
        self.close()
        self._pool = self._start()

    def close(self) -> None:
        """End the workers, whatever they are at."""
        _end(self._pool)


def _end(pool: Executor) -> None:
    processes = list((getattr(pool, "_processes", None) or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    for process in processes:
        with suppress(OSError, ValueError):
            process.terminate()


class Cluster(Engine):
    """A Dask cluster that is running already."""

    look_s = _ASK_EVERY_S

    def __init__(self, address: str) -> None:
        self._address = address
        distributed: Any = import_module("distributed")
        closed: Any = import_module("distributed.comm.core").CommClosedError

        try:
            _look_at(address, distributed)
            self._client: Any = distributed.Client(
                address, timeout=_CONNECT_S, set_as_default=False
            )
        except (OSError, ValueError, ImportError) as error:
            why = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise SweepError(
                f"--dask {address}: no scheduler answers there ({why}); start one with: "
                "dask scheduler"
            ) from None
        self.died = (distributed.KilledWorker,)
        self.lost = (closed, TimeoutError)
        self._asked_s, self._threads = -math.inf, 1
        # Its clients log with tracebacks what is told here in one line.
        for name in ("distributed", "distributed.client", "distributed.core"):
            logging.getLogger(name).setLevel(logging.CRITICAL)
        self._pool = self._client.get_executor(pure=False)

    @property
    def workers(self) -> int:  # type: ignore[override]
        """Threads of all workers at present; they may come and go."""
        return max(1, self._count())

    def lacks(self) -> str:
        """Workers, if there are none."""
        start = f"start one with: dask worker {self._address}"
        return "" if self._count() else f"waits, as the scheduler has no workers; {start}"

    def _count(self) -> int:
        """Threads of all workers, as they were two seconds ago at most."""
        now = time.monotonic()
        if now - self._asked_s >= _ASK_EVERY_S:
            self._asked_s = now
            self._threads = sum(self._client.nthreads().values())
        return self._threads

    @property
    def ahead(self) -> int:  # type: ignore[override]
        """How many batches are handed out ahead: two for each worker."""
        return 2 * self.workers

    def submit(self, work: Callable[..., Any], *args: Any) -> Future[Any]:
        """Run `work(*args)` on the cluster."""
        future: Future[Any] = self._pool.submit(work, *args)
        return future

    def close(self) -> None:
        """Take back what was handed out, and go."""
        with suppress(Exception):
            self._pool.shutdown(wait=False)
        with suppress(Exception):
            self._client.close(timeout=5)


def _look_at(address: str, distributed: Any) -> None:
    """Refuse what cannot be connected to, before a client tries: one that an error leaves half made
    is rid of after 20 s, with a traceback.

    Raises:
        ValueError: no address, or one that needs certificates, and there are none.
        ImportError: what its scheme needs is missing.
    """
    if address.startswith("inproc://"):  # of a cluster within this process
        return
    import_module("distributed.comm").get_address_host_port(address)
    safe = distributed.Security().get_connection_args("client")
    if address.startswith("tls://") and safe.get("ssl_context") is None:
        raise ValueError("Dask's configuration has no certificates, distributed.comm.tls")


@contextmanager
def engine(kind: str = "processes", workers: int | None = None, dask: str = "") -> Iterator[Engine]:
    """An engine, ended when the block is left.

    Args:
        kind: "processes", "threads" or "here"; processes with one worker are "here".
        workers: how many at the same time, from 1; None = one for every core.
        dask: address of a Dask scheduler; the cluster is used instead of this machine.

    Raises:
        SweepError: no such kind, no scheduler at the address, or both asked for.
    """
    if kind not in KINDS:
        raise SweepError(f'no engine "{kind}"; there are {", ".join(KINDS)}')
    if dask and (workers is not None or kind != KINDS[0]):
        said = "--engine" if workers is None else "--workers"
        raise SweepError(f"{said} is for this machine, and --dask for a cluster; leave one out")
    count = cores() if workers is None else workers
    if count < 1:
        raise SweepError(f"{count} workers cannot run anything; give at least 1")
    if count > WORKERS_MAX:
        raise SweepError(
            f"{count:,} workers are more than a machine can bear; give at most {WORKERS_MAX:,}, or "
            "leave --workers out for one on every core"
        )
    if dask:
        made: Engine = Cluster(dask)
    elif kind == "here" or (kind == "processes" and count == 1):
        made = Here()
    else:
        forked = kind == "processes"
        make = _processes if forked else _threads
        made = Pool(lambda: make(count), count, _starting if forked else nullcontext)
    try:
        yield made
    finally:
        made.close()


def cores() -> int:
    """Cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        return os.cpu_count() or 1


def _threads(count: int) -> Executor:
    from concurrent.futures import ThreadPoolExecutor

    return ThreadPoolExecutor(count)


def _processes(count: int) -> Executor:
    """Workers forked from a server that has loaded the simulator, once for all of them."""
    from concurrent.futures import ProcessPoolExecutor

    known = multiprocessing.get_all_start_methods()
    context = multiprocessing.get_context("forkserver" if "forkserver" in known else "spawn")
    if "forkserver" in known:
        context.set_forkserver_preload(["innervate.sweeping.work"])
    return ProcessPoolExecutor(count, mp_context=context, initializer=_settle)


@contextmanager
def _starting() -> Iterator[None]:
    """While a worker may be started: it would import the caller's script, and needs it for nothing.

    So a script that sweeps needs no `if __name__ == "__main__":`, and may come from a pipe. What is
    begun meanwhile does not hear Ctrl-C, which is the sweep's affair, not even while it loads. The
    sweep hears it afterwards: half begun, a worker would be nobody's, and end in a traceback.
    """
    main, heard = sys.modules["__main__"], None
    hears, pressed = signal.getsignal(signal.SIGINT), list[tuple[Any, ...]]()
    waits = callable(hears) and threading.current_thread() is threading.main_thread()
    if waits:
        signal.signal(signal.SIGINT, lambda *how: pressed.append(how))
    if hasattr(signal, "pthread_sigmask"):
        resource_tracker.ensure_running()  # begun below, it would unblock what is blocked
        heard = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main
        if heard is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, heard)
        if waits:
            signal.signal(signal.SIGINT, hears)
        if pressed and callable(hears):
            hears(*pressed[0])


def _settle() -> None:
    """A worker's start: Ctrl-C is the sweep's affair; if that is killed, so is the worker."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_follow, args=(parent,), daemon=True).start()


def _follow(parent: Any) -> None:
    parent.join()
    os._exit(1)
