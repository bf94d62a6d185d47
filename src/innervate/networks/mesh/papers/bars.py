"""What was asked for, in one table: thirty nodes, eight neighbours in the mean, 250 kbit/s."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.papers import alarms, failures, gateway, losses
from innervate.networks.mesh.papers.document import ours
from innervate.networks.mesh.papers.testbed import MeshTestbed
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.scenario.plan import CLASSES
from innervate.papers.experiment import Claims, Measured, Point, sized, verdict
from innervate.plot import style

TITLE = "What was asked for"
CAPTION = (
    "30 nodes, mean degree 8, 250 kbit/s. Bars: how much of what is allowed was used, up to the "
    "line (nothing amiss: none of it); then what was asked for, what was measured, of how many. "
    "None of it is the document's. Standbys wait for requests (guard_s = 0); if nothing is said "
    "they ask, and take a second."
)
DEAD = 8
STATE_NODES = 50
STATE_MAX = 4096
RULES = (failures.SEARCH, failures.GRAPH, failures.DOCUMENT)
TAKEN = (gateway.SILENT, gateway.ONE)


class Bar(NamedTuple):
    """Something that was asked for."""

    words: str
    # asked, got: the bar and what was measured, in words
    asked: str
    got: str
    used: float  # how much of what is allowed was used; 1 = just reached
    of: str  # runs, crossings, messages


def measure_round(testbed: MeshTestbed, seed: int) -> dict[str, Any]:
    """One discovery round and its tables."""
    summary = summarize(testbed.run(seed))
    return {name: summary["discovery"][name] for name in ("recall", "tables_s", "with_tables")}


def rounds(quick: bool) -> Point:
    """Networks in which one round is looked at, which end before the second one.

    A mean of a few says nothing of two percent.
    """
    return MeshTestbed().point("round", 30 if quick else 100, measure_round)


def sent(rule: failures.Rule, quick: bool) -> Point:
    """Networks in which messages are sent."""
    return failures.point(rule, DEAD, quick, end=True, seeds=sized(4, 100))


def points(quick: bool) -> list[Point]:
    """A round; messages and crossings with 8 dead; the gateway's death."""
    return [
        rounds(quick),
        *(sent(rule, quick) for rule in RULES),
        alarms.point(alarms.BOTH, DEAD, quick),
        *(gateway.point(setting, quick) for setting in TAKEN),
    ]


def wire_bytes(nodes: int) -> int:
    """Bytes of a node's state in whole bytes a value, by the declared ranges.

    Without what only gateways have, without queued frames, and without what is kept of links whose
    acks' times are learned, which is an option for links that are much slower or much faster.
    """
    width = next(size for size in CLASSES if nodes <= size)
    optional = mesh_fields.links(mesh_fields.places(width))
    left_out = {name for name, *_ in mesh_fields.queued(mesh_fields.QUEUE) + optional}
    return sum(_bytes(*one[1:4]) for one in mesh_fields.node(width) if one[0] not in left_out)


def _bytes(length: int, low: int, high: int) -> int:
    """Of a field, in whole bytes a value."""
    bits = (high - low).bit_length()
    return max(1, length) * next(size for size in (1, 2, 4) if bits <= 8 * size)


def bars(got: Measured) -> list[Bar]:
    """All of them, in the order they were asked for."""
    size = wire_bytes(STATE_NODES)
    return [
        *_rounds(got[rounds(got.quick)]),
        _first(got, failures.SEARCH, 0.01),
        _first(got, failures.GRAPH, 0.0),
        *_alarms(got),
        *(_taken(got, setting) for setting in TAKEN),
        _twice(got),
        Bar(f"state of a node at N = {STATE_NODES}", f"<= {STATE_MAX} B", f"{size} B",
            size / STATE_MAX, "class of 64, fixed waits"),
    ]  # fmt: skip


def _rounds(runs: dict[str, Any]) -> list[Bar]:
    recalls, count = runs["recall"], len(runs["recall"])
    without = sum(some < MeshTestbed().nodes for some in runs["with_tables"])
    times = [np.inf if time is None else time for time in runs["tables_s"]]
    recall = float(np.mean(recalls))
    return [
        Bar("discovery recall after one round", ">= 0.98", f"{recall:.4f}", (1 - recall) / 0.02,
            f"mean of {count} networks; least {min(recalls):.3f}"),
        Bar("every node with tables after one round", "all", f"{without} without",
            _none(without), f"{count} networks"),
        Bar("tables complete", "<= 5 s", f"{max(times):.2f} s", max(times) / 5,
            f"most of {count}; median {np.median(times):.2f} s"),
    ]  # fmt: skip


