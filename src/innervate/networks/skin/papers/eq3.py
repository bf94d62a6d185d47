"""II-B.4, Eq. 3: how often cells may balance; and Algorithm 3 as printed."""

from functools import cache
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.skin.analysis.load import balance_factor, port_loads
from innervate.networks.skin.analysis.rows import parent_changes
from innervate.networks.skin.papers.common import SILENT, number, plan_of, planned
from innervate.networks.skin.papers.startup import CLOCKS
from innervate.networks.skin.papers.steps import stale_sizes
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, Span, sized, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style
from innervate.topology.ties import tied_at

SETUPS = ("setup-5", "setup-6", "setup-7")
HZ = 250
SETTLE, WATCH = 3000, 1500  # periods; with rare attempts SETTLE_TURNS of them
SETTLE_TURNS = 4
TITLE = "II-B.4, Eq. 3: how often cells may balance"
CAPTION = (
    f"{HZ} Hz, rule feasible. a: moves after {SETTLE} periods and more. b: balance factor at the "
    "end, a dot a run. c: periods until all cells know the size of their subnetwork again."
)
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
USUAL = RATES[1]
rates = sized(RATES[1:], RATES)  # that are tried


@cache
def skin(setup: str) -> tuple[int, int]:
    """A setup's depth in hops, and its number of interface ports."""
    made = plan_of(setup)
    return int(made.depth_max), int(made.graph.interfaces)


def point(setup: str, rate: Rate, quick: bool, rule: str = "even") -> Point:
    """Skins that balance at a rate."""
    periods = rate.periods(*skin(setup))
    said = {"even": "", "paper": ", Alg. 3 as printed"}[rule]
    what = f"balancing {setup} every {periods} periods{said}, {HZ} Hz"
    cost_s = 0.2 * (1 + periods / 800)
    return Point.each(what, cost_s, 1 if quick else 10, measure, setup, periods, rule)


def sizes(setup: str, lock_step: bool, quick: bool) -> Point:
    """How long sizes are out of date."""
    watched = 400 if quick else 1500
    what = f"sizes {setup} {CLOCKS[lock_step]}, {HZ} Hz, {watched} periods"
    seeds = 1 if quick else 10
    return Point.each(what, 0.5, seeds, stale_sizes, setup, lock_step, watched)


def points(quick: bool) -> list[Point]:
    """All rates, Algorithm 3 as printed, and how long sizes are out of date."""
    made = [point(setup, rate, quick) for setup in SETUPS for rate in rates(quick)]
    made += [point(setup, USUAL, quick, "paper") for setup in SETUPS]
    return made + [sizes(setup, lock_step, quick) for setup in SETUPS for lock_step in CLOCKS]


def measure(setup: str, periods: int, rule: str, seed: int) -> dict[str, Any]:
    """Moves while watched, and the balance factor at the end."""
    settle = max(SETTLE, SETTLE_TURNS * periods)
    result = simulate(planned(
        setup, seed, (settle + WATCH) / HZ, SILENT, updates="periodic", beacon_hz=HZ,
        balance_periods=periods, balance_rule=rule,
    ))  # fmt: skip
    changes = parent_changes(result)
    late = changes.balancing & (changes.time_us > 1e6 * settle / HZ)
    return {"moves": int(late.sum()), "beta": balance_factor(port_loads(result))}


def moves_of(got: Measured, setup: str, lock_step: bool) -> list[int]:
    """Periods until sizes were true again, of all moves."""
    return list(chain.from_iterable(got[sizes(setup, lock_step, got.quick)]))


def draw(got: Measured) -> Figure:
    """Moves over the rate, balance with both signs, sizes out of date."""
    figure, axes = style.panels(style.WIDE_IN, 2.9, 1, 3, width_ratios=(1.3, 1, 1))
    _moves(axes[0], got)
    _signs(axes[1], got)
    _sizes(axes[2], got)
    return figure


def _moves(ax: Axes, got: Measured) -> None:
    for i, setup in enumerate(SETUPS):
        found = {
            rate.periods(*skin(setup)): got[point(setup, rate, got.quick)]["moves"]
            for rate in rates(got.quick)
        }
        means = [1000 * np.mean(found[periods]) / WATCH for periods in sorted(found)]
        ax.plot(sorted(found), means, label=number(setup), **style.look(i))
    drawing.logarithmic(ax, [2, 8, 40, 160, 1600])
    ax.set_yscale("symlog", linthresh=1)
    ax.set_yticks([0, 1, 10, 100, 1000, 10_000], ["0", "1", "10", "100", "1000", "10000"])
    ax.set(ylim=(-0.1, None), ylabel="moves in 1000 periods")
    ax.set(xlabel="periods between a cell's attempts", title="a  does it come to rest?")
    ax.legend(loc="upper right")


def _signs(ax: Axes, got: Measured) -> None:
    for i, (rule, name) in enumerate((("even", "corrected (E12)"), ("paper", "as printed"))):
        for place, setup in enumerate(SETUPS):
            beta = got[point(setup, USUAL, got.quick, rule)]["beta"]
            x = place + 0.2 * (2 * i - 1)
            ax.bar(x, np.mean(beta), 0.36, color=style.SERIES[1 - i], alpha=0.35, lw=0,
                   label=name if place == 0 else None)  # fmt: skip
            ax.plot(np.full(len(beta), x), beta, style.MARKERS[i], color=style.SERIES[1 - i], ms=2)
    drawing.each_mode(ax, [number(setup) for setup in SETUPS])
    ax.set(ylim=(0, 1.35), yticks=np.arange(0, 1.01, 0.2), ylabel="balance factor $\\beta$")
    ax.set_title("b  Algorithm 3")
    ax.legend(loc="upper left")


