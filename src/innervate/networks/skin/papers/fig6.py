"""Fig. 6: the failure penalty p_f of a loose connection, for two settings of r_f and r_r.

Beyond the figure: from which loss on a connection counts as broken, and how fast one that was
plugged in again is taken back.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.skin.analysis.rows import broken_changes
from innervate.networks.skin.papers.common import joined, percent, seeds_of, simulated
from innervate.networks.skin.papers.steps import Steps
from innervate.networks.skin.protocol.constants import ONE
from innervate.papers.experiment import Claim, Experiment, Point, Results, Span, verdict
from innervate.plot import style

HZ = 250
LOSS = 0.2  # between the limits of the two settings, 50 % and 11 %
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


# r_f, r_r and loss of the cables that are watched until they are found broken.
FOUND: tuple[tuple[float, float, float], ...] = (
    *((r_f, r_r, LOSS) for _, r_f, r_r in SETTINGS),
    (SETTINGS[0][1], SETTINGS[0][2], RARE),
)


def losses(quick: bool) -> list[float]:
    """Shares of beacons that are lost, 0 to 1."""
    return [i / 100 for i in range(0, 101, 20 if quick else 4)]


def seeds(quick: bool) -> range:
    """Seeds of the runs at each loss: 5, or 2 if `quick`."""
    return seeds_of(2 if quick else 5)


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


def points(quick: bool) -> list[Point]:
    """The two histories, the sweep over the loss, re-plugging."""
    made = [Point.of(_history_key(r_f, r_r), 0.5, history, r_f, r_r) for _, r_f, r_r in SETTINGS]
    made += [
        Point.of(_sweep_key(r_f, r_r, quick), 3.0, sweep, r_f, r_r, quick)
        for _, r_f, r_r in SETTINGS
    ]
    made += [Point.of(_found_key(*case, quick), 4.0, found_after, *case, quick) for case in FOUND]
    return [*made, Point.of(f"fig6 replug k={joined(REPLUG_K)}", 0.2, replug)]


def _history_key(r_f: float, r_r: float) -> str:
    return f"fig6 history {r_f} {r_r} loss={LOSS} seed {SHOWN_SEED}"


def _found_key(r_f: float, r_r: float, loss: float, quick: bool) -> str:
    return f"fig6 found {r_f} {r_r} loss={loss} in {WATCHED_S:g} s, seeds 1-{_runs(quick)[-1]}"


def _runs(quick: bool) -> range:
    return seeds_of(10 if quick else 100)


def _sweep_key(r_f: float, r_r: float, quick: bool) -> str:
    return f"fig6 sweep {r_f} {r_r} {len(losses(quick))} losses seeds 1-{len(seeds(quick))}"


def history(r_f: float, r_r: float) -> list[float]:
    """p_f of n1's port to the PC after each period, from the moment the cable is loose."""
    loose = {"action": "loose", "loss": LOSS, "at_s": LOOSE_S}
    end_s = LOOSE_S + (SHOWN_PERIODS + 1) / HZ
    steps = Steps(tables(r_f, r_r, [loose], end_s), SHOWN_SEED)
    found = []
    for i in range(1, SHOWN_PERIODS + 1):
        steps.to(LOOSE_S + (i + 0.5) / HZ)  # half-way between two ticks
        found.append(float(steps.world.cells["pf"][0, 0]) / ONE)
    return found


def found_after(r_f: float, r_r: float, loss: float, quick: bool) -> list[float | None]:
    """Periods until n1 finds the cable broken, of every seed; None: not in WATCHED_S."""
    loose = {"action": "loose", "loss": loss, "at_s": LOOSE_S}
    duration_s = LOOSE_S + WATCHED_S
    found = []
    for seed in _runs(quick):
        changes = broken_changes(simulated(tables(r_f, r_r, [loose], duration_s), seed))
        hits = changes.time_us[(changes.end == 0) & (changes.time_us > 1e6 * LOOSE_S)]
        found.append((float(hits[0]) / 1e6 - LOOSE_S) * HZ if len(hits) else None)
    return found


def sweep(r_f: float, r_r: float, quick: bool) -> list[float]:
    """Share of the time that n1 holds its cable broken, for each loss."""
    start, end = LOOSE_S + 0.5, LOOSE_S + SWEEP_PERIODS / HZ
    found = []
    for loss in losses(quick):
        loose = {"action": "loose", "loss": loss, "at_s": LOOSE_S}
        shares = [
            _broken_share(simulated(tables(r_f, r_r, [loose], end), seed), start, end)
            for seed in seeds(quick)
        ]
        found.append(sum(shares) / len(shares))
    return found


