"""What `practical` and `turnaround` share: the practical mode over n, and what it is held against.

CSMA/CD stays on the slotted level, where everybody knows of every collision for nothing; with a
turnaround it is given the better of two lengths of a backoff slot.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers.common import (
    RESERVED,
    SIZES,
    TAU_US,
    Curve,
    first_from,
    joined,
    percent,
    slope,
)
from innervate.networks.radio.papers.medium import Channel
from innervate.networks.radio.slotted.drive import SLOT
from innervate.papers.experiment import Claim, Point, Results, verdict

DELAY = 0.75 * TAU_US / SLOT  # mean of 52..104 us, in slots
BACKOFFS = (1, 11)  # slots; 11 hold a turnaround of 2 ms
RETURNS = (("", None), (", back at once", 0.0))
WITH_RETURN = ("csma-cd-d2", "csma-cd-d2p")
QUICK = (2, 3, 4, 5, 10, 20, 50, 100)
FULL = (2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60, 70, 80, 90, 100)


class Setting(NamedTuple):
    """A turnaround, and how many packets a turn may carry."""

    ta_us: int
    per_turn: int = 1

    @property
    def slots(self) -> float:
        """The turnaround in slots, not always a whole number."""
        return self.ta_us / SLOT


def ns(quick: bool) -> tuple[int, ...]:
    """Numbers of stations, ascending, one place of a curve each."""
    return QUICK if quick else FULL


def saturated(setting: Setting, size: int, n: int, quick: bool) -> Channel:
    """The practical mode in saturation."""
    packets = max(30, (600 if quick else 2000) // n)
    options = (("per_turn", setting.per_turn),) if setting.per_turn > 1 else ()
    return Channel(
        "practical", n, size, setting.ta_us, "saturated", packets=packets, options=options
    )


def disaster(setting: Setting, size: int, n: int) -> Channel:
    """The practical mode where all have one packet at once."""
    return Channel("practical", n, size, setting.ta_us)


def seeds(quick: bool, traffic: str) -> range:
    """Seeds of the runs, fewer of the long saturated ones."""
    if traffic == "saturated":
        return range(1, 2 if quick else 4)
    return range(1, 9 if quick else 61)


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


def points(setting: Setting, quick: bool, more: tuple[Setting, ...] = ()) -> list[Point]:
    """Everything of a turnaround; `more`: settings that are run in saturation only."""
    made: list[Point] = []
    for size in SIZES:
        for n in ns(quick):
            made.append(disaster(setting, size, n).point(seeds(quick, "disaster")))
            made += [
                saturated(one, size, n, quick).point(seeds(quick, "saturated"))
                for one in (setting, *more)
            ]
        for traffic in ("saturated", "disaster"):
            made.append(reserved(setting, size, traffic, quick).point())
            for mac in WITH_RETURN:
                for group in rivals(setting, mac, size, traffic, quick):
                    made += [curve.point() for curve in group]
    return made


def throughput(results: Results, setting: Setting, size: int, quick: bool) -> np.ndarray:
    """S of the practical mode over n."""
    some = seeds(quick, "saturated")
    keys = [saturated(setting, size, n, quick).key_of(some) for n in ns(quick)]
    return np.array([np.mean(results[key]["throughput"]) for key in keys])


def duration(results: Results, setting: Setting, size: int, quick: bool) -> np.ndarray:
    """T_D of the practical mode over n."""
    some = seeds(quick, "disaster")
    keys = [disaster(setting, size, n).key_of(some) for n in ns(quick)]
    return np.array([np.mean(results[key]["duration"]) for key in keys])


def rival(
    results: Results, setting: Setting, mac: str, size: int, quick: bool, back: int = 0,
    traffic: str = "saturated",
) -> np.ndarray:  # fmt: skip
    """The better of the backoffs at every n, with one reading of the way back."""
    name = "throughput" if traffic == "saturated" else "duration"
    group = rivals(setting, mac, size, traffic, quick)[back]
    values = np.array([curve.mean(results, name) for curve in group])
    best: np.ndarray = values.max(axis=0) if traffic == "saturated" else values.min(axis=0)
    return best


def bound(setting: Setting, size: int) -> float:
    """T / (T + ta + d); with k packets a turn of k T."""
    return forms.handover_bound(size * setting.per_turn, setting.slots, DELAY)


def readings(setting: Setting) -> range:
    """Readings of the way back that make a difference."""
    return range(len(RETURNS) if setting.ta_us else 1)


def complete(results: Results, setting: Setting, quick: bool) -> Claim:
    """All get through, none lost silently."""
    runs = [
        results[disaster(setting, size, n).key_of(seeds(quick, "disaster"))]
        for size in SIZES
        for n in ns(quick)
    ]
    runs += [
        results[saturated(setting, size, n, quick).key_of(seeds(quick, "saturated"))]
        for size in SIZES
        for n in ns(quick)
    ]
    left = sum(sum(run["open"]) for run in runs)
    silent = sum(sum(run["silent"]) for run in runs)
    done = sum(sum(run["completed"]) for run in runs)
    count = sum(len(run["silent"]) for run in runs)
    return Claim(
        "beyond",
        "the practical mode resolves every collision of 2..100 stations and loses nothing silently",
        f"{count:,} runs, disaster and saturation, turnaround {setting.ta_us / 1e3:g} ms, delays "
        f"52..104 us: {left} packets left over, {silent} of {done:,} lost silently",
        verdict(left == silent == 0),
    )


def linear(results: Results, setting: Setting, quick: bool) -> Claim:
    """The claim that T_D grows linearly: slope in slots a station, and the fit."""
    words, fits = [], []
    for size in SIZES:
        rise, start, fit = slope(ns(quick), duration(results, setting, size, quick))
        fits.append(fit)
        words.append(f"T = {size}: {start:.0f} + {rise:.2f} n slots, R^2 = {fit:.5f}")
    runs = len(seeds(quick, "disaster"))
    return Claim(
        "beyond",
        "its T_D grows linearly with n on the event level (R^2 above 0.99)",
        f"{joined(words, '; ')} ({runs} runs each n)",
        verdict(min(fits) > 0.99),
        "above T + 1 a station: who was alone in a minislot has to be found out first",
    )


def near_bound(results: Results, setting: Setting, quick: bool, share: float) -> Claim:
    """S against the hand-over bound."""
    words, parts = [], []
    for size in SIZES:
        ratios = throughput(results, setting, size, quick) / bound(setting, size)
        parts.append(float(ratios.min()))
        words.append(
            f"T = {size}: {percent(ratios.min(), 1)} to {percent(ratios.max(), 1)} of "
            f"{bound(setting, size):.4f}"
        )
    extra = f", {setting.per_turn} packets a turn" if setting.per_turn > 1 else ""
    return Claim(
        "beyond",
        f"its S is at least {percent(share)} of the hand-over bound T / (T + ta + d), n = 2..100"
        + (" (4 T for T)" if setting.per_turn > 1 else ""),
        joined(words, "; ") + extra,
        verdict(min(parts) >= share),
        "no protocol that lets everybody hear every packet passes that bound; d is the mean of all "
        "pairs, from which the drawn delays of few stations differ a little",
    )


def least_from(results: Results, setting: Setting, mac: str, size: int, quick: bool) -> int | None:
    """From which n on the practical mode has the higher S, in every reading of the way back."""
    ours = throughput(results, setting, size, quick)
    theirs = np.max(
        [rival(results, setting, mac, size, quick, back) for back in readings(setting)], axis=0
    )
    return first_from(ns(quick), ours > theirs)


def fair(results: Results, settings: tuple[Setting, ...], quick: bool) -> Claim:
    """Jain's index over one round."""
    least = min(
        float(np.mean(results[saturated(one, size, n, quick).key_of(some)]["jain_round"]))
        for some in (seeds(quick, "saturated"),)
        for one in settings
        for size in SIZES
        for n in ns(quick)
    )
    return Claim(
        "beyond",
        "it is fair within every round: Jain's index over one round above 0.99",
        f"least mean of all n = 2..100, T = 5 and 25: {least:.4f}",
        verdict(least > 0.99),
        "a round is as many turns as stations, whatever a turn carries",
    )
