"""Fig. 6: the failure penalty p_f of a loose connection, for two settings of r_f and r_r.

Beyond the figure: from which loss on a connection counts as broken, and how fast one that was
plugged in again is taken back.
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.skin.analysis.rows import broken_changes
from innervate.networks.skin.papers.common import simulated, tabled
from innervate.networks.skin.papers.steps import Steps
from innervate.networks.skin.protocol.constants import ONE
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, Span, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style

HZ = 250
LOSS = 0.2  # between the limits of the two settings, 50 % and 11 %
TITLE = "Fig. 6: penalty of a loose connection"
CAPTION = (
    f"a, b: {percent(LOSS)} of the beacons are lost on n1's cable; red ticks: beacons missed; "
    "shaded: held broken (p_f >= 1). c: the same for all losses; dashed: r_r / (r_f + r_r). d: "
    "share of the cables found broken at least once; dotted: the end of a and b."
)
# Name, r_f, r_r: "similar", and "r_f increased, r_r reduced".
SETTINGS = (("a", 0.2, 0.2), ("b", 0.4, 0.05))
SHOWN_PERIODS = 120
SHOWN_SEED = 1
LINKS = (("pc.0", "n1"), ("pc.1", "n2"), ("n1", "n2"))
LOOSE_S = 0.2
SWEEP_PERIODS = 2000
REPLUG_K = (2, 3, 5, 8)
RARE = 0.05  # a loss at which misses are rare for r_f = r_r
WATCHED_S = 60.0
JUDGED_S = 8.0
NOT_DETECTED = Span(0.0, 0.05)  # share of the cables found broken in JUDGED_S
DETECTED = Span(0.95, 1.0)
AT_LIMIT = Span(-0.1, 0.1)  # loss at which a cable is held broken half of the time, off the limit

Watched = tuple[float, float, float]  # r_f, r_r and loss of cables watched until found broken
FOUND: tuple[Watched, ...] = (
    *((r_f, r_r, LOSS) for _, r_f, r_r in SETTINGS),
    (SETTINGS[0][1], SETTINGS[0][2], RARE),
)


def losses(quick: bool) -> list[float]:
    """Shares of beacons that are lost, 0 to 1."""
    return [i / 100 for i in range(0, 101, 20 if quick else 4)]


def tables(r_f: float, r_r: float, events: list[dict[str, Any]], duration_s: float) -> Any:
    """Two cells with an interface each; n1's cable is the one that something happens to."""
    return {
        "kind": "skin",
        "duration_s": duration_s,
        "link": [{"a": a, "b": b} for a, b in LINKS],
        "protocol": {"updates": "periodic", "beacon_hz": HZ, "r_f": r_f, "r_r": r_r},
        "timing": {"lock_step": True},
        "event": [{"interface": 0} | event for event in events],
    }


def loose(r_f: float, r_r: float, loss: float, duration_s: float) -> Any:
    """The same with the cable loose from LOOSE_S on."""
    return tables(r_f, r_r, [{"action": "loose", "loss": loss, "at_s": LOOSE_S}], duration_s)


def shown(r_f: float, r_r: float) -> Point:
    """A history of p_f, drawn."""
    key = f"fig6 history {r_f} {r_r} loss={LOSS} seed {SHOWN_SEED}"
    return Point.of(key, 0.5, history, r_f, r_r)


def watched(case: Watched, quick: bool) -> Point:
    """Cables that are watched until they are found broken."""
    r_f, r_r, loss = case
    what = f"fig6 found {r_f} {r_r} loss={loss} in {WATCHED_S:g} s"
    return Point.each(what, 0.04, 10 if quick else 100, found_after, r_f, r_r, loss)


def swept(r_f: float, r_r: float, quick: bool) -> Point:
    """The sweep over the loss."""
    what = f"fig6 sweep {r_f} {r_r} {len(losses(quick))} losses"
    return Point.each(what, 0.6, 2 if quick else 5, sweep, r_f, r_r, losses(quick))


def points(quick: bool) -> list[Point]:
    """The two histories, the sweep over the loss, re-plugging."""
    made = [shown(r_f, r_r) for _, r_f, r_r in SETTINGS]
    made += [swept(r_f, r_r, quick) for _, r_f, r_r in SETTINGS]
    made += [watched(case, quick) for case in FOUND]
    return [*made, Point.of(f"fig6 replug k={joined(REPLUG_K)}", 0.2, replug)]


def history(r_f: float, r_r: float) -> list[float]:
    """p_f of n1's port to the PC after each period, from the moment the cable is loose."""
    end_s = LOOSE_S + (SHOWN_PERIODS + 1) / HZ
    steps = Steps(tabled(loose(r_f, r_r, LOSS, end_s), SHOWN_SEED))
    found = []
    for i in range(1, SHOWN_PERIODS + 1):
        steps.to(LOOSE_S + (i + 0.5) / HZ)  # half-way between two ticks
        found.append(float(steps.world.cells["pf"][0, 0]) / ONE)
    return found