def _broken_share(result: Any, start_s: float, end_s: float) -> float:
    changes = broken_changes(result)
    since, total = None, 0.0
    for time, end, broken in zip(changes.time_us, changes.end, changes.broken, strict=True):
        if end != 0:
            continue
        now = max(float(time) / 1e6, start_s)
        if broken:
            since = now
        elif since is not None:
            total += now - since
            since = None
    if since is not None:
        total += end_s - since
    return total / (end_s - start_s)


def replug() -> dict[str, list[float]]:
    """[periods until a cable that was out for long works again, after it is back], by k."""
    found = {}
    for k in REPLUG_K:
        back = LOOSE_S + (3 * k + 20) / HZ
        events = [{"action": "cut", "at_s": LOOSE_S}, {"action": "restore", "at_s": back}]
        result = simulated(tables(1 / k, 1 / k, events, back + 40 / HZ), 1)
        changes = broken_changes(result)
        again = [
            (float(time) / 1e6 - back) * HZ
            for time, end, broken in zip(changes.time_us, changes.end, changes.broken, strict=True)
            if end == 0 and not broken and time / 1e6 > back
        ]
        found[str(k)] = again
    return found


def share_found(
    results: Results, quick: bool, case: tuple[float, float, float], within_s: float
) -> float:
    """Share of the watched cables that were found broken within a time."""
    found = results[_found_key(*case, quick)]
    within = sum(n is not None and n <= within_s * HZ for n in found)
    return float(within / len(found))


def draw(results: Results, quick: bool) -> Figure:
    """p_f over time for both settings; the share of time broken over the loss; how soon found."""
    figure = style.figure(style.WIDE_IN, 4.2)
    left, right = figure.subfigures(1, 2, width_ratios=(1.35, 1), squeeze=False).flat
    axes = left.subplots(2, 1, sharex=True)
    for ax, (letter, r_f, r_r) in zip(axes, SETTINGS, strict=True):
        _history(ax, results[_history_key(r_f, r_r)])
        ax.set_title(f"{letter}  $r_f$ = {r_f}, $r_r$ = {r_r}")
    axes[1].set_xlabel("beacon periods since the connection is loose")
    above, below = right.subplots(2, 1)
    _thresholds(above, results, quick)
    _how_soon(below, results, quick)
    return figure


def _how_soon(ax: Axes, results: Results, quick: bool) -> None:
    time_s = np.geomspace(2 / HZ, WATCHED_S, 120)
    names = (*(f"{name}, {percent(LOSS)} lost" for name, *_ in SETTINGS), f"a, {percent(RARE)}")
    for i, (case, name) in enumerate(zip(FOUND, names, strict=True)):
        shares = [100 * share_found(results, quick, case, t) for t in time_s]
        ax.plot(time_s, shares, color=style.SERIES[i], ls=style.DASHES[i], label=name)
    ax.axvline(SHOWN_PERIODS / HZ, color=style.SOFT, lw=0.8, ls=":")
    ax.set_xscale("log")
    ax.set_xticks([0.01, 0.1, 1, 10, 60], ["0.01", "0.1", "1", "10", "60"])
    ax.minorticks_off()
    ax.set_ylim(-3, 134)
    ax.set_yticks(range(0, 101, 20))
    ax.set_xlabel("time since the connection is loose (s)")
    ax.set_ylabel("found broken (%)")
    ax.set_title("d  until it is found for the first time")
    ax.legend(loc="upper left", ncols=3, columnspacing=0.8, handlelength=1.5)


def _history(ax: Axes, values: list[float]) -> None:
    pf = np.array(values)
    time = np.arange(1, len(pf) + 1)
    missed = np.diff(pf, prepend=0) > 0
    missed |= (pf == 2) & (np.diff(pf, prepend=0) == 0)
    ax.fill_between(
        time, 0, 2, where=pf >= 1, step="post", color=style.ORANGE, alpha=0.3, lw=0, label="broken"
    )
    ax.step(time, pf, where="post", color=style.BLUE)
    ax.axhline(1, color=style.INK, lw=0.8, ls="--")
    ax.plot(time[missed], np.full(missed.sum(), -0.16), "|", color=style.VERMILION, ms=3.5, mew=0.8)
    ax.set_ylim(-0.35, 2.12)
    ax.set_yticks([0, 1, 2])
    ax.set_xlim(0, len(pf))
    ax.set_ylabel("penalty $p_f$")
    ax.grid(axis="x", visible=False)


