"""II-B.4, Eq. 3: how often cells may balance; and Algorithm 3 as printed."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate import scenario
from innervate.networks.skin.analysis.load import balance_factor, port_loads
from innervate.networks.skin.analysis.rows import parent_changes
from innervate.networks.skin.papers import stale
from innervate.networks.skin.papers.common import joined, percent, seeds_of
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers.experiment import Claim, Experiment, Point, Results, Span, verdict
from innervate.plot import style
from innervate.topology.ties import tied_at

SETUPS = ("setup-5", "setup-6", "setup-7")
HZ = 250
SETTLE, WATCH = 3000, 1500  # periods; with rare attempts SETTLE_TURNS of them
SETTLE_TURNS = 4
BALANCED = Span(0.999, 1.0)
QUIET = Span(0, 0)  # moves while watched
UP_TO_DATE = Span(0.0, 1.0)  # of 2 max(H) periods
ONE = Span(0, 1)  # cells at one distance to two roots
FEW = Span(0.0, 1.0)  # cells that may balance, of d_max |N_R|


class Rate(NamedTuple):
    """How often a cell tries: a name, and the periods between two of its attempts."""

    name: str
    periods: Any  # from depth and interface ports


RATES = (
    Rate("Eq. 3: 2 d_max^2 |N_R|", lambda depth, ports: 2 * depth**2 * ports),
    Rate("8 d_max (default)", lambda depth, ports: 8 * depth),
    Rate("2 d_max", lambda depth, ports: 2 * depth),
    Rate("8", lambda depth, ports: 8),
    Rate("2", lambda depth, ports: 2),
)
PRINTED = Rate("Alg. 3 as printed", RATES[1].periods)
_SAID = {"even": "", "paper": ", Alg. 3 as printed"}


def seeds(quick: bool) -> range:
    """Seeds of the runs of each setting: 10, or 1 if `quick`."""
    return seeds_of(1 if quick else 10)


@cache
def skin(setup: str) -> tuple[int, int]:
    """A setup's depth in hops, and its number of interface ports."""
    made = scenario.plan(scenario.load(setup, [("event", [])]))
    return int(made.depth_max), int(made.graph.interfaces)


def _key(setup: str, periods: int, rule: str, quick: bool) -> str:
    return (
        f"balancing {setup} every {periods} periods{_SAID[rule]}, {HZ} Hz, "
        f"seeds 1-{seeds(quick)[-1]}"
    )


def _stale_key(setup: str, lock_step: bool, quick: bool) -> str:
    clocks = "lock-step" if lock_step else "free running"
    return f"sizes {setup} {clocks}, {HZ} Hz, seeds 1-{seeds(quick)[-1]}, {_watched(quick)} periods"


def _watched(quick: bool) -> int:
    return 400 if quick else 1500


def _settings(quick: bool) -> list[tuple[str, int, str]]:
    """Setup, periods between attempts, rule of all runs."""
    rates = RATES[1:] if quick else RATES
    made = []
    for setup in SETUPS:
        made += [(setup, rate.periods(*skin(setup)), "even") for rate in rates]
        made.append((setup, PRINTED.periods(*skin(setup)), "paper"))
    return made


def points(quick: bool) -> list[Point]:
    """All rates, Algorithm 3 as printed, and how long sizes are out of date."""
    made = [
        Point.of(
            _key(*one, quick),
            0.2 * len(seeds(quick)) * (1 + one[1] / 800),
            *(measure, *one, seeds(quick)),
        )
        for one in _settings(quick)
    ]
    return made + [
        Point.of(
            _stale_key(setup, lock_step, quick),
            0.5 * len(seeds(quick)),
            *(stale.measure, setup, lock_step, seeds(quick), _watched(quick)),
        )
        for setup in SETUPS
        for lock_step in (True, False)
    ]


def measure(setup: str, periods: int, rule: str, some: Sequence[int]) -> dict[str, Any]:
    """Of every seed: moves while watched, and the balance factor at the end."""
    settle = max(SETTLE, SETTLE_TURNS * periods)
    overrides: list[tuple[str, Any]] = [
        ("protocol.updates", "periodic"),
        ("protocol.beacon_hz", HZ),
        ("protocol.balance_periods", periods),
        ("protocol.balance_rule", rule),
        ("data.rate_hz", 0),
        ("event", []),
        ("duration_s", (settle + WATCH) / HZ),
    ]
    found: dict[str, Any] = {"moves": [], "beta": []}
    for seed in some:
        result = simulate(scenario.plan(scenario.load(setup, overrides, seed)))
        changes = parent_changes(result)
        late = changes.balancing & (changes.time_us > 1e6 * settle / HZ)
        found["moves"].append(int(late.sum()))
        found["beta"].append(balance_factor(port_loads(result)))
    return found


