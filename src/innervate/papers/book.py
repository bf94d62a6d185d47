"""Runs a paper's experiments over all cores, keeps what comes, draws and tabulates.

Results are stored one by one in `results.jsonl` of the output folder. A second run does only what
is missing: after an interrupt, for other figures, or when the sources have changed.
"""

import os
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

from innervate.kernel.cache import is_free
from innervate.network import networks
from innervate.papers import output
from innervate.papers.errors import PapersError
from innervate.papers.experiment import Experiment, Measured, Point
from innervate.papers.store import Store
from innervate.plot import style
from innervate.sweeping.engines import cores
from innervate.trace.sources import stamp

RESULTS = "results.jsonl"
COMPARE = "compare"  # the book of comparisons, which is no network's


@dataclass(frozen=True, slots=True)
class Step:
    """How far the work is."""

    # done, total: pieces of work; `total` counts only those that had to be run
    done: int
    total: int
    what: str  # what is being done, in words
    left_s: float | None  # about how long it will take from here; None while nobody can know


Progress = Callable[[Step], None]


def main(
    system: str,
    out: str | os.PathLike[str] = "papers",
    quick: bool = False,
    only: Iterable[str] = (),
    progress: Progress | None = None,
    redraw: bool = False,
) -> Path:
    """Draw and tabulate the figures of a paper.

    Args:
        system: one of `books()`: which network's papers, or "compare".
        out: folder for the figures, tables and kept results.
        quick: few seeds and settings, in under a minute.
        only: names of figures ("fig8a"); empty = all.
        progress: called with a Step after each piece of work.
        redraw: use kept results even if they are of other sources than the present ones.

    Returns:
        The page with everything, papers-<system>.html; beside it stand a PNG and an SVG for each
        figure and the table as CSV and Markdown. With `only` they have those figures, and the
        others that a page in the folder has already.

    Raises:
        PapersError: no such paper or figure, the folder cannot be used, or of what its page has
            besides not all results are kept.
        KeyboardInterrupt: it was interrupted; what was done is kept.
    """
    paper = book_of(system)
    chosen, folder, mark = _chosen(paper, only), Path(out), stamp()
    with _taken(folder):
        store = Store(folder / RESULTS, mark, any_stamp=redraw)
        there = _there(paper, output.page_of(folder, system), store, quick, chosen)
        names = [name for name in paper.FIGURES if name in (*chosen, *there)]
        experiments = [paper.experiment(name) for name in names]
        book = _Book(folder, store, quick, progress or (lambda step: None), paper.warm_up)
        started = time.perf_counter()
        with style.house():
            book.work(experiments)
        command = _command(system, quick, names if len(names) < len(paper.FIGURES) else [])
        heading = output.Heading(
            system, paper.TITLE, paper.AUTHORS, quick, mark, redraw, command, paper.READINGS
        )
        wall_s = time.perf_counter() - started
        return output.write(folder, heading, experiments, book.made, wall_s)


def into_page(page: Path, system: str, folder: Path, only: Iterable[str] = ()) -> None:
    """Put the tables that `main` left in a folder into a page of Markdown, between its marks.

    Raises:
        PapersError: the book has no tables, there is no such page, or it has no marks for one.
    """
    for name in _chosen(book_of(system), only):
        tables = folder / f"{system}-{name}.md"
        if not tables.exists():
            raise PapersError(f"papers {system} has no tables for a page; leave out --page")
        output.insert(page, f"{system}-{name}", tables.read_text(encoding="utf-8"))


def ready_for(system: str, page: Path | None, only: Iterable[str] = ()) -> None:
    """That `main` and `into_page` can be done, as far as it shows before hours of work.

    Raises:
        PapersError: there is no such paper or figure, no such page, or it has no marks for one.
    """
    for name in _chosen(book_of(system), only):
        if page is not None:
            output.around(page, f"{system}-{name}")


def _command(system: str, quick: bool, only: Sequence[str]) -> str:
    words = ["innervate papers", system, *(["--quick"] if quick else [])]
    return " ".join([*words, *(f"--only {name}" for name in only)])


def papers() -> list[str]:
    """Networks whose papers can be redrawn."""
    return [name for name, network in networks().items() if network.has("papers")]