def _thresholds(ax: Axes, results: Results, quick: bool) -> None:
    x = np.array(losses(quick))
    for i, (letter, r_f, r_r) in enumerate(SETTINGS):
        colour = style.SERIES[i]
        shares = results[_sweep_key(r_f, r_r, quick)]
        ax.plot(100 * x, 100 * np.array(shares), style.MARKERS[i], ls="-", color=colour, ms=2.6)
        limit = 100 * r_r / (r_f + r_r)
        ax.axvline(limit, color=colour, ls="--", lw=0.9)
        ax.text(limit + 1.5, 105, letter, color=colour, va="bottom", fontweight="bold")
    ax.set_xlabel("lost beacons (%)")
    ax.set_ylabel("time held broken (%)")
    ax.set_ylim(-3, 119)
    ax.set_yticks(range(0, 101, 20))
    ax.set_title("c  which losses are tolerated")


def judge(results: Results, quick: bool) -> list[Claim]:
    """Not detected in a, for how long and how rare; detected in b; the threshold; re-plugging."""
    calm, alert, rare = FOUND
    return [
        _calm(results, quick, calm, "E16, E17, E18: misses are a random walk, and five more misses "
              "than hits come sooner or later; within the time of the picture few cables trip"),
        _calm(results, quick, rare, ""),
        _alert(results, quick, alert),
        _threshold_claim(results, quick),
        _replug_claim(results),
    ]  # fmt: skip


def _times(results: Results, quick: bool, case: tuple[float, float, float]) -> str:
    shares = [
        f"{percent(share_found(results, quick, case, s))} in {s:g} s"
        for s in (SHOWN_PERIODS / HZ, JUDGED_S, WATCHED_S)
    ]
    return f"{len(_runs(quick))} cables: found broken {joined(shares)}"


def _calm(results: Results, quick: bool, case: tuple[float, float, float], reason: str) -> Claim:
    share = share_found(results, quick, case, JUDGED_S)
    return Claim(
        "6a",
        f"r_f similar to r_r ({case[0]}): a loose connection with rare misses ({percent(case[2])} "
        f"lost) is not detected (at most {percent(NOT_DETECTED.high)} of the cables in "
        f"{JUDGED_S:g} s)",
        _times(results, quick, case),
        verdict(NOT_DETECTED.has(share), "E16", "E17", "E18"),
        reason if not NOT_DETECTED.has(share) else "a chance remains: five misses more than hits",
    )


def _alert(results: Results, quick: bool, case: tuple[float, float, float]) -> Claim:
    found = [n for n in results[_found_key(*case, quick)] if n is not None]
    half = f"; half of them within {np.median(found):.0f} periods" if found else ""
    return Claim(
        "6b",
        f"r_f increased, r_r reduced ({case[0]}, {case[1]}): the same connection "
        f"({percent(case[2])} lost) is detected (at least {percent(DETECTED.low)} in "
        f"{JUDGED_S:g} s)",
        _times(results, quick, case) + half,
        verdict(DETECTED.has(share_found(results, quick, case, JUDGED_S)), "E16", "E17", "E18"),
        "" if found else "no cable was found",
    )


def _threshold_claim(results: Results, quick: bool) -> Claim:
    words, off = [], []
    for letter, r_f, r_r in SETTINGS:
        limit = r_r / (r_f + r_r)
        shares = np.array(results[_sweep_key(r_f, r_r, quick)])
        half = float(np.interp(0.5, shares, losses(quick)))
        off.append(half - limit)
        words.append(
            f"{letter}: half of the time broken at {percent(half)}, limit {percent(limit)}"
        )
    return Claim(
        "6",
        "r_f and r_r set the allowed ratio of lost packets, r_r / (r_f + r_r) (within "
        f"{100 * AT_LIMIT.high:.0f} points)",
        joined(words),
        verdict(AT_LIMIT.has(*off)),
        "p_f drifts up where loss * r_f > (1 - loss) * r_r; chance blurs the limit",
    )


def _replug_claim(results: Results) -> Claim:
    found = results[f"fig6 replug k={joined(REPLUG_K)}"]
    words = joined(f"k = {k}: {again[0]:.0f}" for k, again in found.items())
    exact = all(len(a) == 1 and round(a[0], 2) == int(k) + 1 for k, a in found.items())
    return Claim(
        "6",
        "p_f stays in [0, 2], so that a re-plugged cable is found fast: k+1 beacons",
        f"periods until it works again, {words}",
        verdict(exact, "E19"),
        "r_f = r_r = 1/k; counted from the tick of the cable's return",
    )


EXPERIMENT = Experiment(
    "fig6",
    "Fig. 6: penalty of a loose connection",
    f"a, b: {percent(LOSS)} of the beacons are lost on n1's cable; red ticks: beacons missed; "
    "shaded: held broken (p_f >= 1). c: the same for all losses; dashed: r_r / (r_f + r_r). d: "
    "share of the cables found broken at least once; dotted: the end of a and b.",
    points,
    draw,
    judge,
)
