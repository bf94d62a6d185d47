"""What `innervate verify radio` does: offers, delays and draws on a grid, and trees of draws."""

from collections.abc import Iterator
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
    code = next(iter(found.broken), None)
    told = None if code is None else _told(code, story(grid, found.first[code]))
    return _case(found, _lines(found), told)


def _grow(grid: Grid, limit: int, tell: Tell) -> Case:
    def progress(grown: Grown) -> bool:
        what = f"{grown.tree.grid.stations} stations, every draw: {grown.runs} runs"
        return tell(what, 0, 0)

    grown = trees.search(_tree(grid), limit=limit, progress=progress)
    code = next(iter(grown.broken), None)
    told = None if code is None else _told(code, trees.story(grown, code))
    return _case(grown, [_tree_line(grown)], told)


def _told(code: int, sentences: list[str]) -> Story:
    """What is written of the first thing that broke: the last of its sentences is the title."""
    return Story(WORDS[code], [one for one in sentences if not one.startswith("So: ")])


def _case(found: Found | Grown, lines: list[str], told: Story | None) -> Case:
    is_all = found.ended == "complete"
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
    head = f"{grid.stations} stations, {grid.mode}, turnaround {grid.turnaround_us} us: "
    head += f"{found.done:,} of {grid.points:,} points in {found.wall_s:.1f} s"
    if not found.broken:
        return [f"{head}; all delivered, in order, nothing lost silently"]
    lines = [head]
    for code, count in found.broken.items():
        lines.append(f"    BROKEN at {number_of(count, 'point')}: {WORDS[code]}. The first:")
        told = enumerate(story(grid, found.first[code]), 1)
        lines += [f"        {number}. {sentence}" for number, sentence in told]
    return lines


def _tree(grid: Grid) -> Tree:
    """The tree of draws beside a grid: fewer moments and delays, every answer to a draw."""
    depth, delays_us = {2: (6, (52, 104)), 3: (4, (104,)), 4: (3, (104,))}[grid.stations]
    return Tree(replace(grid, offers_us=(0, 52), delays_us=delays_us), depth)


def _tree_line(grown: Grown) -> str:
    """What came of a tree."""
    grid = grown.tree.grid
    head = f"{grid.stations} stations, {grid.mode}, turnaround {grid.turnaround_us} us: "
    head += f"every answer to the first {grown.tree.depth} draws, {number_of(grown.runs, 'run')}"
    part = "" if grown.ended == "complete" else f" ({grown.ended})"
    head += f"{part} in {grown.wall_s:.1f} s"
    if not grown.broken:
        return f"{head}; all delivered, in order, nothing lost silently"
    told = [f"{WORDS[code]} ({number_of(runs, 'run')})" for code, runs in grown.broken.items()]
    return f"{head}; BROKEN: {', '.join(told)}"