def found_after(r_f: float, r_r: float, loss: float, seed: int) -> float | None:
    """Periods until n1 finds the cable broken; None: not in WATCHED_S."""
    changes = broken_changes(simulated(loose(r_f, r_r, loss, LOOSE_S + WATCHED_S), seed))
    hits = changes.time_us[(changes.end == 0) & (changes.time_us > 1e6 * LOOSE_S)]
    return (float(hits[0]) / 1e6 - LOOSE_S) * HZ if len(hits) else None


def sweep(r_f: float, r_r: float, some: list[float], seed: int) -> list[float]:
    """Share of the time that n1 holds its cable broken, for each loss."""
    start, end = LOOSE_S + 0.5, LOOSE_S + SWEEP_PERIODS / HZ
    runs = (simulated(loose(r_f, r_r, loss, end), seed) for loss in some)
    return [_broken_share(result, start, end) for result in runs]


def _of_the_cable(result: Any) -> list[tuple[float, bool]]:
    """(when, s; now broken) of n1's cable."""
    found = broken_changes(result)
    rows = zip(found.time_us, found.end, found.broken, strict=True)
    return [(float(time) / 1e6, bool(broken)) for time, end, broken in rows if end == 0]


def _broken_share(result: Any, start_s: float, end_s: float) -> float:
    changes = [(max(time_s, start_s), broken) for time_s, broken in _of_the_cable(result)]
    ends = [*(time_s for time_s, _ in changes), end_s][1:]
    spans = zip(changes, ends, strict=True)
    return sum(until - since for (since, broken), until in spans if broken) / (end_s - start_s)


def replug() -> dict[str, list[float]]:
    """[periods until a cable that was out for long works again, after it is back], by k."""
    found = {}
    for k in REPLUG_K:
        back = LOOSE_S + (3 * k + 20) / HZ
        events = [{"action": "cut", "at_s": LOOSE_S}, {"action": "restore", "at_s": back}]
        result = simulated(tables(1 / k, 1 / k, events, back + 40 / HZ), 1)
        changes = _of_the_cable(result)
        found[str(k)] = [(at - back) * HZ for at, broken in changes if not broken and at > back]
    return found


def share_found(got: Measured, case: Watched, within_s: float) -> float:
    """Share of the watched cables that were found broken within a time."""
    found = got[watched(case, got.quick)]
    return float(sum(n is not None and n <= within_s * HZ for n in found) / len(found))


def broken(got: Measured, r_f: float, r_r: float) -> Any:
    """Share of the time that the cable is held broken, for each loss."""
    some = got[swept(r_f, r_r, got.quick)]
    return sum(map(np.array, some)) / len(some)


def draw(got: Measured) -> Figure:
    """p_f over time for both settings; the share of time broken over the loss; how soon found."""
    figure = style.figure(style.WIDE_IN, 4.2)
    left, right = figure.subfigures(1, 2, width_ratios=(1.35, 1), squeeze=False).flat
    axes = left.subplots(2, 1, sharex=True)
    for ax, (letter, r_f, r_r) in zip(axes, SETTINGS, strict=True):
        _history(ax, got[shown(r_f, r_r)])
        ax.set_title(f"{letter}  $r_f$ = {r_f}, $r_r$ = {r_r}")
    axes[1].set_xlabel("beacon periods since the connection is loose")
    above, below = right.subplots(2, 1)
    _thresholds(above, got)
    _how_soon(below, got)
    return figure


def _history(ax: Axes, values: list[float]) -> None:
    pf = np.array(values)
    time = np.arange(1, len(pf) + 1)
    step = np.diff(pf, prepend=0)
    missed = (step > 0) | ((pf == 2) & (step == 0))
    ax.fill_between(
        time, 0, 2, where=pf >= 1, step="post", color=style.ORANGE, alpha=0.3, lw=0, label="broken"
    )
    ax.step(time, pf, where="post", color=style.BLUE)
    ax.axhline(1, color=style.INK, lw=0.8, ls="--")
    ax.plot(time[missed], np.full(missed.sum(), -0.16), "|", color=style.VERMILION, ms=3.5, mew=0.8)
    ax.set(ylim=(-0.35, 2.12), yticks=[0, 1, 2], xlim=(0, len(pf)), ylabel="penalty $p_f$")
    ax.grid(axis="x", visible=False)


