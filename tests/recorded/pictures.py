"""What is drawn, kept as text: the judge of a change that is to draw the same.

`python -m tests.recorded.pictures` draws everything anew and writes `pictures/`; `--check` compares
instead, and names the picture, the panel, what was and what is. `--show FOLDER` leaves all of it as
pages and PNGs to be looked at, which one does before recording anew.

Of the papers, rows are kept (`papers/*.rows.gz`, by `python -m tests.recorded.record`): figures and
claims are made of them. What a full run would simulate is kept in words.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from difflib import SequenceMatcher
from functools import cache, partial
from itertools import groupby
from pathlib import Path
from typing import Any

from innervate.papers import book, output
from innervate.papers.experiment import Measured, Point
from innervate.plot import style
from tests.recorded import record, scenes
from tests.recorded.looks import Picture, digest
from tests.recorded.scenes import Drawn, text_of

HERE = Path(__file__).resolve().parent
KEPT = HERE / "pictures"
SHOWN = 6  # lines of a difference


rows = cache(record.rows)


def experiments(system: str) -> list[Any]:
    """All figures of a paper."""
    paper = book.book_of(system)
    return [paper.experiment(name) for name in paper.FIGURES]


def of_paper(system: str) -> Iterator[tuple[str, Drawn]]:
    """Its figures, its page, and what its runs would be."""
    for one in experiments(system):
        yield one.name, lambda one=one: drawn(one, system)
    for one in experiments(system):
        yield f"{one.name}, runs", lambda one=one: plans(one)
    yield "page", lambda: page(system)


def drawn(experiment: Any, system: str) -> Any:
    """A figure, of the rows kept."""
    with style.house():
        return experiment.draw(Measured(rows(system), True))


@cache
def judged(system: str, quick: bool = True) -> dict[str, Any]:
    """What each figure's claims come to, of the rows kept."""
    return {one.name: list(one.judge(Measured(rows(system), quick))) for one in experiments(system)}


def page(system: str, quick: bool = True) -> str:
    """The page of a paper, with one empty picture for all, as its rows make it."""
    paper = book.book_of(system)
    chosen = experiments(system)
    made = output.Made(
        judged(system, quick),
        {one.name: list(one.sheets(Measured(rows(system), quick))) for one in chosen},
    )
    heading = output.Heading(
        system, paper.TITLE, paper.AUTHORS, quick, "stamp", False, "again", paper.READINGS
    )
    with tempfile.TemporaryDirectory() as folder:
        for one in chosen:
            Path(folder, f"{one.name}.svg").write_text(f'<svg width="{390 + len(one.name)}pt"/>')
        return output.as_page(Path(folder), heading, chosen, made, {"innervate": "1"})


def plans(experiment: Any) -> list[str]:
    """What would be run, in both sizes: function, how often, the first, the last, all others."""
    lines = []
    for quick in (True, False):
        points = experiment.points(quick)
        for name, group in groupby(points, key=lambda point: call(point)[0]):
            some = list(group)
            said = [f"{point.key} | {call(point)[1]}" for point in some]
            cost = sum(point.cost_s for point in some)
            lines.append(f"{'small' if quick else 'full'}: {len(some)} x {name}, about {cost:.3g} s"
                         f" #{digest(chr(10).join(said))}")  # fmt: skip
            lines += [f"  {line}" for line in dict.fromkeys((said[0], said[-1]))]
    return lines


def call(point: Point) -> tuple[str, str]:
    """The name of what a point calls, and with what."""
    work, arguments = opened(point.work, [])
    if work.__name__ == "columns":
        work, arguments = opened(arguments[0], arguments[1:])
    own = getattr(work, "__self__", None)
    words = ", ".join(map(plain, arguments if own is None else [own, *arguments]))
    return f"{work.__module__.rpartition('.')[2]}.{work.__qualname__}", words


