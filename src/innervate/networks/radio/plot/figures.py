"""Figures of a radio run, for `Run.plot`: timeline, delay, fairness, throughput."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from innervate.networks.radio.analysis import summary as radio
from innervate.networks.radio.plot.scene import DONE, NOTICED, Scene, scene
from innervate.networks.radio.plot.words import FrameWords
from innervate.plot import style

BINS = 60
NAMED_MAX = 40  # stations that each have a name on the axis
MARKED_MAX = 20  # stations whose reports are marked
FAULTS_MAX = 8
# Class of a frame's fill to colour and hatch.
_FILLS = {
    "p0": ("#7db7e0", ""),
    "p1": ("#f0b545", "////"),
    "p2": ("#6cc5a6", "...."),
    "p3": ("#df9fc4", "xxxx"),
}
_OTHER = ("#bdbdbd", "")


def draw(run: Any, figure: str = "timeline", **options: Any) -> Figure:
    """One of FIGURES of a run (anything with a `result`); save it with `.savefig`.

    Raises:
        ValueError: no figure of that name.
    """
    if figure not in FIGURES:
        raise ValueError(f'no figure "{figure}"; there are {", ".join(FIGURES)}')
    with style.house():
        return FIGURES[figure](run.result, **options)


def timeline(result: Any, from_us: int | None = None, to_us: int | None = None) -> Figure:
    """Who sends when; by default the first collision and its resolution."""
    shown = scene(result, from_us, to_us)
    count = len(shown.stations)
    made, (ax,) = style.panels(style.WIDE_IN, 0.9 + min(6.5, max(1.0, 0.24 * count)))
    lanes = {station: i for i, station in enumerate(shown.stations)}
    for station, heard in shown.heard.items():
        for spans, fill in ((heard.deaf, style.PALE), (heard.off, style.FAINT)):
            low, high = spans[:, 0] / 1e3, spans[:, 1] / 1e3
            parts = list(zip(low, high - low, strict=True))
            ax.broken_barh(parts, (lanes[station] - 0.42, 0.84), color=fill, lw=0)
    _boxes(ax, shown, lanes)
    if count <= MARKED_MAX:
        _notes(ax, shown, lanes)
    ax.set_xlim(shown.window.from_us / 1e3, shown.window.to_us / 1e3)
    ax.set_ylim(count - 0.4, -0.6)
    if count <= NAMED_MAX:
        ax.set_yticks(range(count), [str(station) for station in shown.stations])
    ax.grid(axis="y", visible=False)
    ax.set_xlabel("time (ms)")
    ax.set_ylabel("station")
    handles = [_key(words) for words in shown.frames]
    handles.append(Patch(facecolor=style.PALE, edgecolor=style.FAINT, label="cannot listen"))
    if any(box.collided for box in shown.boxes):
        handles.append(Patch(facecolor="none", edgecolor=style.VERMILION, label="collided"))
    ax.legend(handles=handles, loc="lower left", bbox_to_anchor=(0, 1), ncols=len(handles))
    return made


def _boxes(ax: Axes, shown: Scene, lanes: dict[int, int]) -> None:
    groups: dict[tuple[int, int, bool], list[Any]] = {}
    for box in shown.boxes:
        groups.setdefault((box.station, box.kind, box.collided), []).append(box)
    least = 0.008 * (shown.window.to_us - shown.window.from_us) / 1e3
    for (station, _, collided), boxes in groups.items():
        words = boxes[0].words
        colour, hatch = _FILLS.get(words.kind.split()[0], _OTHER)
        parts = [(box.start_us / 1e3, (box.end_us - box.start_us) / 1e3) for box in boxes]
        edge = style.VERMILION if collided else style.INK
        high = 0.8 * words.height
        # On thin boxes an edge or a hatch would leave nothing of the fill.
        fine = max(wide for _, wide in parts) < least or len(lanes) > NAMED_MAX
        hatch, width = ("", 0.0) if fine else (hatch, 0.9 if collided else 0.3)
        ax.broken_barh(parts, (lanes[station] + 0.4 - high, high), facecolor=colour,
                       edgecolor=edge, hatch=hatch or None,
                       lw=0.6 if collided else width)  # fmt: skip


def _notes(ax: Axes, shown: Scene, lanes: dict[int, int]) -> None:
    for kind, marker, colour in ((NOTICED, "x", style.VERMILION), (DONE, "$✓$", style.GREEN)):
        notes = [note for note in shown.notes if note.kind == kind]
        if notes:
            ax.plot(
                [note.at_us / 1e3 for note in notes],
                [lanes[note.station] - 0.2 for note in notes],
                ls="none", marker=marker, color=colour, ms=3.5,
            )  # fmt: skip


def _key(words: FrameWords) -> Patch:
    colour, hatch = _FILLS.get(words.kind.split()[0], _OTHER)
    return Patch(facecolor=colour, edgecolor=style.INK, hatch=hatch, lw=0.3, label=words.name)


def delay(result: Any) -> Figure:
    """Share of the packets delivered within a delay."""
    found = np.sort(radio.delays(result))
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    if len(found):
        shares = 100.0 * np.arange(len(found) + 1) / len(found)
        ax.step(np.append(0.0, found), shares, where="post", color=style.BLUE)
        for share, dash in ((50, "-"), (95, "--"), (99, ":")):
            at = float(np.percentile(found, share))
            label = f"{share} %: {at:,.4g} slots"
            ax.axvline(at, color=style.INK, lw=0.8, ls=dash, label=label)
        ax.set_xlim(0, 1.04 * max(float(found[-1]), 1.0))
        ax.legend(loc="best")
    ax.set_ylim(0, 104)
    ax.set_xlabel("delay (slots)")
    ax.set_ylabel("packets delivered (%)")
    return made


def fairness(result: Any) -> Figure:
    """Packets that each station got through, against the even share."""
    n = result.plan.stations
    counts = np.bincount(radio.settled(result)["node"], minlength=n)
    index = radio.jain(counts)
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    ax.bar(range(n), counts, 0.7, color=style.BLUE, alpha=0.5)
    ax.axhline(float(counts.mean()), color=style.INK, lw=0.9, ls="--")
    words = "nothing delivered" if index is None else f"Jain's index {index:.4f}"
    ax.set_title(f"{words}; dashed: even share")
    if n <= 12:
        ax.set_xticks(range(n))
    ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    ax.grid(axis="x", visible=False)
    ax.set_xlabel("station")
    ax.set_ylabel("packets delivered")
    return made


def throughput(result: Any, bins: int = BINS) -> Figure:
    """Share of the time that delivered packets fill, over the run, and the scenario's events."""
    steps = radio.airtime_steps(result, bins)
    width = float(steps.time_us[1] - steps.time_us[0]) if bins > 1 else 1.0
    at = np.append(steps.time_us, steps.time_us[-1] + width) / 1e6
    values = np.append(steps.values, steps.values[-1])
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    ax.step(at, values, where="post", color=style.BLUE)
    mean = radio.throughput(result)
    if mean is not None:
        ax.axhline(mean, color=style.INK, lw=0.9, ls="--")
        ax.set_title(f"dashed: throughput {mean:.3f}")
    inside = [fault for fault in result.plan.faults if at[0] <= fault.at_us / 1e6 <= at[-1]]
    for fault in inside[:FAULTS_MAX]:
        ax.axvline(fault.at_us / 1e6, color=style.VERMILION, lw=0.8, ls=":")
    ax.set_xlim(at[0], at[-1])
    ax.set_ylim(0, max(1.04, 1.04 * float(values.max())))
    ax.set_xlabel("time (s)")
    ax.set_ylabel("share of the time")
    return made


FIGURES: dict[str, Callable[..., Figure]] = {
    "timeline": timeline,
    "delay": delay,
    "fairness": fairness,
    "throughput": throughput,
}
