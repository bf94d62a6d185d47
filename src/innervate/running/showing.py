"""How far work is, in the cell of a notebook that began it; elsewhere nothing is shown."""

import sys
import time
from collections.abc import Callable
from html import escape
from importlib import import_module
from typing import Any, Self

EVERY_S = 0.1
PREPARING = "preparing; where no compiled loop is there yet, half a minute, once on this machine"


class Bar:
    """A line and a bar in a notebook's cell, gone when the work is done; a context manager.

    `what` is done is shown before anything is known of how far it is.
    """

    def __init__(self, what: str = PREPARING) -> None:
        self._what = what
        self._handle: Any = None
        self._last_s = 0.0

    def __enter__(self) -> Self:
        if in_notebook():
            room: Any = import_module("IPython.display")
            self._handle = room.display(_html(self._what, 0, 0), display_id=True)
        return self

    def __exit__(self, *_: object) -> None:
        if self._handle is not None:
            self._handle.update({"text/plain": "", "text/html": ""}, raw=True)

    def show(self, what: str, done: float, total: float) -> None:
        """So far `done` of `total`, 0 = nobody knows of how much."""
        now_s = time.monotonic()
        if self._handle is not None and now_s - self._last_s >= EVERY_S:
            self._last_s = now_s
            self._handle.update(_html(what, done, total))

    @property
    def simulated(self) -> Callable[[int, int], None] | None:
        """What a run tells how far it is; None where nobody sees it."""

        def told(now_us: int, duration_us: int) -> None:
            what = f"simulated {now_us / 1e6:.2f} of {duration_us / 1e6:g} s"
            self.show(what, now_us, duration_us)

        return None if self._handle is None else told

    def swept(self, scheduler: Any) -> None:
        """A sweep's progress: runs so far."""
        done = sum(state.done for state in scheduler.states)
        total = sum(state.goal for state in scheduler.states)
        self.show(scheduler.lacks or f"{done} of {total} runs", done, total)

    def explored(self, what: str, part: int, of: int) -> bool:
        """An exploration's progress; it is never ended from here."""
        self.show(what, part, of)
        return False


def in_notebook() -> bool:
    """True if what runs is a cell of a notebook."""
    python = sys.modules.get("IPython")
    shell = python.get_ipython() if python is not None else None
    return hasattr(shell, "kernel")


def _html(what: str, done: float, total: float) -> Any:
    room: Any = import_module("IPython.display")
    known = f' value="{done / total:.4f}"' if total else ""
    return room.HTML(f"<progress{known}></progress> <small>{escape(what)}</small>")
