"""Made-up results of the radio paper's runs, and edits of them: a verdict can be asked on both
sides of its threshold. An edit is (point or curve, what it left).
"""

import copy
import functools
import re

import numpy as np
import pytest

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers import (
    capture,
    common,
    delay,
    experiment,
    fairness,
    fig1,
    fig4_5,
    fig6_7,
    fig12,
    limits,
    members,
    practice,
    quadratic,
    silent,
    ties,
)
from innervate.networks.radio.papers.common import CONTENDING, RESERVED, SIZES
from innervate.networks.radio.papers.where import PARTS
from innervate.networks.radio.protocol import constants

QUICK = True
# A little more, and a little less, than what is compared with.
UP, DOWN = 1 + 1e-6, 1 - 1e-6


@functools.cache
def curves(figure):
    """The curves of the slotted level that a figure has, by their keys."""
    seen = {}
    point = common.Curve.point
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            common.Curve, "point", lambda one: seen.setdefault(one.key, one) and point(one)
        )
        experiment(figure).points(QUICK)
    return seen


def along(curve, value):
    """A curve with value(n) at every n."""
    found = [[float(value(n))] for n in curve.ns]
    return {"throughput": found, "duration": found, "jain_round": [[1.0]] * len(found)}


@functools.cache
def exact(curve, n):
    """What the closed forms say of a curve; of those that have none, what CSMA/CD-R has."""
    size = curve.packet_slots
    letter = dict(curve.options).get("reading", "A")
    if curve.traffic == "disaster":
        return forms.reserved_duration_slots(n, size, letter)
    if curve.mac in fig4_5.ALLOWED:
        return fig4_5._closed(curve.mac, n, size)
    return forms.reserved_throughput(n, size, letter)


RUN = {
    "packets": [list(one) for one in fig1.PACKETS],
    "reports": [list(one) for one in fig1.REPORTS],
    "counts": [3, 2, 1, 0],
    "turns": {"0": 4, "1": 3, "2": 2, "3": 1},
    "roles": [0, constants.REPORTER, 0, 0],
}
MEMBERS = {"at_us": [0.0], "lost": [0.0], "left": [0.0], "extra": [0.0]}
LEVEL = {"delay": [1.0, 2.0, 3.0, 4.0], "jain_round": 1.0, "longest": 1.0}
TURNS = {"share": 1.0, "low_us": 104.0, "high_us": 104.0}
OTHERS = {"fig1 run": RUN, "fig1 chains": [[1000, 1000, 1]] * 3, "one ": MEMBERS,
          "numbers": [True, True], "turns without": TURNS, "delays ": LEVEL, "order of": {},
          "silent run": {}, "ties run": {}}  # fmt: skip


def event(key):
    """What a point of the event level left."""
    n = int(re.search(r"n=(\d+)", key).group(1))
    runs = int(key.rpartition("-")[2])
    one = {"throughput": 0.9, "duration": 10.0 * n, "jain_round": 1.0, "fifo": 1.0, "ordered": 1,
           "open": 0, "silent": 0, "completed": 10, "waits": [1, 2, 3, 4],
           "mean": 10.0, **dict.fromkeys(PARTS, 1.0)}  # fmt: skip
    return {name: [value] * runs for name, value in one.items()}


def results(figure, *edits):
    """Results of all points of a figure, where edits (point or curve, what it left) say nothing
    else.
    """
    made, known = {}, curves(figure)
    for point in experiment(figure).points(QUICK):
        head = next((head for head in OTHERS if point.key.startswith(head)), None)
        if point.key in known:
            made[point.key] = along(known[point.key], functools.partial(exact, known[point.key]))
        else:
            made[point.key] = copy.deepcopy(OTHERS[head]) if head else event(point.key)
    for what, left in edits:
        assert what.key in made, what.key
        is_part = isinstance(left, dict) and isinstance(made[what.key], dict)
        made[what.key] = made[what.key] | left if is_part else left
    return made


def changed(curve, value, *ns):
    """A curve as it is but for some n, where value(what it is) stands."""
    return (curve, along(curve, lambda n: value(exact(curve, n)) if n in ns else exact(curve, n)))


def scaled(curve, by):
    """A curve that is everywhere so many times what it is."""
    return (curve, along(curve, lambda n: by * exact(curve, n)))


def flat(curve, value):
    return (curve, along(curve, lambda _: value))


def run_with(**fields):
    (point,) = (one for one in fig1.points(QUICK) if one.key == "fig1 run")
    return [(point, fields)]


def chained(*last):
    return [(fig1.chains(QUICK), [[1000, 1000, 1], list(last)])]


# Figs. 4 and 5, 6 and 7: curves of CSMA/CD about those of CSMA/CD-R.


def s_of(mac, size):
    return fig4_5.curve(mac, size, QUICK)


def t_of(mac, size):
    return fig6_7.curve(mac, size, QUICK)


