"""Fig. 5: the worst case of a single broken connection converges after exactly (k+3) periods.

The paper's picture is not available. Its caption tells the order of events; the smallest graph
that shows them is this: n1 carries an interface; n2 and n3 hang on n1, n4 on n3; n2 and n4 know
longer ways to the second interface.
"""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.skin.analysis.recovery import recoveries
from innervate.networks.skin.analysis.rows import parent_changes
from innervate.networks.skin.papers.common import simulated
from innervate.papers.experiment import Claim, Claims, Measured, Point, Span, sized, verdict
from innervate.papers.words import joined
from innervate.plot import style

TITLE = "Fig. 5: worst case of a single broken connection"
CAPTION = (
    "A graph that meets the caption of the paper's figure, cells in lock-step. Arrows: parents; "
    "orange: no route, the cell announces an infinite distance; k = 5."
)
LINKS = (
    ("pc.0", "n1"), ("n1", "n2"), ("n1", "n3"), ("n3", "n4"), ("pc.1", "a1"),
    ("a1", "a2"), ("a2", "n2"), ("a2", "a3"), ("a3", "n4"),
)  # fmt: skip
PLACES = {
    "PC 0": (0.0, 2.0), "n1": (0.0, 1.0), "n2": (1.0, 1.0), "n3": (0.0, 0.0), "n4": (1.0, 0.0),
    "PC 1": (2.9, 2.0), "a1": (2.9, 1.0), "a2": (2.0, 1.0), "a3": (2.0, 0.0),
}  # fmt: skip
LANES = ("n1", "n2", "n3", "n4")
SHOWN_K = 5
HZ = 250
CUT_S = 2.0  # a tick in lock-step
EXACTLY = Span(2.99, 3.01)  # periods
STEPS = ("a  t = 0", "b  t = k T", "c  t = (k+1) T", "d  t = (k+2) T", "t = (k+3) T")
LINE_CELLS = 8  # cut in the middle between two interfaces: depth 4


def tables(k: int, m: int, lock_step: bool, line: bool = False) -> dict[str, Any]:
    """The scenario: the graph above, or a line of eight cells."""
    protocol = {"updates": "periodic", "beacon_hz": HZ, "k": k, "balancing": False}
    network: dict[str, Any] = {"link": [{"a": a, "b": b} for a, b in LINKS]}
    if line:
        ends = [{"row": 0, "column": c} for c in (0, LINE_CELLS - 1)]
        network = {"patch": [{"columns": LINE_CELLS, "rows": 1}], "interface": ends}
    at_s = CUT_S if lock_step else [CUT_S, CUT_S + 5 / HZ]
    return network | {
        "kind": "skin",
        "duration_s": CUT_S + (k + 100) / HZ,
        "protocol": protocol | ({"m": m} if m else {}),
        "timing": {"lock_step": lock_step, "drift_ppm": 0, "hop_latency_us": [1, 2]},
        "event": [{"action": "cut", "interface": 0, "at_s": at_s}],
    }


# Name, arguments of tables() after k.
CASES: dict[str, tuple[int, bool, bool]] = {
    "lock-step, M = 1": (1, True, False),
    "lock-step, M = min(k, 5)": (0, True, False),
    "free running, M = 1": (1, False, False),
    "line of depth 4, free running": (1, False, True),
}
ks = sized((2, 5, 8), tuple(range(2, 9)))  # the k of the sweep


def runs(name: str, k: int, quick: bool) -> Point:
    """A way of reading the figure."""
    seeds = 4 if quick else 24
    return Point.each(f"fig5 {name} k={k}", 0.03, seeds, measure, k, CASES[name])


def points(quick: bool) -> list[Point]:
    """Each way of reading the figure, and one run in detail."""
    made = [runs(name, k, quick) for name in CASES for k in ks(quick)]
    return [*made, Point.of(f"fig5 story k={SHOWN_K}", 0.1, parents_after_cut)]


def measure(k: int, case: tuple[int, bool, bool], seed: int) -> list[float]:
    """[detected, converged], in periods of beacons."""
    one = recoveries(simulated(tables(k, *case), seed))[0]
    detected_ms, converged_ms = one["detected_ms"], one["converged_ms"]
    assert detected_ms is not None
    assert converged_ms is not None
    return [detected_ms * HZ / 1e3, converged_ms * HZ / 1e3]


