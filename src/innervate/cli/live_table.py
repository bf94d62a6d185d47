"""The table that a sweep shows while it runs: on a terminal live, elsewhere a line now and then."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any, Self

from innervate.analysis.intervals import mean_interval

if TYPE_CHECKING:
    from pathlib import Path

    from innervate.sweeping.scheduler import Scheduler, State

LINE_EVERY_S = 10.0
DRAW_EVERY_S = 0.2
ROWS_MAX = 20
MEASURES_MAX = 2


class LiveTable:
    """Shows how far a sweep is; a context manager, called with the Scheduler; on stderr.

    Of `measures` the means are shown, as many as there is room for. Whoever interrupts it is told
    what is kept in `folder`. `quiet`, for --json: on a terminal alone.
    """

    def __init__(
        self, name: str, measures: tuple[str, ...], folder: Path, quiet: bool = False
    ) -> None:
        self.words = ""
        self._name = name
        self._folder = folder
        self._measures = measures
        self._terminal = sys.stderr.isatty()
        self._silent = quiet and not self._terminal
        self._live: Any = None
        self._last = time.monotonic()

    @property
    def kept(self) -> str:
        """What is done when it is stopped, and where that is."""
        if not self.words:
            return "nothing is done yet"
        kept = f"they are kept in {self._folder}, and the same command goes on from there"
        return f"{self.words}; {kept}"

    def __enter__(self) -> Self:
        if self._terminal:
            from rich.console import Console
            from rich.live import Live

            self._live = Live(console=Console(stderr=True), auto_refresh=False, transient=True)
            self._live.start()
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if self._live is not None:
            self._live.stop()
            self._live = None
        if kind is KeyboardInterrupt:
            raise KeyboardInterrupt(f"interrupted; {self.kept}") from None

    def __call__(self, scheduler: Scheduler) -> None:
        """The sweep has come so far."""
        self.words = f"{scheduler.done} of {_about(scheduler)} runs done"
        if scheduler.failed:
            self.words += f", {scheduler.failed} failed"
        now, ended = time.monotonic(), scheduler.done == scheduler.total
        if self._silent:
            return
        if scheduler.lacks and self._live is None:
            print(f"{self._name}: {scheduler.lacks}", file=sys.stderr, flush=True)
        elif self._live is not None and (
            now - self._last >= DRAW_EVERY_S or ended or scheduler.lacks
        ):
            self._last = now
            self._live.update(self._table(scheduler), refresh=True)
        elif not self._terminal and now - self._last >= LINE_EVERY_S:
            self._last = now
            print(f"{self._name}: {self.words}{_left(scheduler)}", file=sys.stderr, flush=True)

    def _table(self, scheduler: Scheduler) -> Any:
        from rich.table import Table

        there = [m for m in self._measures if any(m in s.values for s in scheduler.states)]
        shown = there[:MEASURES_MAX]
        title = f"{self._name}: {scheduler.lacks or self.words + _left(scheduler)}"
        table = Table(title=title, title_justify="left", box=None, pad_edge=False)
        table.add_column("point", no_wrap=True, overflow="ellipsis")
        for head in ("runs", *shown):
            table.add_column(head, justify="right", no_wrap=True)
        for state in _interesting(scheduler.states):
            count = f"{state.done}/{state.goal}" + (" done" if state.finished else "")
            label = state.point.label or "all runs"
            table.add_row(label, count, *(_mean(state.series(name)) for name in shown))
        return table


def _interesting(states: list[State]) -> list[State]:
    """As many points as fit: those at work, and those finished last, in the plan's order."""
    if len(states) <= ROWS_MAX:
        return states
    active = [s for s in states if s.done and not s.finished][:ROWS_MAX]
    ended = [s for s in states if s.finished][-max(1, ROWS_MAX - len(active)) :]
    return sorted([*active, *ended][:ROWS_MAX], key=lambda state: state.point.index)


def _mean(values: list[float]) -> str:
    if not values:
        return "-"
    found = mean_interval(values)
    return f"{found.value:.4g} +- {(found.high - found.low) / 2:.2g}"


def _about(scheduler: Scheduler) -> str:
    until = scheduler.plan.until and scheduler.done < scheduler.total
    return f"{'about ' if until else ''}{scheduler.total}"


def _left(scheduler: Scheduler) -> str:
    left = scheduler.left_s
    if left is None or left < 1:
        return ""
    if left < 100:
        return f", about {left:.0f} s left"
    minutes = round(left / 60)
    return f", about {minutes} min left" if minutes < 100 else f", about {minutes / 60:.0f} h left"
