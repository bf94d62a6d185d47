"""What `practical` and `turnaround` share: the practical mode over n, and what it is held against.

CSMA/CD stays on the slotted level, where everybody knows of every collision for nothing; with a
turnaround it is given the better of two lengths of a backoff slot.
"""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers import common
from innervate.networks.radio.papers.common import LOOKS, RESERVED, SIZES, TAU_US, Curve, Look
from innervate.networks.radio.papers.medium import Channel
from innervate.networks.radio.slotted.drive import SLOT
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Measured, Point, beyond, sized, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style

DELAY = 0.75 * TAU_US / SLOT  # mean of 52..104 us, in slots
BACKOFFS = (1, 11)  # slots; 11 hold a turnaround of 2 ms
RETURNS = (("", None), (", back at once", 0.0))
WITH_RETURN = ("csma-cd-d2", "csma-cd-d2p")
QUICK = (2, 3, 4, 5, 10, 20, 50, 100)
FULL = (2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60, 70, 80, 90, 100)
ns = sized(QUICK, FULL)  # numbers of stations, ascending, one place of a curve each
TRAFFIC = ("saturated", "disaster")


class Setting(NamedTuple):
    """A turnaround, and how many packets a turn may carry."""

    ta_us: int
    per_turn: int = 1

    @property
    def slots(self) -> float:
        """The turnaround in slots, not always a whole number."""
        return self.ta_us / SLOT


