"""What a person sees while work goes on: a bar on a terminal, lines elsewhere; on stderr."""

import sys
import threading
import time
from typing import Any, Self

from innervate.network import networks

COMPILING = "compiling the simulation ({}), once on this machine: about half a minute"
LINE_EVERY_S = 10.0
STILL_EVERY_S = 30.0  # a line of what is still compiling, where there is no bar


class Display:
    """Shows how far some work is; a context manager. `quiet`, for --json: on a terminal alone."""

    def __init__(self, quiet: bool = False) -> None:
        self._terminal = sys.stderr.isatty()
        self._silent = quiet and not self._terminal
        self._bars: Any = None
        self._task: Any = None
        self._last_line = time.monotonic()

    def __enter__(self) -> Self:
        self._last_line = time.monotonic()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bars is not None:
            self._bars.stop()

    def begin(self, what: str, line: bool) -> None:
        """Say what is being done while nobody knows how long it takes; `line`: elsewhere too."""
        if self._terminal:
            self._open_bars(what)
        elif line and not self._silent:
            self._line(what)

    def show(self, what: str, done: int, total: int, left_s: float | None) -> None:
        """So far `done` of `total`, 0 = nobody knows; lines come only now and then."""
        if self._bars is not None:
            self._bars.update(self._task, description=what, completed=done, total=total or None)
            return
        if (
            self._silent
            or time.monotonic() - self._last_line <= LINE_EVERY_S
            or (0 < total <= done)
        ):
            return
        self._line(what if left_s is None else f"{what}, about {left_s:.0f} s left")

    def _open_bars(self, what: str) -> None:
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            SpinnerColumn,
            Task,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )
        from rich.progress import Progress as Bars
        from rich.text import Text

        class Left(TimeRemainingColumn):
            def render(self, task: Task) -> Text:
                told = super().render(task)
                return told.append(" left") if told.plain.strip("-:") else Text()

        self._bars = Bars(
            SpinnerColumn(),
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=24),
            TimeElapsedColumn(),
            Left(),
            console=Console(stderr=True),
            transient=True,
        )
        self._task = self._bars.add_task(what, total=None)
        self._bars.start()

    def _line(self, text: str) -> None:
        self._last_line = time.monotonic()
        print(text, file=sys.stderr, flush=True)


class Progress(Display):
    """How far a simulation is; it is called with the simulated time.

    Args:
        loop: what has to be compiled first, as `uncompiled` says it; "" nothing.
    """

    def __init__(self, loop: str = "", quiet: bool = False) -> None:
        super().__init__(quiet)
        self._loop = loop
        self._first: tuple[float, int] | None = None
        self._runs = threading.Event()  # compiling is over

    def __enter__(self) -> Self:
        super().__enter__()
        what = COMPILING.format(self._loop) if self._loop else "preparing"
        self.begin(what, line=bool(self._loop))
        if self._loop and not (self._terminal or self._silent):
            threading.Thread(target=self._compiling, daemon=True).start()
        return self

    def __exit__(self, *how: object) -> None:
        self._runs.set()
        super().__exit__(*how)

    def _compiling(self) -> None:
        """Lines now and then until the first of the simulation: beside other work it takes long."""
        begun = time.monotonic()
        while not self._runs.wait(STILL_EVERY_S):
            self._line(f"still compiling, after {time.monotonic() - begun:.0f} s")

    def __call__(self, now_us: int, duration_us: int) -> None:
        """The simulation has come to `now_us` of `duration_us`."""
        clock = time.monotonic()
        if self._first is None:  # all before was compiling and building
            self._first = (clock, now_us)
            self._runs.set()
        took, came = clock - self._first[0], now_us - self._first[1]
        left_s = took * (duration_us - now_us) / came if came > 0 else None
        what = f"simulated {now_us / 1e6:.2f} of {duration_us / 1e6:g} s"
        self.show(what, now_us, duration_us, left_s)


def uncompiled(plan: Any) -> str:
    """The loop that has to be compiled for a plan: "mesh-32", "radio, dcf"; "" none has to be."""
    from innervate.kernel import compilation

    name = networks()[plan.kind].loop_name(plan)
    if not name or compilation.is_compiled(name):
        return ""
    return name if name.startswith(plan.kind) else f"{plan.kind}, {name}"