def opened(work: Any, arguments: list[Any]) -> tuple[Any, list[Any]]:
    """A function, and what it is called with, out of the partial ones round it."""
    while isinstance(work, partial):
        arguments = [*work.args, *work.keywords.items(), *arguments]
        work = work.func
    return work, arguments


def plain(value: Any) -> str:
    """A value in words that are the same in every process."""
    if isinstance(value, tuple | list):
        return f"({', '.join(map(plain, value))})"
    if isinstance(value, dict):  # what a case of a comparison gives: all its cables
        return f"{', '.join(value)} #{digest(repr(value))}"
    if callable(value):
        return str(getattr(value, "__qualname__", type(value).__name__))
    text = re.sub(r"<function (\S+) at 0x\w+>", r"\1", repr(value))
    return re.sub(r" at 0x\w+", "", text)


GROUPS: dict[str, Callable[[], Iterator[tuple[str, Drawn]]]] = {
    "skin": scenes.of_skin, "radio": scenes.of_radio, "mesh": scenes.of_mesh,
    "spine": scenes.of_spine,
    **{f"papers-{book}": partial(of_paper, book) for book in ("skin", "radio", "mesh", "compare")},
}  # fmt: skip


def recorded(group: str) -> dict[str, Picture]:
    """The pictures as they were recorded."""
    found: dict[str, Picture] = json.loads((KEPT / f"{group}.json").read_text(encoding="utf-8"))
    return found


def differences(name: str, was: Picture, found: Picture) -> list[str]:
    """Where two pictures differ: panel, what was, what is; the first lines of each."""
    lines = []
    for panel in dict.fromkeys((*was, *found)):
        old, new = was.get(panel), found.get(panel)
        if old is None or new is None:
            lines.append(f"{name}, {panel}: {'was not there' if old is None else 'is gone'}")
            continue
        if old == new:
            continue
        for kind, a, b, c, d in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
            if kind != "equal":
                lines += [f"{name}, {panel}: was {line}" for line in old[a:b][:SHOWN]]
                lines += [f"{name}, {panel}: is  {line}" for line in new[c:d][:SHOWN]]
    return lines


def main() -> int:
    """Record, compare or show."""
    parser = argparse.ArgumentParser(description=__doc__, prog="python -m tests.recorded.pictures")
    parser.add_argument("--check", action="store_true", help="compare; write nothing")
    parser.add_argument("--show", type=Path, metavar="FOLDER", help="draw to be looked at")
    parser.add_argument("--only", choices=GROUPS, action="append", help="a group; all if none")
    asked = parser.parse_args()
    lost = []
    for group in asked.only or GROUPS:
        if asked.show is not None:
            show(group, asked.show / group)
            continue
        found = {name: text_of(draw()) for name, draw in GROUPS[group]()}
        if asked.check:
            kept = recorded(group)
            for name in dict.fromkeys((*kept, *found)):
                lost += differences(f"{group}: {name}", kept.get(name, {}), found.get(name, {}))
        else:
            text = json.dumps(found, indent=0, ensure_ascii=False)
            KEPT.mkdir(exist_ok=True)
            (KEPT / f"{group}.json").write_text(text + "\n", encoding="utf-8")
    print("\n".join(lost) if lost else "all the same" if asked.check else "written")
    return 1 if lost else 0


def show(group: str, folder: Path) -> None:
    """Leave every picture of a group in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in GROUPS[group]():
        made, stem = draw(), re.sub(r"[^\w]+", "-", name).strip("-")
        if isinstance(made, str):
            (folder / f"{stem}.html").write_text(made, encoding="utf-8")
        elif isinstance(made, list):
            (folder / f"{stem}.txt").write_text("\n".join(map(str, made)), encoding="utf-8")
        elif hasattr(made, "render"):
            scenes.save(made, folder / f"{stem}.svg")
        else:
            with style.house():
                style.save(made, folder, stem)


if __name__ == "__main__":
    sys.exit(main())