def _none(count: int) -> float:
    """Where nothing is allowed: 0, or too much."""
    return 2.0 if count else 0.0


def _first(got: Measured, rule: failures.Rule, most: float) -> Bar:
    came, of = failures.share(got[sent(rule, got.quick)], "first")
    lost = (of - came) / of
    words = f"first packets with {DEAD} unknown dead, {rule.name}"
    used = lost / most if most else _none(of - came)
    return Bar(words, f">= {1 - most:g}", f"{came / of:.4f}", used, f"{came} of {of} came")


def _alarms(got: Measured) -> list[Bar]:
    runs = alarms.told(got, alarms.BOTH, DEAD)
    came, count = int(runs["came"].sum()), len(runs["came"])
    ms = float(np.percentile(runs["ms"][np.isfinite(runs["ms"])], 99))
    over = float(np.percentile(runs["overrun_m"], 99))
    which = f"alarms with {DEAD} dead:"
    return [
        Bar(f"{which} delivered", "all", f"{came / count:.4f}",
            _none(count - came), f"{came} of {count} crossings"),
        Bar(f"{which} latency, 99 %", "<= 70 ms", f"{ms:.1f} ms", ms / 70, f"{came} crossings"),
        Bar(f"{which} overrun at 1 m/s, 99 %", "<= 0.15 m", f"{over:.3f} m", over / 0.15,
            f"{count} crossings"),
    ]  # fmt: skip


def _taken(got: Measured, setting: gateway.Setting) -> Bar:
    times = gateway.takeovers(got, setting)
    sends = f"messages every {setting.every_s} s" if setting.every_s else "no messages"
    median, most = (
        f"{s:.1f} s" if np.isfinite(s) else "never" for s in (np.median(times), times[-1])
    )
    return Bar(f"standby's tables, {sends}", f"<= {gateway.SOONEST:g} s", most,
               times[-1] / gateway.SOONEST, f"most of {len(times)}; median {median}")  # fmt: skip


def _twice(got: Measured) -> Bar:
    found = [got[point]["duplicates"] for point in points(got.quick)[1:]]
    twice, runs = sum(map(sum, found)), sum(map(len, found))
    return Bar("delivered twice", "never", f"{twice} messages", _none(twice), f"{runs} runs")


def draw(got: Measured) -> Figure:
    """How much of what is allowed was used."""
    found = bars(got)
    figure, (ax,) = style.panels(style.WIDE_IN, 0.5 + 0.24 * len(found))
    rows = range(len(found))
    colours = [style.BLUE if bar.used <= 1 else style.VERMILION for bar in found]
    ax.barh(rows, [min(bar.used, 1.25) for bar in found], color=colours, height=0.55)
    ax.axvline(1, color=style.INK, lw=0.8)
    for row, bar in zip(rows, found, strict=True):
        if not bar.used:
            ax.text(0.03, row, "nothing amiss", va="center", color=style.BLUE)
        ax.text(1.35, row, bar.asked, va="center")
        ax.text(2.2, row, bar.got, va="center", weight="bold")
        ax.text(3.1, row, bar.of, va="center", color=style.SOFT)
    ax.set_yticks(rows, [bar.words for bar in found])
    ax.invert_yaxis()
    ax.set(xlim=(0, 5.5), xticks=(0, 0.5, 1))
    ax.grid(visible=False, axis="y")
    ax.set_xlabel("share used of what is allowed", loc="left")
    return figure


def judge(got: Measured) -> Claims:
    """One row each; and how the document's rule does."""
    for bar in bars(got):
        off = f"{bar.used:.2f} times what is allowed"
        if not np.isfinite(bar.used):
            off = "not all of them got there; see the other figures"
        passed = bar.used <= 1
        measured = f"{bar.got} ({bar.of})"
        yield ours(
            "asked", f"{bar.words} {bar.asked}", measured, verdict(passed), "" if passed else off
        )
    runs = got[sent(failures.DOCUMENT, got.quick)]
    came, of = failures.share(runs, "first")
    yield ours(
        "2.2",
        f"the document's own rule loses 0.15 or more of the first packets with {DEAD} unknown dead",
        f"{of - came} of {of} lost ({1 - came / of:.3f})",
        verdict((of - came) / of >= 0.15),
        losses.words(runs["first_lost"]),
    )
