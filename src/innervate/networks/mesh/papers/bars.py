"""What was asked for, in one table: thirty nodes, eight neighbours in the mean, 250 kbit/s."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.papers import alarms, crossing, gateway, sending
from innervate.networks.mesh.papers.testbed import MeshTestbed
from innervate.networks.mesh.papers.words import seeds_of
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.scenario.plan import CLASSES
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

DEAD = 8
ROUND = MeshTestbed()  # ends before the second discovery round
STATE_NODES = 50
STATE_MAX = 4096


class Bar(NamedTuple):
    """Something that was asked for.

    Attributes:
        words: what.
        asked, got: the bar and what was measured, in words.
        used: how much of what is allowed was used; 1 = just reached.
        of: runs, crossings, messages.
    """

    words: str
    asked: str
    got: str
    used: float
    of: str


def measure_round(testbed: MeshTestbed, seed: int) -> dict[str, Any]:
    """One discovery round and its tables."""
    summary = summarize(testbed.run(seed))
    return {name: summary["discovery"][name] for name in ("recall", "tables_s", "with_tables")}


def crossings(quick: bool) -> range:
    """Seeds of the crossings: those of the figure of alarms."""
    return alarms.seeds_of(quick)


def rounds(quick: bool) -> range:
    """Networks in which one round is looked at: a mean of a few says nothing of two percent."""
    return range(1, 31 if quick else 101)


def sent(quick: bool) -> range:
    """Networks in which messages are sent."""
    return range(1, 5 if quick else 101)


def points(quick: bool) -> list[Point]:
    """A round; messages and crossings with 8 dead; the gateway's death."""
    return [
        ROUND.point("round", rounds(quick), measure_round),
        *(sending.point(sending.make_testbed(rule), DEAD, sent(quick)) for rule in _RULES),
        *(crossing.point(scheme, DEAD, crossings(quick)) for scheme in _SCHEMES),
        *(gateway.point(setting, seeds_of(quick)) for setting in _TAKEN),
    ]


_RULES = (sending.SEARCH, sending.GRAPH, sending.DOCUMENT)
_SCHEMES = (crossing.BOTH,)
_TAKEN = (gateway.SILENT, gateway.ONE)


def wire_bytes(nodes: int) -> int:
    """Bytes of a node's state in whole bytes a value, by the declared ranges.

    Without what only gateways have, and without queued frames.
    """
    width = next(size for size in CLASSES if nodes <= size)
    queued = {name for name, *_ in mesh_fields.QUEUED}
    total = 0
    for name, length, low, high, *_ in mesh_fields.node(width):
        if name not in queued:
            bits = (high - low).bit_length()
            total += max(1, length) * next(size for size in (1, 2, 4) if bits <= 8 * size)
    return total


def bars(results: Results, quick: bool) -> list[Bar]:
    """All of them, in the order they were asked for."""
    first = results[ROUND.key_of("round", rounds(quick))]
    size = wire_bytes(STATE_NODES)
    return [
        *_rounds(first),
        _first(results, quick, sending.SEARCH, 0.01),
        _first(results, quick, sending.GRAPH, 0.0),
        *_alarms(results, quick),
        *(_taken(results, quick, setting) for setting in _TAKEN),
        _twice(results, quick),
        Bar(f"state of a node at N = {STATE_NODES}", f"<= {STATE_MAX} B", f"{size} B",
            size / STATE_MAX, "class of 64, whole bytes"),
    ]  # fmt: skip


def _rounds(runs: list[dict[str, Any]]) -> list[Bar]:
    recalls = [run["recall"] for run in runs]
    without = sum(run["with_tables"] < ROUND.nodes for run in runs)
    times = [np.inf if run["tables_s"] is None else run["tables_s"] for run in runs]
    recall = float(np.mean(recalls))
    return [
        Bar("discovery recall after one round", ">= 0.98", f"{recall:.4f}", (1 - recall) / 0.02,
            f"mean of {len(runs)} networks; least {min(recalls):.3f}"),
        Bar("every node with tables after one round", "all", f"{without} without",
            _none(without), f"{len(runs)} networks"),
        Bar("tables complete", "<= 5 s", f"{max(times):.2f} s", max(times) / 5,
            f"most of {len(runs)}; median {np.median(times):.2f} s"),
    ]  # fmt: skip


def _none(count: int) -> float:
    """Where nothing is allowed: 0, or too much."""
    return 2.0 if count else 0.0


def _first(results: Results, quick: bool, rule: sending.Rule, most: float) -> Bar:
    runs = sending.told(results, sending.make_testbed(rule), DEAD, sent(quick))
    came, of = sending.share(runs, "first")
    lost = (of - came) / of
    words = f"first packets with {DEAD} unknown dead, {rule.name}"
    used = lost / most if most else _none(of - came)
    return Bar(words, f">= {1 - most:g}", f"{came / of:.4f}", used, f"{came} of {of} came")