def parents_after_cut() -> dict[str, Any]:
    """Who takes whom as parent, when, in periods since the cut (0 = before it)."""
    result = simulated(tables(SHOWN_K, 1, True), 1)
    graph = result.plan.graph
    changes = parent_changes(result)
    columns = (changes.time_us, changes.cell, changes.old, changes.new)
    events = []
    for time, cell, *ports in zip(*columns, strict=True):
        at = max(0.0, (float(time) / 1e6 - CUT_S) * HZ)
        ends = [graph.peer[4 * int(cell) + int(port)] if port >= 0 else None for port in ports]
        hops = ["" if end is None else _name(graph, int(end)) for end in ends]
        events.append([round(at, 3), graph.label(int(cell)), *hops])
    return {"events": events}


def _name(graph: Any, end: int) -> str:
    node = graph.node_of(end)
    return f"PC {graph.port_of(end)}" if node == graph.sink else str(graph.label(node))


def draw(got: Measured) -> Figure:
    """The network at five moments, and the timeline below."""
    events = got.values[f"fig5 story k={SHOWN_K}"]["events"]
    figure = style.figure(style.WIDE_IN, 5.0)
    top, bottom = figure.subfigures(2, 1, height_ratios=(1.7, 1), squeeze=False).flat
    places = top.subplots(2, 3).flat
    for i, (ax, title) in enumerate(zip(places, STEPS, strict=False)):
        _network(ax, events, 0.0 if i == 0 else SHOWN_K + i - 1.0)
        ax.set_title(title)
    _key_of(places[len(STEPS)])
    _timeline(bottom.subplots(), events)
    return figure


def _network(ax: Axes, events: list[Any], until: float) -> None:
    parent = {cell: new for at, cell, _, new in events if at <= until + 0.01}
    for a, b in LINKS:
        here, there = (PLACES[name.replace("pc.", "PC ")] for name in (a, b))
        how = (style.VERMILION, ":") if a == "pc.0" else (style.FAINT, "-")
        ax.plot(*zip(here, there, strict=True), color=how[0], ls=how[1], lw=1.2, zorder=1)
    ax.plot(0, 1.5, "x", color=style.VERMILION, ms=6, mew=1.6, zorder=5)
    for name, (x, y) in PLACES.items():
        is_pc = name.startswith("PC")
        lost = not is_pc and not parent.get(name)
        face = style.INK if is_pc else (style.ORANGE if lost else style.PALE)
        ax.plot(x, y, "s" if is_pc else "o", ms=17, mfc=face, mec=style.INK, mew=0.7, zorder=3)
        ax.text(x, y, name.replace("PC ", "PC"), ha="center", va="center", fontsize=7, zorder=4,
                color="white" if is_pc else style.INK)  # fmt: skip
        if lost:
            ax.text(x - 0.27, y + 0.27, "∞", fontsize=9, ha="right", va="center")
        elif not is_pc:
            colour = style.BLUE if name in LANES else style.SOFT
            arrow = {"arrowstyle": "-|>", "color": colour, "lw": 1.3, "shrinkA": 9.5,
                     "shrinkB": 9.5, "mutation_scale": 9}  # fmt: skip
            ax.annotate("", PLACES[parent[name]], (x, y), arrowprops=arrow, zorder=2)
    ax.set(xlim=(-0.65, 3.35), ylim=(-0.5, 2.5), aspect="equal")
    ax.axis("off")


def _key_of(ax: Axes) -> None:
    """What the shapes mean, in the place of a sixth network."""
    ax.axis("off")
    shape: Any = {"mec": style.INK, "mew": 0.7, "ms": 9}
    ax.plot([], [], "s", mfc=style.INK, label="interface port of the PC", **shape)
    ax.plot([], [], "o", mfc=style.PALE, label="cell with a route", **shape)
    ax.plot([], [], "o", mfc=style.ORANGE, label="cell without: says ∞", **shape)
    ax.plot([], [], color=style.BLUE, lw=1.3, label="parent of n1 to n4")
    ax.plot([], [], color=style.SOFT, lw=1.3, label="parent of the others")
    ax.plot([], [], "x", color=style.VERMILION, ms=6, mew=1.6, label="cable that fails")
    ax.legend(loc="center left", labelspacing=0.7)