def every(curve_of, by, *ns, sizes=SIZES, macs=CONTENDING):
    """Curves of all CSMA/CD that are so many times those of CSMA/CD-R at some n."""
    return [changed(curve_of(mac, size), lambda v: by * v, *ns) for mac in macs for size in sizes]


def each_alone(curve_of, by, *ns, but, sizes=SIZES):
    """The same, with one of them that is just as CSMA/CD-R: a list for each."""
    return [
        [*every(curve_of, by, *ns, sizes=sizes), scaled(curve_of(mac, size), but)]
        for mac in CONTENDING for size in sizes
    ]  # fmt: skip


def wavy(curve, off):
    """T_D that is by turns so much more and less than on its line."""
    return [(curve, along(curve, lambda n: exact(curve, n) + off * (-1) ** n))]


# Turns on the event level.


def turned(setting, size, share=0.0, value=None, jain=1.0):
    """Saturation of the practical mode at every n: S as a share of a bound, or a value."""
    bound = practice.bound(setting, size)
    return [(point, {"throughput": [value or share * bound], "jain_round": [jain]})
            for point in practice.saturated(setting, size, QUICK)]  # fmt: skip


def near(setting, share):
    """By hand: T / (T + ta + d) with d = 78 us of 208, ta in slots, of k packets a turn k T."""
    slots = (setting.ta_us + 78) / 208

    def at(size, by):
        whole = size * setting.per_turn
        return turned(setting, size, value=by * share * whole / (whole + slots))

    within = at(5, UP) + at(25, UP)
    return within, [at(5, DOWN) + at(25, UP), at(5, UP) + at(25, DOWN)]


def lasted(setting, size, duration):
    """Disasters of the practical mode: T_D over n."""
    points = practice.disasters(setting, size, QUICK)
    return [(point, {"duration": [float(duration(n))]})
            for point, n in zip(points, practice.ns(QUICK), strict=True)]  # fmt: skip


@functools.cache
def bent(fit):
    """The power of n that a straight line fits so well (R^2), by the correlation."""
    low, high = 1.0, 3.0
    for _ in range(60):
        power = (low + high) / 2
        n = np.array(practice.ns(QUICK), float)
        low, high = (power, high) if np.corrcoef(n, n**power)[0, 1] ** 2 > fit else (low, power)
    return low


def linear(setting):
    def both(five, long):
        return (lasted(setting, 5, lambda n: n ** bent(five))
                + lasted(setting, 25, lambda n: n ** bent(long)))  # fmt: skip

    return both(0.9901, 0.9901), [both(0.9899, 0.9999), both(0.9999, 0.9899)]


def complete(setting):
    points = [*practice.disasters(setting, 5, QUICK), *practice.saturated(setting, 25, QUICK)]
    return [], [[(point, {name: [0, 1]})] for point in (points[0], points[-1])
                for name in ("open", "silent")]  # fmt: skip


def fair(setting):
    return (turned(setting, 5, 1, jain=0.9901),
            [turned(setting, size, 1, jain=0.99) for size in SIZES])  # fmt: skip


def against(setting, mac, size, value, back=0, traffic="saturated"):
    """CSMA/CD with either backoff, value(n) at every n."""
    return [(curve, along(curve, value))
            for curve in practice.rivals(setting, mac, size, traffic, QUICK)[back]]  # fmt: skip


def beside(setting, high=0.9, five=5, long=2, drawn=2, back=0):
    """S of 0.9, and D2 of 0.9 or more below n = five (T = 5), long (T = 25); D2' below drawn."""
    made = [*turned(setting, 5, value=high), *turned(setting, 25, value=high)]
    for mac, size, first in (("csma-cd-d2", 5, five), ("csma-cd-d2", 25, long),
                             ("csma-cd-d2p", 5, drawn), ("csma-cd-d2p", 25, 2)):  # fmt: skip
        made += against(setting, mac, size, lambda n, first=first: 0.9 if n < first else 0.89, back)
    return made


def over_slotted(setting, size, by):
    points = practice.saturated(setting, size, QUICK)
    return [(point, {"throughput": [by * forms.reserved_throughput(n, size)]})
            for point, n in zip(points, practice.ns(QUICK), strict=True)]  # fmt: skip


def quick_few(setting, size, theirs):
    """T_D of 100 slots a station; of D2 what `theirs` says of n."""
    rivals = against(setting, "csma-cd-d2", size, theirs, traffic="disaster")
    return [*lasted(setting, size, lambda n: 100 * n), *rivals]


def waiting(ours, n, load, rivals, turns, size=None):
    """Mean delays of the practical mode, its rivals at 10 slots."""
    made = []
    rivals = (*rivals, delay.DCF_ANSWERS, delay.DCF_HERE) if "dcf" in rivals else rivals
    for mac, per_turn in (("practical", turns), *((mac, turns if mac == "token-ring" else 1)
                                                  for mac in rivals)):  # fmt: skip
        for one in SIZES:
            mean = (ours if size in (None, one) else 9.0) if mac == "practical" else 10.0
            point = delay.point((mac, per_turn), one, n, load, QUICK)
            made.append((point, {"mean": [mean, mean]}))
    return made


