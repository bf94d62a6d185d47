"""The answer of `innervate size` in words: a table, how many ports, which failures do not heal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from innervate.analysis.headline import verb
from innervate.kernel.words import number_of
from innervate.networks.skin.plot.words import end_words
from innervate.sweeping.tables import reasons
from innervate.topology.weak import Weak

if TYPE_CHECKING:
    from innervate.networks.skin.sizing import Answer
    from innervate.topology import Graph

NAMED_MAX = 4
ALONE = "One run of each shows no spread, and no interval: --repeat 20 runs each 20 times."


def answer_lines(answer: Answer) -> list[str]:
    """The answer for people: a table, then how many ports, where, and what does not heal."""
    said = [*_verdicts(answer), *_wayless(answer), *_unhealed(answer)]
    return [*_table(answer), "", *said, *([ALONE] if answer.is_single else [])]


def answer_record(answer: Answer) -> dict[str, Any]:
    """The answer for programs; null where no number of ports that was tried is enough."""
    asked = answer.question
    return {
        "robot": asked.urdf,
        "links": asked.links,
        "cells": answer.cells,
        "pitch_mm": asked.pitch_mm,
        "reach_mm": asked.reach_mm,
        "loss_ratio_max": asked.loss_max,
        "recovery_ms_max": asked.recovery_ms_max,
        "repeat": answer.sweep.plan.repeat,
        "intervals": not answer.is_single,
        "enough": all(ports is not None for ports in answer.needed.values()),
        "rates": [
            {"rate_hz": rate, "ports": ports, "on": answer.where.get(ports, []) if ports else [],
             "ports_but_for_single_failures": answer.carries[rate]}
            for rate, ports in answer.needed.items()
        ],
        "tried": answer.table.to_dicts(),
        "single_failures": {
            str(ports): [{"what": _what(answer.graphs[ports], one), "cells": one.isolated}
                         for one in weak]
            for ports, weak in answer.weak.items()
        },
        "failed": reasons(answer.sweep.failed),
    }  # fmt: skip


def _table(answer: Answer) -> list[str]:
    asked = answer.question
    if answer.frames:
        what = number_of(answer.cells, "skin frame") + " of the robot"
    else:
        what = f"{number_of(answer.cells, 'cell')} {asked.pitch_mm:g} mm apart"
    lines = [
        f"{what}, cables of at most {asked.reach_mm:g} mm",
        "",
        f"{'rate':>8} {'ports':>5}  {'lost on the way':>16}  {'recovery, ms':>15}  "
        f"{'after a port, ms':>16}  {'one failure cuts off':>20}  enough",
    ]
    for row in answer.table.iter_rows(named=True):
        cells = (_interval(row, "loss_cell", 100, 2, " %"), _interval(row, "recovery_ms_cell"),
                 _interval(row, "recovery_ms_pc"))  # fmt: skip
        worst = row["isolated_max"]
        gone = "nobody" if worst == 0 else f"up to {number_of(worst, 'cell')}" if worst else "-"
        lines.append(
            f"{row['rate_hz']:>5g} Hz {row['ports']:>5}  {cells[0]:>16}  {cells[1]:>15}  "
            f"{cells[2]:>16}  {gone:>20}  {'yes' if row['enough'] else 'no'}"
        )
    return lines


def _verdicts(answer: Answer) -> list[str]:
    """How many ports every rate needs."""
    asked, lines = answer.question, []
    once = " in the one run made" if answer.is_single else ""
    limits = f"{100 * asked.loss_max:g} % lost, ways back in {asked.recovery_ms_max:g} ms"
    for rate, ports in answer.needed.items():
        begin, least = f"{rate:g} Hz:", answer.carries[rate]
        none = f"{begin} none of {_tried(asked.ports)} is enough"
        if ports is not None:
            places = ", ".join(answer.where[ports])
            lines.append(f"{begin} {number_of(ports, 'port')} {verb(ports, 'is')} enough{once} "
                         f"for {limits}, and every single failure of a cable or cell heals, "
                         f"on {places}.")  # fmt: skip
        elif least is not None:
            lines.append(f"{none}: {number_of(least, 'port')} {verb(least, 'is')} enough{once} for "
                         f"{limits}, but not every single failure heals.")  # fmt: skip
        else:
            lines.append(f"{none} for {limits}.")
    return lines


def _tried(ports: Sequence[int]) -> str:
    """What was tried: "up to 8 ports", where that is all up to then."""
    if tuple(ports) == tuple(range(1, len(ports) + 1)):
        return f"up to {number_of(len(ports), 'port')}"
    named = [str(one) for one in ports]
    if len(named) > 2 * NAMED_MAX:
        named[NAMED_MAX:-1] = ["..."]
    return f"the numbers of ports that were tried ({', '.join(named)})"


def _wayless(answer: Answer) -> list[str]:
    """Where cables still reached cells that got no way again: they are too far round."""
    return [
        f"{row['rate_hz']:g} Hz, {number_of(row['ports'], 'port')}: in "
        f"{number_of(row['unhealed'], 'run')} cells that cables still reached had no way in the "
        "end; the way round may have more hops than protocol.max_depth allows."
        for row in answer.table.iter_rows(named=True)
        if row["unhealed"]
    ]


def _unhealed(answer: Answer) -> list[str]:
    """Why numbers of ports that carry the load are not enough: who isolates whom."""
    lines = []
    for ports in sorted({least for least in answer.carries.values() if least is not None}):
        weak = answer.weak[ports]
        if weak:
            named = [_named(answer.graphs[ports], one) for one in weak[:NAMED_MAX]]
            more = f", and {len(weak) - NAMED_MAX} more" if len(weak) > NAMED_MAX else ""
            failures = number_of(len(weak), "single failure")
            cut = "cut" if len(weak) > 1 else "cuts"
            have = f"With {number_of(ports, 'port')} {failures} {cut} off cells for good"
            lines.append(f"{have}: {', '.join(named)}{more}.")
    if lines:
        lines.append("Longer cables between cells (--reach), or more ports (--ports), may give "
                     "those cells a second way.")  # fmt: skip
    return lines


def _named(graph: Graph, weak: Weak) -> str:
    """A weak point: "cable n1 E - n2 W (44 cells)", "cell n1 (3 cells)"."""
    return f"{_what(graph, weak)} ({number_of(weak.isolated, 'cell')})"


def _what(graph: Graph, weak: Weak) -> str:
    return f"cell {graph.label(weak.node)}" if weak.node >= 0 else end_words(graph, weak.end)


def _interval(
    row: dict[str, Any], name: str, scale: float = 1.0, digits: int = 1, unit: str = ""
) -> str:
    """Mean and half the interval's width; one run alone has none."""
    if row[f"{name}_mean"] is None:
        return "-"
    half = scale * (row[f"{name}_high"] - row[f"{name}_low"]) / 2
    width = f" +- {half:.{digits}f}" if row[f"{name}_runs"] > 1 else ""
    return f"{scale * row[f'{name}_mean']:.{digits}f}{width}{unit}"