def of(results: Results, quick: bool, setup: str, rate: Rate, rule: str = "even") -> Any:
    """What was measured at a rate."""
    return results[_key(setup, rate.periods(*skin(setup)), rule, quick)]


def draw(results: Results, quick: bool) -> Figure:
    """Moves over the rate, balance with both signs, sizes out of date."""
    figure, axes = style.panels(style.WIDE_IN, 2.9, 1, 3, width_ratios=(1.3, 1, 1))
    _moves(axes[0], results, quick)
    _signs(axes[1], results, quick)
    _sizes(axes[2], results, quick)
    return figure


def _moves(ax: Axes, results: Results, quick: bool) -> None:
    for i, setup in enumerate(SETUPS):
        settings = sorted(p for s, p, rule in _settings(quick) if s == setup and rule == "even")
        moves = [np.array(results[_key(setup, p, "even", quick)]["moves"]) for p in settings]
        means = [1000 * found.mean() / WATCH for found in moves]
        ax.plot(settings, means, style.MARKERS[i], color=style.SERIES[i], ls=style.DASHES[i],
                label=f"setup {setup[-1]}")  # fmt: skip
    ax.set_xscale("log")
    ax.set_xticks([2, 8, 40, 160, 1600], ["2", "8", "40", "160", "1600"])
    ax.minorticks_off()
    ax.set_yscale("symlog", linthresh=1)
    ax.set_yticks([0, 1, 10, 100, 1000, 10_000], ["0", "1", "10", "100", "1000", "10000"])
    ax.set_ylim(-0.1, None)
    ax.set_xlabel("periods between a cell's attempts")
    ax.set_ylabel("moves in 1000 periods")
    ax.set_title("a  does it come to rest?")
    ax.legend(loc="upper right")


def _signs(ax: Axes, results: Results, quick: bool) -> None:
    for i, (rule, name) in enumerate((("even", "corrected (E12)"), ("paper", "as printed"))):
        for place, setup in enumerate(SETUPS):
            beta = of(results, quick, setup, RATES[1], rule)["beta"]
            x = place + 0.2 * (2 * i - 1)
            ax.bar(x, np.mean(beta), 0.36, color=style.SERIES[1 - i], alpha=0.35, lw=0,
                   label=name if place == 0 else None)  # fmt: skip
            ax.plot(np.full(len(beta), x), beta, style.MARKERS[i], color=style.SERIES[1 - i], ms=2)
    ax.set_xticks(range(len(SETUPS)), [f"setup {setup[-1]}" for setup in SETUPS])
    ax.set_ylim(0, 1.35)
    ax.set_yticks(np.arange(0, 1.01, 0.2))
    ax.set_ylabel("balance factor $\\beta$")
    ax.set_title("b  Algorithm 3")
    ax.grid(axis="x", visible=False)
    ax.legend(loc="upper left")


def _sizes(ax: Axes, results: Results, quick: bool) -> None:
    for i, (lock_step, name) in enumerate(((True, "lock-step"), (False, "free running"))):
        for place, setup in enumerate(SETUPS):
            found = results[_stale_key(setup, lock_step, quick)]["periods"]
            x = np.full(len(found), place + 0.15 * (2 * i - 1))
            ax.plot(x, found, style.MARKERS[i], color=style.SERIES[i], ms=2.6,
                    label=name if place == 0 else None)  # fmt: skip
    for place, setup in enumerate(SETUPS):
        ax.plot([place - 0.4, place + 0.4], [2 * skin(setup)[0]] * 2, color=style.BLACK, lw=1.2,
                label="2 max(H)" if place == 0 else None)  # fmt: skip
    ax.set_xticks(range(len(SETUPS)), [f"setup {setup[-1]}" for setup in SETUPS])
    ax.set_ylim(0, 62)
    ax.set_ylabel("sizes out of date (periods)")
    ax.set_title("c  after one move")
    ax.grid(axis="x", visible=False)
    ax.legend(loc="upper right")


def judge(results: Results, quick: bool) -> list[Claim]:
    """Algorithm 3, n_val, n_bal, Eq. 3, higher rates."""
    rates = RATES[1:] if quick else RATES
    return [
        _printed(results, quick),
        _up_to_date(results, quick),
        _one_node(),
        _few_nodes(),
        *(_stable(results, quick, rate) for rate in rates),
    ]


