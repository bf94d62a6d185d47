"""Figs. 6 and 7: how long a disaster takes, T_D over n, T = 5 and 25; all protocols beside it."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers import common
from innervate.networks.radio.papers.common import RESERVED, SIZES, Curve
from innervate.papers.experiment import Claim, Claims, Measured, Point, verdict
from innervate.papers.words import joined
from innervate.plot import style

TITLE = "Figs. 6, 7: total duration of a disaster"
CAPTION = (
    "Slotted level: all stations have one packet at time 0. Means; bands: 5 to 95 % of the runs. "
    "Above: all protocols, both axes logarithmic; below: the same at small n."
)
CROSSING = (*range(2, 16), 20, 30, 50, 70, 100)


def curve(mac: str, size: int, quick: bool) -> Curve:
    """T_D over n of one protocol."""
    if mac == common.READING_B:
        return Curve(RESERVED, size, "disaster", common.WHOLE, 1, options=(("reading", "B"),))
    if mac == RESERVED:
        return Curve(mac, size, "disaster", common.WHOLE, 1)
    if mac in common.CONTENDING:
        ns, seeds = (CROSSING, 400) if quick else (common.WHOLE, 500)
        return Curve(mac, size, "disaster", ns, seeds)
    return Curve(mac, size, "disaster", common.FEW if quick else common.WHOLE, 30 if quick else 60)


def points(quick: bool) -> list[Point]:
    """All protocols at both packet lengths."""
    return [curve(mac, size, quick).point() for size in SIZES for mac in common.EVERYBODY]


def draw(got: Measured) -> Figure:
    """Above all protocols, logarithmic; below small n, T_D a station."""
    figure, axes = style.panels(style.WIDE_IN, 5.4, 2, 2, height_ratios=(1.25, 1))
    macs = ("tdma", *reversed(common.PEERS[:-1]), *reversed(common.CONTENDING),
            common.READING_B, RESERVED)  # fmt: skip
    for above, below, number, size in zip(axes[:2], axes[2:], (6, 7), SIZES, strict=True):
        common.stations_axis(above)
        above.set(yscale="log", xlim=(1.9, 105), title=f"Fig. {number}  T = {size}")
        common.everybody(above, got, {mac: curve(mac, size, got.quick) for mac in macs})
        _few(below, got, size)
        below.set_title(f"small n, T = {size}")
    axes[0].set_ylabel("total duration $T_D$ (slots)")
    axes[2].set_ylabel("$T_D$ (slots)")
    return figure


def _few(ax: Axes, got: Measured, size: int) -> None:
    for mac in (*reversed(common.CONTENDING), RESERVED):
        one = curve(mac, size, got.quick)
        common.line(ax, common.LOOKS[mac], one.ns[:9], one.mean(got)[:9], marks=range(2, 11))
        if mac in common.CONTENDING:
            common.band(ax, common.LOOKS[mac], one.ns[:9], one.all(got)[:9])
    ax.set(ylim=(0, None), xticks=range(2, 11), xlabel="stations n")
    ax.legend(loc="upper left")


def judge(got: Measured) -> Claims:
    """Linear; small n; large n; where they cross."""
    for size in SIZES:
        rise, start, fit = common.slope(common.WHOLE, curve(RESERVED, size, got.quick).mean(got))
        yield Claim(
            str(SIZES.index(size) + 6),
            f"T = {size}: T_D in CSMA/CD-R is proportional to n linearly",
            f"T_D = {start:.0f} + {rise:.3f} n slots, R^2 = {fit:.6f}, n = 2..100",
            verdict(fit > 0.999999, "Q1", "Q3"),
            "linear, not proportional: the collision and the window come first",
        )
    yield _small(got)
    for size in SIZES:
        yield _crossing(got, size)
    gains = {}
    for size in SIZES:
        ours = forms.reserved_duration_slots(100, size)
        theirs = [curve(mac, size, got.quick).mean(got)[-1] for mac in common.CONTENDING]
        gains[size] = [duration / ours for duration in theirs]
    words = (f"T = {s}: " + joined(f"{gain:.2f}" for gain in some) for s, some in gains.items())
    yield Claim(
        "6, 7",
        "CSMA/CD's duration increases abruptly as the number of collisions increases",
        f"n = 100, T_D of D1, D2, D2' over that of CSMA/CD-R: {joined(words, '; ')}",
        verdict(min(map(min, gains.values())) > 1, "Q14"),
        "faster than linear, but no square of n: see there (Q15)",
    )


def _small(got: Measured) -> Claim:
    words, shorter = [], True
    for size in SIZES:
        one = curve("csma-cd-d1", size, got.quick)
        for n in (2, 3):
            ours = forms.reserved_duration_slots(n, size)
            value = float(one.mean(got)[one.ns.index(n)])
            shorter = shorter and value < ours
            words.append(f"T = {size}, n = {n}: {value:.1f} against {ours}")
    pairs = (
        f"{forms.pair_duration_slots(size, size + 1):.1f} against "
        f"{forms.reserved_duration_slots(2, size)} (T = {size})"
        for size in SIZES
    )
    return Claim(
        "6, 7",
        "When a small number of nodes collides, T_D in CSMA/CD is relatively small",
        f"slots, D1 against CSMA/CD-R, {joined(words, '; ')}",
        verdict(shorter, "Q14"),
        f"D2, whose collisions cost a packet, is shorter at n = 2 only: {joined(pairs)}",
    )


def _crossing(got: Measured, size: int) -> Claim:
    curves = [curve(mac, size, got.quick) for mac in common.CONTENDING]
    slots = forms.reserved_duration_slots
    words, is_so = common.overtaken(got, curves, lambda n, t: slots(n, size) < t)
    return Claim(
        str(SIZES.index(size) + 6),
        f"T = {size}: CSMA/CD-R is superior as the number of collisions increases",
        f"T_D of CSMA/CD-R is shorter than of {words}",
        is_so,
        "D2' only adds backoffs after the own packet: it differs from D2 by chance alone",
    )