def _timeline(ax: Axes, events: list[Any]) -> None:
    k = SHOWN_K
    for y, name in enumerate(reversed(LANES)):
        ax.axhline(y, color=style.FAINT, lw=0.6, zorder=0)
        lost_at: float | None = None
        for at, cell, old, new in events:
            if cell != name or at <= 0:
                continue
            if new and lost_at is not None:
                ax.plot([lost_at, at], [y, y], color=style.ORANGE, lw=5, alpha=0.5)
            lost_at = lost_at if new else at
            marker, colour = ("o", style.BLUE) if new else ("s", style.ORANGE)
            ax.plot(at, y, marker, color=colour, ms=5)
            says = "finds the cable broken, says ∞" if old == "PC 0" else "says ∞"
            words = f"takes {new}" if new else says
            ax.text(at + 0.09, y + 0.2, words, fontsize=6.5, va="bottom")
    ax.axvline(0, color=style.VERMILION, lw=1)
    ax.text(0.08, 3.45, "cable n1 - PC0 fails", fontsize=6.5, color=style.VERMILION)
    arrow = {"arrowstyle": "<->", "color": style.SOFT, "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (k, -0.55), (0, -0.55), arrowprops=arrow)
    ax.text(k / 2, -0.47, f"k = {k} beacons missed", fontsize=6.5, ha="center", va="bottom")
    ax.set_yticks(range(len(LANES)), LANES[::-1])
    ax.set_xticks(range(k + 4), [str(i) for i in range(k)] + ["k", "k+1", "k+2", "k+3"])
    ax.set(xlim=(-0.15, k + 4.1), ylim=(-0.75, 3.8))
    ax.grid(axis="y", visible=False)
    ax.set_xlabel("beacon periods $T_b$ since the failure")


def beyond(got: Measured, name: str, some: tuple[int, ...]) -> list[list[float]]:
    """[converged - detected, converged - k] in periods, of all runs of a case with these k."""
    return [[c - d, c - k] for k in some for d, c in got[runs(name, k, got.quick)]]


def judge(got: Measured) -> Claims:
    """Exactly k+3 in lock-step; what free-running cells do."""
    all_k = ks(got.quick)
    lock, late, free = ([over for _, over in beyond(got, name, all_k)] for name in list(CASES)[:3])
    lock, late = ([round(over, 2) for over in found] for found in (lock, late))
    line, two = (
        [after for after, _ in beyond(got, "line of depth 4, free running", some)]
        for some in (all_k[1:], all_k[:1])
    )
    for found, readings, way, took, why in (
        (lock, ["E20"], "converges after exactly (k+3) T",
         f"k+{min(lock):.2f} to k+{max(lock):.2f} T in {len(lock)} runs, k {joined(all_k)}",
         "cells in lock-step, beacons not delayed, M = 1 as printed, the failure at a tick"),
        (late, ["E20"], "takes (k+3) T exactly with M = min(k, 5), too",
         f"k+{min(late):.0f} to k+{max(late):.0f} T in {len(late)} runs",
         "F3: while k = M the number that lets n2 switch may come one period later"),
        (free, [], "takes (k+3) T exactly with free-running cells, too",
         f"k{min(free):+.2f} to k{max(free):+.2f} T, mean k{sum(free) / len(free):+.2f} T",
         "E21: the wait on the way out and the wait back over a link are one period together"),
    ):  # fmt: skip
        claim = f"a single broken connection {way}"
        yield Claim("5", claim, took, verdict(EXACTLY.has(*found), *readings), why)
    yield Claim(
        "5",
        "free running on a line of depth 4, k >= 3: detection and exactly 3 T",
        f"detection + {min(line):.3f} to {max(line):.3f} T in {len(line)} runs; k = 2: up to "
        f"{max(two):.3f} T",
        verdict(EXACTLY.has(*line), "E21"),
        "drift and latency next to none; with k = 2 the newer number from the other interface "
        "may not have come as far as the border yet",
    )
