"""`innervate verify radio`: offers, delays and draws on a grid."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from innervate.cli import errors
from innervate.cli.progress import Display

if TYPE_CHECKING:
    from innervate.cli.verify_options import VerifyOptions
    from innervate.running.radio_grid import Found, Grid
    from innervate.running.radio_tree import Grown, Tree


def search(options: VerifyOptions, as_json: bool) -> int:
    """Run the grids of 2 stations up to as many as asked for; 1 if something is broken."""
    from innervate.kernel.stop import Stop
    from innervate.running import radio_grid, radio_tree

    wanted = _grids(options.cells or 3, options.rule or "practical")
    done: list[Found | Grown] = []
    with Stop() as stop, Display(as_json) as display:
        display.begin("radio on a grid; the first time compiles for about half a minute", line=True)
        for grid in wanted:

            def tell(found: Found) -> bool:
                what = f"{found.grid.stations} stations: {found.done} of {found.grid.points} points"
                display.show(what, found.done, found.grid.points, None)
                return stop.asked

            def grows(grown: Grown) -> bool:
                what = f"{grown.tree.grid.stations} stations, every draw: {grown.runs} runs"
                display.show(what, 0, 1 << 40, None)
                return stop.asked

            found = radio_grid.search(grid, tell, options.states)
            done.append(found)
            if not as_json:
                for line in _lines(found):
                    print(line, flush=True)
            if not stop.asked:
                grown = radio_tree.search(_tree(grid), limit=options.states, progress=grows)
                done.append(grown)
                if not as_json:
                    print(tree_line(grown), flush=True)
            if stop.asked:
                break
    if as_json:
        print(json.dumps([one.as_dict() for one in done], indent=2))
    if stop.asked:
        return errors.INTERRUPTED
    return 1 if any(one.broken for one in done) else 0


def _grids(stations: int, mode: str) -> list[Grid]:
    from innervate.running.radio_grid import MODES, STATIONS, Grid

    if stations not in STATIONS:
        raise errors.UserError(f"--cells is 2 to 4 stations for radio, not {stations}")
    if mode not in MODES:
        raise errors.UserError(f'--rule is {" or ".join(MODES)} for radio, not "{mode[:40]}"')
    coarse = {"parts": 2, "offers_us": (0, 52, 208)}
    sizes: dict[int, dict[str, Any]] = {2: {"draws": 2}, 3: coarse, 4: coarse}
    turnarounds = (0, 2000) if mode == "practical" else (0,)
    return [
        Grid(count, mode, ta, **sizes[count])
        for count in range(2, stations + 1)
        for ta in turnarounds
    ]


def _lines(found: Found) -> list[str]:
    from innervate.running.radio_grid import WORDS, story

    grid = found.grid
    head = f"{grid.stations} stations, {grid.mode}, turnaround {grid.turnaround_us} us: "
    head += f"{found.done:,} of {grid.points:,} points in {found.wall_s:.1f} s"
    if not found.broken:
        return [f"{head}; all delivered, in order, nothing lost silently"]
    lines = [head]
    for code, count in found.broken.items():
        lines.append(f"    BROKEN at {count:,} points: {WORDS[code]}. The first:")
        told = enumerate(story(grid, found.first[code]), 1)
        lines += [f"        {number}. {sentence}" for number, sentence in told]
    return lines


def _tree(grid: Grid) -> Tree:
    """The tree of draws beside a grid: fewer moments and delays, every answer to a draw."""
    from innervate.running.radio_tree import Tree

    depth, delays_us = {2: (6, (52, 104)), 3: (4, (104,)), 4: (3, (104,))}[grid.stations]
    return Tree(replace(grid, offers_us=(0, 52), delays_us=delays_us), depth)


def tree_line(grown: Grown) -> str:
    """What came of a tree."""
    from innervate.running.radio_grid import WORDS

    grid = grown.tree.grid
    head = f"{grid.stations} stations, {grid.mode}, turnaround {grid.turnaround_us} us: "
    head += f"every answer to the first {grown.tree.depth} draws, {grown.runs:,} runs"
    part = "" if grown.ended == "complete" else f" ({grown.ended})"
    head += f"{part} in {grown.wall_s:.1f} s"
    if not grown.broken:
        return f"{head}; all delivered, in order, nothing lost silently"
    told = ", ".join(f"{WORDS[code]} ({count:,} runs)" for code, count in grown.broken.items())
    return f"{head}; BROKEN: {told}"