def _sizes(ax: Axes, got: Measured) -> None:
    for i, (lock_step, name) in enumerate(CLOCKS.items()):
        drawn = [place for place, setup in enumerate(SETUPS) if moves_of(got, setup, lock_step)]
        for place, setup in enumerate(SETUPS):
            found = moves_of(got, setup, lock_step)
            x = np.full(len(found), place + 0.15 * (2 * i - 1))
            ax.plot(x, found, style.MARKERS[i], color=style.SERIES[i], ms=2.6,
                    label=name if [place] == drawn[:1] else None)  # fmt: skip
    for place, setup in enumerate(SETUPS):
        ax.plot([place - 0.4, place + 0.4], [2 * skin(setup)[0]] * 2, color=style.BLACK, lw=1.2,
                label="2 max(H)" if place == 0 else None)  # fmt: skip
    drawing.each_mode(ax, [number(setup) for setup in SETUPS])
    ax.set(ylim=(0, 62), ylabel="sizes out of date (periods)", title="c  after one move")
    ax.legend(loc="upper right")


def judge(got: Measured) -> Claims:
    """Algorithm 3, n_val, n_bal, Eq. 3, higher rates."""
    yield _printed(got)
    yield _up_to_date(got)
    yield _one_node()
    yield _few_nodes()
    for rate in rates(got.quick):
        yield _stable(got, rate)


def _printed(got: Measured) -> Claim:
    words, flat = {}, []
    for rule in ("even", "paper"):
        found = {s: got[point(s, USUAL, got.quick, rule)]["beta"] for s in SETUPS}
        flat = [beta for betas in found.values() for beta in betas]
        words[rule] = joined(
            f"{number(s)} {np.mean(beta):.3f} (least {min(beta):.3f})" for s, beta in found.items()
        )
    return Claim(
        "II-B.4",
        "Algorithm 3 as printed evens out the loads of the interface ports (balance factor at "
        f"least {BALANCED.low})",
        f"{words['paper']}; with the sign corrected {words['even']}; "
        f"{len(flat) // len(SETUPS)} runs each",
        verdict(BALANCED.has(*flat)),
        "E12: printed, a cell moves to the larger subnetwork if that is larger by more than its "
        'own load (L(q), L(p_m) read as in Eq. 2); balance_rule = "paper" does so',
    )


def _up_to_date(got: Measured) -> Claim:
    words, off = [], []
    for setup in SETUPS:
        bound = 2 * skin(setup)[0]
        for lock_step, name in CLOCKS.items():
            found = moves_of(got, setup, lock_step)
            off += [n / bound for n in found]
            most = f"at most {max(found, default=0)} of {bound} ({len(found)} moves)"
            words.append(f"{number(setup)} {name} {most}")
    return Claim(
        "II-B.4",
        "subnetwork sizes are up to date n_val <= 2 max(H) periods after a move",
        "periods: " + joined(words),
        verdict(UP_TO_DATE.has(*off)),
        "moves that were alone until all sizes were true again",
    )


def _one_node() -> Claim:
    most = {setup: max(tied_at(plan_of(setup).graph).values()) for setup in SETUPS}
    return Claim(
        "II-B.4",
        "only one node can have the distance d_i to two roots",
        "most at one distance: " + joined(f"{number(s)} {n}" for s, n in most.items()),
        verdict(ONE.has(*most.values())),
        "E14: a mesh has as many as its diagonal is long",
    )


def _few_nodes() -> Claim:
    tied = {setup: sum(tied_at(plan_of(setup).graph).values()) for setup in SETUPS}
    most = {setup: int(np.prod(skin(setup))) for setup in SETUPS}
    return Claim(
        "II-B.4",
        "at most n_bal <= d_max |N_R| nodes may balance",
        joined(f"{number(setup)} {n} of {most[setup]}" for setup, n in tied.items()),
        verdict(FEW.has(*(n / most[setup] for setup, n in tied.items()))),
        "E14: n_bal is no bound; what settles is trying rarely, and a new turn after a move",
    )


def _stable(got: Measured, rate: Rate) -> Claim:
    words, moves, betas = [], [], []
    for setup in SETUPS:
        found = got[point(setup, rate, got.quick)]
        restless = sum(n > 0 for n in found["moves"])
        words.append(
            f"{number(setup)} ({rate.periods(*skin(setup))}): {restless} of "
            f"{len(found['moves'])} runs still move, least balance factor {min(found['beta']):.3f}"
        )
        moves += found["moves"]
        betas += found["beta"]
    passed = QUIET.has(*moves) and BALANCED.has(*betas)
    first = rate is RATES[0]
    what = "balancing at Eq. 3's frequency" if first else (
        "higher balancing frequencies also lead to a stable balancing: an attempt every "
        f"{rate.name} periods"
    )  # fmt: skip
    return Claim(
        "Eq. 3" if first else "II-B.4",
        f"{what} (no move in {WATCH} periods, balance factor at least {BALANCED.low})",
        f"{joined(words)}; {percent(sum(n > 0 for n in moves) / len(moves))} of all runs",
        verdict(passed, *(() if first else ("E14",))),
        "" if passed else "E14: cells move before they have heard what the others' moves changed",
    )