def _alarms(results: Results, quick: bool) -> list[Bar]:
    runs = crossing.told(results, crossing.BOTH, DEAD, crossings(quick))
    came = sum(run["came"] for run in runs)
    ms = float(np.percentile([run["ms"] for run in runs if run["came"]], 99))
    over = float(np.percentile([run["overrun_m"] for run in runs], 99))
    return [
        Bar(f"alarms with {DEAD} dead: delivered", "all", f"{came / len(runs):.4f}",
            _none(len(runs) - came), f"{came} of {len(runs)} crossings"),
        Bar("... latency, 99 %", "<= 70 ms", f"{ms:.1f} ms", ms / 70, f"{came} crossings"),
        Bar("... overrun at 1 m/s, 99 %", "<= 0.15 m", f"{over:.3f} m", over / 0.15,
            f"{len(runs)} crossings"),
    ]  # fmt: skip


def _taken(results: Results, quick: bool, setting: gateway.Setting) -> Bar:
    times = gateway.takeovers(gateway.told(results, setting, seeds_of(quick)))
    sends = f"messages every {setting.every_s} s" if setting.every_s else "no messages"
    median, most = (
        f"{s:.1f} s" if np.isfinite(s) else "never" for s in (np.median(times), times[-1])
    )
    return Bar(f"standby's tables, {sends}", f"<= {gateway.SOONEST:g} s", most,
               times[-1] / gateway.SOONEST, f"most of {len(times)}; median {median}")  # fmt: skip


def _twice(results: Results, quick: bool) -> Bar:
    runs: list[dict[str, Any]] = []
    for rule in _RULES:
        runs += sending.told(results, sending.make_testbed(rule), DEAD, sent(quick))
    runs += results[crossing.key(crossing.BOTH, DEAD, crossings(quick))]
    for setting in _TAKEN:
        runs += gateway.told(results, setting, seeds_of(quick))
    twice = sum(run["duplicates"] for run in runs)
    return Bar("delivered twice", "never", f"{twice} messages", _none(twice), f"{len(runs)} runs")


def draw(results: Results, quick: bool) -> Figure:
    """How much of what is allowed was used."""
    found = bars(results, quick)
    figure, (ax,) = style.panels(style.WIDE_IN, 0.5 + 0.24 * len(found))
    rows = range(len(found))
    colours = [style.BLUE if bar.used <= 1 else style.VERMILION for bar in found]
    ax.barh(rows, [min(bar.used, 1.25) for bar in found], color=colours, height=0.55)
    ax.axvline(1, color=style.INK, lw=0.8)
    for row, bar in zip(rows, found, strict=True):
        ax.text(1.35, row, bar.asked, va="center")
        ax.text(2.2, row, bar.got, va="center", weight="bold")
        ax.text(3.1, row, bar.of, va="center", color=style.SOFT)
    ax.set_yticks(rows, [bar.words for bar in found])
    ax.invert_yaxis()
    ax.set_xlim(0, 5.5)
    ax.set_xticks((0, 0.5, 1))
    ax.grid(visible=False, axis="y")
    ax.set_xlabel("share used of what is allowed", loc="left")
    return figure


def judge(results: Results, quick: bool) -> list[Claim]:
    """One row each; and how the document's rule does."""
    rows = [
        Claim("asked", f"{bar.words} {bar.asked}", f"{bar.got} ({bar.of})", verdict(bar.used <= 1),
              "" if bar.used <= 1 else _off(bar))
        for bar in bars(results, quick)
    ]  # fmt: skip
    runs = sending.told(results, sending.make_testbed(sending.DOCUMENT), DEAD, sent(quick))
    came, of = sending.share(runs, "first")
    reason = "one transmission a hop, the packet is not sent again, a random neighbour comes next"
    return [
        *rows,
        Claim("2.2", f"the document's own rule loses one in five of the first packets with {DEAD} "
              "unknown dead", f"{of - came} of {of} lost ({1 - came / of:.3f})",
              verdict((of - came) / of >= 0.15), reason),
    ]  # fmt: skip


def _off(bar: Bar) -> str:
    """Why a bar is missed; only how far is known here."""
    known = f"{bar.used:.2f} times what is allowed"
    return known if np.isfinite(bar.used) else "not all of them got there; see the other figures"


EXPERIMENT = Experiment(
    "bars",
    "What was asked for",
    "30 nodes, mean degree 8, 250 kbit/s. Bars: how much of what is allowed was used, up to the "
    "line; then what was asked for, what was measured, of how many.",
    points,
    draw,
    judge,
)