def rival(mac, n, load, turns, at):
    """One of the rivals waits less than we do."""
    point = delay.point((mac, 1 if mac in ("dcf", "tdma") else turns), 25, n, load, QUICK)
    return [(point, {"mean": [at, at]})]


def below(words, n, load, rivals, turns):
    inside = waiting(9.999, n, load, rivals, turns)
    outside = [waiting(10.0, n, load, rivals, turns, size) for size in SIZES]
    outside += [inside + rival(mac, n, load, turns, 9.9) for mac in rivals]
    return ("delay", words, inside, outside)


def similar(reading, by, longer):
    """S and T_D of a reading, as parts of those of the simulation."""
    made = []
    for traffic, part in zip(fig12.TRAFFIC, (by, longer), strict=True):
        plain = fig12.curve(RESERVED, fig12.SIMULATED, traffic, QUICK)
        curve = fig12.curve(RESERVED, reading, traffic, QUICK)
        made.append((curve, along(curve, lambda n, p=plain, part=part: part * exact(p, n))))
    return made


def ahead(*alike):
    """D2' a little below CSMA/CD-R at five robots, and in some readings just as good."""
    made = []
    for reading in fig12.READINGS:
        ours = fig12.curve(RESERVED, reading, "saturated", QUICK)
        theirs = fig12.curve("csma-cd-d2p", reading, "saturated", QUICK)
        made += [flat(ours, 0.5), flat(theirs, 0.5 if reading.name in alike else 0.499)]
    return made


def put_in_order(rules, n, count):
    return (ties.within(rules, n, QUICK), {"ordered": [1] * count + [0] * (ties.SEEDS - count)})


def helped(two, short, ten, stretched):
    points = ties.variants(QUICK)
    return [(point, {"throughput": [value]})
            for point, value in zip(points, (two, short, ten, stretched), strict=True)]  # fmt: skip


def lost(mode, n, ta, count):
    point = silent.point(mode, n, ta, QUICK)
    runs = len(event(point.key)["silent"])
    return (point, {"silent": [count] + [0] * (runs - 1)})


def moved(case, **fields):
    return [(members.moving(*case, QUICK), {name: [value] for name, value in fields.items()})]


def settled(size, a, b):
    """S of both readings at n = 1000, and well above what is rounded to it before."""
    return [changed(limits.curve(letter, size), lambda _, v=v: v, 1000)
            for letter, v in (("A", a), ("B", b))]  # fmt: skip


def levels(size, at_30, at_100):
    curve = limits.curve("A", size)
    return [(curve, along(curve, lambda n: {30: at_30, 100: at_100}.get(n, exact(curve, n))))]


def reaches(letter, size, first):
    curve, least = limits.curve(letter, size), limits.REACHED[size]
    return (curve, along(curve, lambda n: least if n >= first else least - 0.01))


def all_reach(*late):
    return [reaches(letter, size, 101 if (letter, size) in late else 100)
            for letter in "AB" for size in SIZES]  # fmt: skip


def grows(power, *names, size=25):
    return [(curve, along(curve, lambda n: n**power))
            for curve in (quadratic.curve(name, size, QUICK) for name in names)]  # fmt: skip


DOUBLING = [name for name in quadratic.VARIANTS if name.endswith("doubling")]
AS_N = [
    edit for name in quadratic.VARIANTS for size in SIZES for edit in grows(1.0, name, size=size)
]


def captured(size, whole, drawn, *but):
    """S of D2 and D2' where it is looked at: so many times that of CSMA/CD-R."""
    d2, d2p = (capture.curve(mac, size, QUICK) for mac in capture.STRIPS[:2])
    return [scaled(d2, whole), scaled(d2p, drawn), *but]


def just_as_ours(size, n):
    d2p = capture.curve("csma-cd-d2p", size, QUICK)
    return (d2p, along(d2p, lambda m: exact(d2p, m) * (1 if m == n else UP)))


def once_a_round(size, jain, n=5):
    curve = capture.curve(RESERVED, size, QUICK)
    return [(curve, {"jain_round": [[jain if m == n else 1.0] for m in curve.ns]})]


CONTEND = {mac: fairness.level(mac, None, QUICK) for mac in CONTENDING}
OURS = fairness.level(RESERVED, None, QUICK)


def served(mode, load, **fields):
    return (fairness.event(mode, load, QUICK), {name: [value] for name, value in fields.items()})


def tails(ours, practical_, theirs):
    """The longest waits: of CSMA/CD-R, of the practical mode, of each CSMA/CD."""
    return [(OURS, {"delay": [1, 2, 3, ours]}), served("practical", 0, waits=[1, 2, 3, practical_]),
            *((point, {"delay": [1, 2, 3, longest]})
              for point, longest in zip(CONTEND.values(), theirs, strict=True))]  # fmt: skip