def saturated(setting: Setting, size: int, quick: bool) -> list[Point]:
    """The practical mode in saturation, over n."""
    options = (("per_turn", setting.per_turn),) if setting.per_turn > 1 else ()
    return [
        Channel("practical", n, size, setting.ta_us, "saturated", options=options,
                packets=max(30, (600 if quick else 2000) // n)).point(1 if quick else 3)
        for n in ns(quick)
    ]  # fmt: skip


def disasters(setting: Setting, size: int, quick: bool) -> list[Point]:
    """The practical mode where all have one packet at once, over n."""
    seeds = 8 if quick else 60
    return [Channel("practical", n, size, setting.ta_us).point(seeds) for n in ns(quick)]


def rivals(setting: Setting, mac: str, size: int, traffic: str, quick: bool) -> list[list[Curve]]:
    """CSMA/CD with this turnaround: for each reading of the way back, the backoffs."""
    few = 2 if quick else 6
    runs = few if traffic == "saturated" else 15 * few
    successes = 3000 if quick else 6000
    if not setting.ta_us:
        return [[Curve(mac, size, traffic, ns(quick), runs, successes)]]
    shared: tuple[tuple[str, Any], ...] = (("turnaround_slots", setting.slots),)
    made = []
    for _, back in RETURNS:
        given = shared if back is None else (*shared, ("return_slots", back))
        made.append([
            Curve(mac, size, traffic, ns(quick), runs, successes, (*given, ("backoff_slots", b)))
            for b in BACKOFFS
        ])  # fmt: skip
    return made


def reserved(setting: Setting, size: int, traffic: str, quick: bool) -> Curve:
    """The paper's slotted level with this turnaround."""
    options = (("turnaround_slots", setting.slots),) if setting.ta_us else ()
    return Curve(RESERVED, size, traffic, ns(quick), 1, 2000, options)


def points(setting: Setting, quick: bool, *more: Setting) -> list[Point]:
    """Everything of a turnaround; `more`: settings that are run in saturation only."""
    made: list[Point] = []
    for size in SIZES:
        made += disasters(setting, size, quick)
        for one in (setting, *more):
            made += saturated(one, size, quick)
        for traffic in TRAFFIC:
            made.append(reserved(setting, size, traffic, quick).point())
            for mac in WITH_RETURN:
                for group in rivals(setting, mac, size, traffic, quick):
                    made += [curve.point() for curve in group]
    return made


def throughput(got: Measured, setting: Setting, size: int) -> np.ndarray:
    """S of the practical mode over n."""
    found = saturated(setting, size, got.quick)
    return np.array([np.mean(got[point]["throughput"]) for point in found])


def duration(got: Measured, setting: Setting, size: int) -> np.ndarray:
    """T_D of the practical mode over n."""
    return np.array([np.mean(got[one]["duration"]) for one in disasters(setting, size, got.quick)])


def rival(
    got: Measured, setting: Setting, mac: str, size: int, back: int = 0, traffic: str = "saturated"
) -> np.ndarray:
    """The better of the backoffs at every n, with one reading of the way back."""
    group = rivals(setting, mac, size, traffic, got.quick)[back]
    values = np.array([curve.mean(got) for curve in group])
    best: np.ndarray = values.max(axis=0) if traffic == "saturated" else values.min(axis=0)
    return best


def bound(setting: Setting, size: int) -> float:
    """T / (T + ta + d); with k packets a turn of k T."""
    return forms.handover_bound(size * setting.per_turn, setting.slots, DELAY)


def readings(setting: Setting) -> range:
    """Readings of the way back that make a difference."""
    return range(len(RETURNS) if setting.ta_us else 1)


def complete(got: Measured, setting: Setting) -> Claim:
    """All get through, none lost silently."""
    runs = [got[one] for size in SIZES for one in disasters(setting, size, got.quick)]
    runs += [got[one] for size in SIZES for one in saturated(setting, size, got.quick)]
    left, silent, done = (
        sum(sum(run[name]) for run in runs) for name in ("open", "silent", "completed")
    )
    return beyond(
        "the practical mode resolves every collision of 2..100 stations and loses nothing silently",
        f"{sum(len(run['silent']) for run in runs):,} runs, disaster and saturation, turnaround "
        f"{setting.ta_us / 1e3:g} ms, delays 52..104 us: {left} packets left over, {silent} of "
        f"{done:,} lost silently",
        verdict(left == silent == 0),
    )


def linear(got: Measured, setting: Setting) -> Claim:
    """The claim that T_D grows linearly: slope in slots a station, and the fit."""
    words, fits = [], []
    for size in SIZES:
        rise, start, fit = common.slope(ns(got.quick), duration(got, setting, size))
        fits.append(fit)
        words.append(f"T = {size}: {start:.0f} + {rise:.2f} n slots, R^2 = {fit:.5f}")
    return beyond(
        "its T_D grows linearly with n on the event level (R^2 above 0.99)",
        f"{joined(words, '; ')} ({8 if got.quick else 60} runs each n)",
        verdict(min(fits) > 0.99),
        "above T + 1 a station: who was alone in a minislot has to be found out first",
    )


def near_bound(got: Measured, setting: Setting, share: float) -> Claim:
    """S against the hand-over bound."""
    words, parts = [], []
    for size in SIZES:
        ratios = throughput(got, setting, size) / bound(setting, size)
        parts.append(float(ratios.min()))
        words.append(
            f"T = {size}: {percent(ratios.min(), 1)} to {percent(ratios.max(), 1)} of "
            f"{bound(setting, size):.4f}"
        )
    extra = f", {setting.per_turn} packets a turn" if setting.per_turn > 1 else ""
    return beyond(
        f"its S is at least {percent(share)} of the hand-over bound T / (T + ta + d), n = 2..100"
        + (" (4 T for T)" if setting.per_turn > 1 else ""),
        joined(words, "; ") + extra,
        verdict(min(parts) >= share),
        "no protocol that lets everybody hear every packet passes that bound; d is the mean of all "
        "pairs, from which the drawn delays of few stations differ a little",
    )


def fair(got: Measured, *settings: Setting) -> Claim:
    """Jain's index over one round."""
    found = (one for setting in settings for size in SIZES
             for one in saturated(setting, size, got.quick))  # fmt: skip
    least = min(float(np.mean(got[one]["jain_round"])) for one in found)
    return beyond(
        "it is fair within every round: Jain's index over one round above 0.99",
        f"least mean of all n = 2..100, T = 5 and 25: {least:.4f}",
        verdict(least > 0.99),
        "a round is as many turns as stations, whatever a turn carries",
    )


def draw(
    got: Measured, settings: tuple[Setting, ...], words: str, height_in: float, ratio: float
) -> Figure:
    """Above S, below T_D; settings after the first one are drawn in saturation only."""
    figure, axes = style.panels(style.WIDE_IN, height_in, 2, 2, height_ratios=(ratio, 1))
    for i, size in enumerate(SIZES):
        _saturation(axes[i], got, settings, size)
        _disaster(axes[2 + i], got, settings[0], size)
        axes[i].set_title(f"{'ab'[i]}  T = {size}{words}, saturation")
        axes[2 + i].set_title(f"{'cd'[i]}  T = {size}{words}, disaster")
    axes[0].set_ylabel("throughput S")
    axes[2].set_ylabel("$T_D$ (slots)")
    return figure


def _saturation(ax: Axes, got: Measured, settings: tuple[Setting, ...], size: int) -> None:
    setting = settings[0]
    common.stations_axis(ax)
    ax.set(xlim=(1.9, 105), ylim=(0, 1.0))
    ends = []

    def show(look: Look, values: np.ndarray) -> None:
        common.line(ax, look, ns(got.quick), values, marks=(2, 3, 4, 5, 10, 20, 50, 100))
        ends.append((float(values[-1]), look.name, look.colour))

    for mac in WITH_RETURN:
        for back in reversed(readings(setting)):
            look = LOOKS[mac]._replace(name=LOOKS[mac].name + RETURNS[back][0])
            if back:
                look = look._replace(dash=style.DASHES[2])
            show(look, rival(got, setting, mac, size, back))
    plain = reserved(setting, size, "saturated", got.quick).mean(got)
    show(LOOKS[RESERVED]._replace(name="CSMA/CD-R slotted"), plain)
    looks = (("practical mode", style.BLACK, "X"), ("4 packets a turn", style.PURPLE, "P"))
    for one, (name, colour, marker) in zip(settings, looks, strict=False):
        show(Look(name, colour, "-", marker), throughput(got, one, size))
        limit = bound(one, size)
        ax.axhline(limit, color=colour, lw=0.8, ls=":")
        ends.append((limit, f"its bound {limit:.3f}", colour))
    drawing.end_labels(ax, ends)


def _disaster(ax: Axes, got: Measured, setting: Setting, size: int) -> None:
    """T_D over n with the fitted line."""
    places, ours = np.array(ns(got.quick)), duration(got, setting, size)
    rise, start, fit = common.slope(places, ours)
    for mac in WITH_RETURN:
        found = [rival(got, setting, mac, size, b, "disaster") for b in readings(setting)]
        ax.plot(places, np.min(found, axis=0), **LOOKS[mac].how)
    plain = reserved(setting, size, "disaster", got.quick).mean(got)
    ax.plot(places, plain, **LOOKS[RESERVED]._replace(name="CSMA/CD-R slotted").how)
    ax.plot(places, ours, "X", color=style.BLACK, ms=4, label="practical mode")
    ax.plot(places, start + rise * places, color=style.BLACK, lw=0.8, ls="--",
            label=f"{start:.0f} + {rise:.1f} n\n$R^2$ = {fit:.4f}")  # fmt: skip
    ax.set(ylim=(0, 1.75 * float(ours[-1])), xlim=(0, 105), xlabel="stations n")
    ax.legend(loc="upper left", bbox_to_anchor=(1.02, 1))