def _printed(results: Results, quick: bool) -> Claim:
    both = {
        rule: {s: of(results, quick, s, RATES[1], rule)["beta"] for s in SETUPS}
        for rule in ("paper", "even")
    }
    words = [
        joined(f"setup {s[-1]} {np.mean(beta):.3f} (least {min(beta):.3f})"
               for s, beta in found.items())
        for found in both.values()
    ]  # fmt: skip
    flat = [beta for found in both["paper"].values() for beta in found]
    return Claim(
        "II-B.4",
        "Algorithm 3 as printed evens out the loads of the interface ports (balance factor at "
        f"least {BALANCED.low})",
        f"{words[0]}; with the sign corrected {words[1]}; {len(seeds(quick))} runs each",
        verdict(BALANCED.has(*flat)),
        "E12: printed, a cell moves to the larger subnetwork if that is larger by more than its "
        'own load (L(q), L(p_m) read as in Eq. 2); balance_rule = "paper" does so',
    )


def _up_to_date(results: Results, quick: bool) -> Claim:
    words, off = [], []
    for setup in SETUPS:
        bound = 2 * skin(setup)[0]
        both = [results[_stale_key(setup, flag, quick)]["periods"] for flag in (True, False)]
        for name, found in zip(("lock-step", "free running"), both, strict=True):
            worst = max(found, default=0)
            words.append(
                f"setup {setup[-1]} {name} at most {worst} of {bound} ({len(found)} moves)"
            )
            off += [n / bound for n in found]
    return Claim(
        "II-B.4",
        "subnetwork sizes are up to date n_val <= 2 max(H) periods after a move",
        "periods: " + joined(words),
        verdict(UP_TO_DATE.has(*off)),
        "moves that were alone until all sizes were true again",
    )


def _one_node() -> Claim:
    most = {setup: max(tied_at(_graph(setup)).values()) for setup in SETUPS}
    return Claim(
        "II-B.4",
        "only one node can have the distance d_i to two roots",
        "most at one distance: " + joined(f"setup {s[-1]} {n}" for s, n in most.items()),
        verdict(ONE.has(*most.values())),
        "E14: a mesh has as many as its diagonal is long",
    )


def _few_nodes() -> Claim:
    words, off = [], []
    for setup in SETUPS:
        tied, (depth, ports) = sum(tied_at(_graph(setup)).values()), skin(setup)
        words.append(f"setup {setup[-1]} {tied} of {depth * ports}")
        off.append(tied / (depth * ports))
    return Claim(
        "II-B.4",
        "at most n_bal <= d_max |N_R| nodes may balance",
        joined(words),
        verdict(FEW.has(*off)),
        "E14: n_bal is no bound; what settles is trying rarely, and a new turn after a move",
    )


def _graph(setup: str) -> Any:
    return scenario.plan(scenario.load(setup, [("event", [])])).graph


def _stable(results: Results, quick: bool, rate: Rate) -> Claim:
    words, moves, betas = [], [], []
    for setup in SETUPS:
        found = of(results, quick, setup, rate)
        restless = sum(n > 0 for n in found["moves"])
        words.append(
            f"setup {setup[-1]} ({rate.periods(*skin(setup))}): {restless} of "
            f"{len(found['moves'])} runs still move, least balance factor {min(found['beta']):.3f}"
        )
        moves += found["moves"]
        betas += found["beta"]
    passed = QUIET.has(*moves) and BALANCED.has(*betas)
    first = rate is RATES[0]
    return Claim(
        "Eq. 3" if first else "II-B.4",
        ("balancing at Eq. 3's frequency" if first else "higher balancing frequencies also lead to "
         f"a stable balancing: an attempt every {rate.name} periods")
        + f" (no move in {WATCH} periods, balance factor at least {BALANCED.low})",
        f"{joined(words)}; {percent(sum(n > 0 for n in moves) / len(moves))} of all runs",
        verdict(passed, *(() if first else ("E14",))),
        "" if passed else "E14: cells move before they have heard what the others' moves changed",
    )  # fmt: skip


EXPERIMENT = Experiment(
    "eq3",
    "II-B.4, Eq. 3: how often cells may balance",
    f"{HZ} Hz, rule feasible. a: moves after {SETTLE} periods and more. b: balance factor at the "
    "end, a dot a run. c: periods until all cells know the size of their subnetwork again.",
    points,
    draw,
    judge,
)
