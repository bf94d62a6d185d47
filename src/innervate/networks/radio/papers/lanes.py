"""Stretches of event-level runs as plain numbers, and their drawing: a lane a station."""

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.patches import Patch

from innervate.networks.radio.analysis.air import air, groups, signals
from innervate.networks.radio.papers.medium import START_US, said
from innervate.networks.radio.protocol.constants import CRR, DATA, REPORT_TURN
from innervate.plot import style

FILLS = {DATA: ("#7db7e0", "", 0.62), CRR: ("#f0b545", "////", 0.36)}
COLLIDED = "xxx"


def record(result: Any, until_us: int) -> dict[str, Any]:
    """Frames, turns and what each station heard; us from the first start."""
    on_air = air(result)
    found = groups(result, on_air)
    heard = signals(result, START_US - 1, START_US + until_us, on_air)
    frames = [
        {
            "station": int(on_air.node[i]),
            "kind": int(on_air.kind[i]),
            "start": int(on_air.start[i]) - START_US,
            "end": int(on_air.end[i]) - START_US,
            "collided": bool(found.collision[found.of[i]]),
        }
        for i in range(len(on_air.start))
    ]
    spans = {
        name: [(getattr(one, name) - START_US).tolist() for one in heard]
        for name in ("cd", "voc", "deaf")
    }
    turns = {str(node): told[0][0] for node, told in said(result, REPORT_TURN).items()}
    return {"frames": frames, "turns": turns, **spans}


def draw(ax: Axes, run: Any, names: Sequence[str], order: Sequence[int], waves: bool) -> None:
    """Frames over CD and VOC of each station; `order`: stations from above."""
    places = {station: place for place, station in enumerate(order)}
    for station, place in places.items():
        floor = place + 0.28
        for low, high in run["deaf"][station]:
            part = (low / 1e3, (high - low) / 1e3)
            ax.broken_barh([part], (place - 0.36, 0.64), color=style.PALE, lw=0)
        if waves:
            for row, (name, colour) in enumerate((("cd", style.INK), ("voc", style.GREEN))):
                _wave(ax, run[name][station], floor + 0.14 + 0.19 * row, colour)
    for frame in run["frames"]:
        if frame["station"] in places:
            _frame(ax, run, frame, places[frame["station"]] + 0.28)
    ax.set_yticks(range(len(order)), [names[station] for station in order])
    ax.set(ylim=(len(order) - (0.2 if waves else 0.55), -0.6), xlabel="ms from the first start")
    ax.grid(axis="y", visible=False)


def _wave(ax: Axes, spans: Any, y: float, colour: str) -> None:
    ax.axhline(y, color=colour, lw=0.3)
    parts = [(low / 1e3, (high - low) / 1e3) for low, high in spans]
    ax.broken_barh(parts, (y - 0.12, 0.12), facecolor=colour, lw=0)


def _frame(ax: Axes, run: Any, frame: Any, floor: float) -> None:
    colour, hatch, high = FILLS[frame["kind"]]
    start, wide = frame["start"] / 1e3, (frame["end"] - frame["start"]) / 1e3
    hit = frame["collided"] and frame["kind"] == DATA
    ax.broken_barh([(start, wide)], (floor - high, high), facecolor=colour, lw=0.5,
                   hatch=COLLIDED if hit else hatch or None,
                   edgecolor=style.VERMILION if hit else style.INK)  # fmt: skip
    if frame["kind"] == DATA and not hit:
        turn = run["turns"].get(str(frame["station"]))
        if turn is not None:
            ax.text(start + wide / 2, floor - high / 2, f"turn {turn}", ha="center", va="center",
                    fontsize=6, clip_on=True)  # fmt: skip


def keys(waves: bool) -> list[Patch]:
    """Entries of the legend; `waves`: CD and VOC lines, too."""
    made = [
        Patch(facecolor=FILLS[DATA][0], edgecolor=style.INK, lw=0.5, label="packet"),
        Patch(facecolor=FILLS[DATA][0], edgecolor=style.VERMILION, hatch=COLLIDED, lw=0.5,
              label="collided packet"),
        Patch(facecolor=FILLS[CRR][0], edgecolor=style.INK, hatch="////", lw=0.5, label="CR-R"),
    ]  # fmt: skip
    if waves:
        made.append(Patch(facecolor=style.INK, label="CD = 1 (upper line)"))
        made.append(Patch(facecolor=style.GREEN, label="VOC = 1 (lower line)"))
    return [*made, Patch(facecolor=style.PALE, edgecolor=style.FAINT, label="cannot listen")]
