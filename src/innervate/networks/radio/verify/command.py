"""What `innervate verify radio` does: offers, delays and draws on a grid, and trees of draws."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

from innervate.kernel.words import number_of
from innervate.networks.radio.verify import grid as grids
from innervate.networks.radio.verify import tree as trees
from innervate.networks.radio.verify.grid import MODES, STATIONS, WORDS, Found, Grid, story
from innervate.networks.radio.verify.mutants import MUTANTS, hunt
from innervate.networks.radio.verify.tree import Grown, Tree
from innervate.verify.cases import Case, Explore, Story, Tell, only
from innervate.verify.errors import VerifyError

__all__ = ["MUTANTS", "hunt"]


def notice(options: Any) -> str:
    """What to say before the first."""
    return "radio on a grid; the first time compiles for about half a minute"


def explorations(_network: Any, options: Any) -> Iterator[Explore]:
    """Grids of 2 stations up to as many as asked for, and a tree beside each."""
    only("radio", options, "rule", "cells")
    wanted = _grids(options.cells or 3, options.rule or "practical")
    return (
        partial(explore, grid, options.states) for grid in wanted for explore in (_search, _grow)
    )


def _search(grid: Grid, limit: int, tell: Tell) -> Case:
    def progress(found: Found) -> bool:
        what = f"{found.grid.stations} stations: {found.done} of {found.grid.points} points"
        return tell(what, found.done, found.grid.points)

    found = grids.search(grid, progress, limit)
    return _case(found, _lines(found), lambda code: story(grid, found.first[code]))


def _grow(grid: Grid, limit: int, tell: Tell) -> Case:
    def progress(grown: Grown) -> bool:
        what = f"{grown.tree.grid.stations} stations, every draw: {grown.runs} runs"
        return tell(what, 0, 0)

    grown = trees.search(_tree(grid), limit=limit, progress=progress)
    return _case(grown, [_tree_line(grown)], partial(trees.story, grown))


def _case(found: Found | Grown, lines: list[str], tell: Callable[[int], list[str]]) -> Case:
    """What came of it; `tell` gives the sentences of the first thing that broke, by its number."""
    code, is_all = next(iter(found.broken), None), found.ended == "complete"
    told = None if code is None else Story(WORDS[code], tell(code))
    return Case(lines, found.as_dict(), bool(found.broken), is_all, sums_up=False, story=told)


def _grids(stations: int, mode: str) -> list[Grid]:
    if stations not in STATIONS:
        raise VerifyError(f"--cells is 2 to 4 stations for radio, not {stations}")
    if mode not in MODES:
        raise VerifyError(f'--rule is {" or ".join(MODES)} for radio, not "{mode[:40]}"')
    coarse = {"parts": 2, "offers_us": (0, 52, 208)}
    sizes: dict[int, dict[str, Any]] = {2: {"draws": 2}, 3: coarse, 4: coarse}
    turnarounds = (0, 2000) if mode == "practical" else (0,)
    return [
        Grid(count, mode, ta, **sizes[count])
        for count in range(2, stations + 1)
        for ta in turnarounds
    ]


def _lines(found: Found) -> list[str]:
    grid = found.grid
    head = f"{grid.words}: {found.done:,} of {grid.points:,} points in {found.wall_s:.1f} s"
    if not found.broken:
        return [f"{head}; all delivered, in order, nothing lost silently"]
    lines = [head]
    for code, count in found.broken.items():
        lines.append(f"    BROKEN at {number_of(count, 'point')}: {WORDS[code]}. The first:")
        sentences = [*story(grid, found.first[code]), f"So: {WORDS[code]}."]
        told = enumerate(sentences, 1)
        lines += [f"        {number}. {sentence}" for number, sentence in told]
    return lines


def _tree(grid: Grid) -> Tree:
    """The tree of draws beside a grid: fewer moments and delays, every answer to a draw."""
    depth, delays_us = {2: (6, (52, 104)), 3: (4, (104,)), 4: (3, (104,))}[grid.stations]
    return Tree(replace(grid, offers_us=(0, 52), delays_us=delays_us), depth)


def _tree_line(grown: Grown) -> str:
    """What came of a tree."""
    part = "" if grown.ended == "complete" else f" ({grown.ended})"
    head = f"{grown.tree.grid.words}: every answer to the first {grown.tree.depth} draws, "
    head += f"{number_of(grown.runs, 'run')}{part} in {grown.wall_s:.1f} s"
    if not grown.broken:
        return f"{head}; all delivered, in order, nothing lost silently"
    told = [f"{WORDS[code]} ({number_of(runs, 'run')})" for code, runs in grown.broken.items()]
    return f"{head}; BROKEN: {', '.join(told)}"