def _thresholds(ax: Axes, got: Measured) -> None:
    x = 100 * np.array(losses(got.quick))
    for i, (letter, r_f, r_r) in enumerate(SETTINGS):
        colour = style.SERIES[i]
        shares = 100 * broken(got, r_f, r_r)
        ax.plot(x, shares, style.MARKERS[i], ls="-", color=colour, ms=2.6)
        limit = 100 * r_r / (r_f + r_r)
        ax.axvline(limit, color=colour, ls="--", lw=0.9)
        ax.text(limit + 1.5, 105, letter, color=colour, va="bottom", fontweight="bold")
    ax.set(ylim=(-3, 119), yticks=range(0, 101, 20), title="c  which losses are tolerated")
    ax.set(xlabel="lost beacons (%)", ylabel="time held broken (%)")


def _how_soon(ax: Axes, got: Measured) -> None:
    time_s = np.geomspace(2 / HZ, WATCHED_S, 120)
    names = (*(f"{name}, {percent(LOSS)} lost" for name, *_ in SETTINGS), f"a, {percent(RARE)}")
    for i, (case, name) in enumerate(zip(FOUND, names, strict=True)):
        shares = [100 * share_found(got, case, t) for t in time_s]
        ax.plot(time_s, shares, color=style.SERIES[i], ls=style.DASHES[i], label=name)
    ax.axvline(SHOWN_PERIODS / HZ, color=style.SOFT, lw=0.8, ls=":")
    drawing.logarithmic(ax, [0.01, 0.1, 1, 10, 60])
    ax.set(ylim=(-3, 134), yticks=range(0, 101, 20), ylabel="found broken (%)")
    ax.set_xlabel("time since the connection is loose (s)")
    ax.set_title("d  until it is found for the first time")
    ax.legend(loc="upper left", ncols=3, columnspacing=0.8, handlelength=1.5)


def judge(got: Measured) -> Claims:
    """Not detected in a, for how long and how rare; detected in b; the threshold; re-plugging."""
    calm, alert, rare = FOUND
    walk = "E16, E17, E18: misses are a random walk, and five more misses than hits come sooner or "
    yield _calm(got, calm, f"{walk}later; within the time of the picture few cables trip")
    yield _calm(got, rare, "")
    yield _alert(got, alert)
    yield _limit(got)
    found = got.values[f"fig6 replug k={joined(REPLUG_K)}"]
    fast = all([round(n, 2) for n in some] == [int(k) + 1] for k, some in found.items())
    yield Claim(
        "6",
        "p_f stays in [0, 2], so that a re-plugged cable is found fast: k+1 beacons",
        "periods until it works again, "
        + joined(f"k = {k}: {again[0]:.0f}" for k, again in found.items()),
        verdict(fast, "E19"),
        "r_f = r_r = 1/k; counted from the tick of the cable's return",
    )


def _times(got: Measured, case: Watched) -> str:
    times = (SHOWN_PERIODS / HZ, JUDGED_S, WATCHED_S)
    shares = (f"{percent(share_found(got, case, s))} in {s:g} s" for s in times)
    return f"{len(got[watched(case, got.quick)])} cables: found broken {joined(shares)}"


def _calm(got: Measured, case: Watched, reason: str) -> Claim:
    fine = NOT_DETECTED.has(share_found(got, case, JUDGED_S))
    return Claim(
        "6a",
        f"r_f similar to r_r ({case[0]}): a loose connection with rare misses ({percent(case[2])} "
        f"lost) is not detected (at most {percent(NOT_DETECTED.high)} of the cables in "
        f"{JUDGED_S:g} s)",
        _times(got, case),
        verdict(fine, "E16", "E17", "E18"),
        "a chance remains: five misses more than hits" if fine else reason,
    )


def _alert(got: Measured, case: Watched) -> Claim:
    found = [n for n in got[watched(case, got.quick)] if n is not None]
    half = f"; half of them within {np.median(found):.0f} periods" if found else ""
    return Claim(
        "6b",
        f"r_f increased, r_r reduced ({case[0]}, {case[1]}): the same connection "
        f"({percent(case[2])} lost) is detected (at least {percent(DETECTED.low)} in "
        f"{JUDGED_S:g} s)",
        _times(got, case) + half,
        verdict(DETECTED.has(share_found(got, case, JUDGED_S)), "E16", "E17", "E18"),
        "" if found else "no cable was found",
    )


def _limit(got: Measured) -> Claim:
    words, off = [], []
    for letter, r_f, r_r in SETTINGS:
        limit = r_r / (r_f + r_r)
        half = float(np.interp(0.5, broken(got, r_f, r_r), losses(got.quick)))
        off.append(half - limit)
        at = f"half of the time broken at {percent(half)}, limit {percent(limit)}"
        words.append(f"{letter}: {at}")
    return Claim(
        "6",
        "r_f and r_r set the allowed ratio of lost packets, r_r / (r_f + r_r) (within "
        f"{100 * AT_LIMIT.high:.0f} points)",
        joined(words),
        verdict(AT_LIMIT.has(*off)),
        "p_f drifts up where loss * r_f > (1 - loss) * r_r; chance blurs the limit",
    )