def books() -> list[str]:
    """All that `main` takes: those papers, and the comparison."""
    return [*papers(), COMPARE]


def book_of(system: str) -> Any:
    """TITLE, AUTHORS, FIGURES, READINGS, experiment, warm_up of a book; a PapersError if none."""
    known = books()
    if system not in known:
        raise PapersError(f'there is no paper "{system}"; choose from: {", ".join(known)}')
    if system == COMPARE:
        from innervate.papers import compare  # asks all networks what they compare

        return compare
    return networks()[system].papers


def _chosen(paper: ModuleType, only: Iterable[str]) -> list[str]:
    """Names of figures in the paper's order."""
    wanted = [name.strip() for name in only]
    for name in wanted:
        if name not in paper.FIGURES:
            message = f'there is no figure "{name}"; choose from: {", ".join(paper.FIGURES)}'
            raise PapersError(message)
    return [name for name in paper.FIGURES if name in wanted or not wanted]


def _there(paper: Any, page: Path, store: Store, quick: bool, chosen: Sequence[str]) -> list[str]:
    """Figures that a page has besides those that are made anew: to stay there, if they can."""
    was_quick, shown = output.shown_on(page, paper.FIGURES)
    others = [name for name in shown if name not in chosen]
    keys = [point.key for name in others for point in paper.experiment(name).points(quick)]
    if others and (was_quick != quick or store.missing(keys)):
        raise PapersError(
            f"{page} has other figures, too, of other settings or sources, which --only would "
            "take away; name another folder with --out, or leave --only out"
        )
    return others


@contextmanager
def _taken(folder: Path) -> Iterator[None]:
    """While no other process draws there, where files can be locked at all."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        results = (folder / RESULTS).open("a", encoding="utf-8")
    except OSError as error:
        raise PapersError(f"{folder}: {error.strerror or error}; name another folder") from None
    with results:
        if not is_free(results):
            raise PapersError(
                f"another innervate papers is at work in {folder}; wait for it, or choose --out"
            )
        yield


@dataclass(slots=True)
class _Book:
    """Runs what is missing, and draws each experiment as soon as it has all its results."""

    folder: Path
    store: Store
    quick: bool
    progress: Progress
    warm_up: Callable[[], None]
    made: output.Made = field(default_factory=output.Made)
    _started: float = field(default_factory=time.perf_counter)
    _spent: float = 0.0
    _whole: float = 0.0
    _done: int = 0
    _total: int = 0

    def work(self, experiments: Sequence[Experiment]) -> None:
        needs = {e.name: {p.key: p for p in e.points(self.quick)} for e in experiments}
        missing = {
            key: point
            for points in needs.values()
            for key, point in points.items()
            if key not in self.store.values
        }
        self._total = len(missing)
        self._whole = sum(point.cost_s for point in missing.values())
        waiting = list(experiments)
        if missing:
            self._say("compiling the simulation, unless it is compiled")
            # Compiled before threads want it at the same time.
            for warm_up in dict.fromkeys(one.warm_up or self.warm_up for one in experiments):
                warm_up()
            self._started = time.perf_counter()
        with ThreadPoolExecutor(cores()) as pool:
            running = {pool.submit(self._run, point): point for point in missing.values()}
            try:
                self._finish(waiting, needs)
                for future in as_completed(running):
                    future.result()
                    self._done += 1
                    self._spent += running[future].cost_s
                    self._say(running[future].key)
                    self._finish(waiting, needs)
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise

    def _run(self, point: Point) -> None:
        self.store.put(point.key, point.work())

    def _finish(self, waiting: list[Experiment], needs: dict[str, Any]) -> None:
        """Draw and judge those that have everything."""
        for experiment in list(waiting):
            if self.store.missing(list(needs[experiment.name])):
                continue
            waiting.remove(experiment)
            self._say(f"drawing {experiment.name}")
            got = Measured(self.store.values, self.quick)
            style.save(experiment.draw(got), self.folder, experiment.name)
            self.made.claims[experiment.name] = list(experiment.judge(got))
            self.made.sheets[experiment.name] = list(experiment.sheets(got))

    def _say(self, what: str) -> None:
        left = None
        if self._spent > 0:
            took = time.perf_counter() - self._started
            left = took * (self._whole - self._spent) / self._spent
        self.progress(Step(self._done, self._total, what, left))
