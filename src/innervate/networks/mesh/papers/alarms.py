"""Sections 2.1 and 2.2: how soon the monitor knows of a crossing, and how far the robot got."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.alarms import all_crossings
from innervate.networks.mesh.analysis.messages import NEVER, duplicates
from innervate.networks.mesh.papers import testbed as beds
from innervate.networks.mesh.papers.document import LATENCY, MUST, Sentence, beyond, said
from innervate.networks.mesh.papers.testbed import GRAPH, LITERAL, MeshTestbed, Options
from innervate.networks.mesh.protocol.constants import ALARM, FLOOD
from innervate.networks.mesh.scenario.profiles import FAST, GOOD_CDB
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, verdict
from innervate.plot import style
from innervate.scenario.robots import position_cm
from innervate.sim.status import ON_FRAME
from innervate.topology import placement
from innervate.trace.streams import stream

TITLE = "2.1, 2.2: a robot crosses the fence"
CAPTION = (
    "A robot walks straight out of a fence of 70 m x 70 m at 1 m/s; 8 of 28 other nodes die 0.1 s "
    "before. Share of crossings that took longer; dotted: what was asked for at 1 %. Of the flood "
    "its first copy at the monitor is shown, sent beside the routed one."
)
NODES = 30
ROBOT = NODES - 1
LOW_M, HIGH_M = 15, 85  # the fence, in a square of 100 m
INSIDE_M, OUTSIDE_M = 6, 6
CROSSED_S = 8.0  # tables are there; the crossing is within a second of it
KNOWN_US = 100_000  # the dead die so long before: nobody sent anything to them since
AFTER_S = 3.0


class Scheme(NamedTuple):
    """How alarms go to the monitor."""

    name: str
    flood: str
    protocol: Options = ()


BOTH = Scheme("routed and flooded", "crossings")
ROUTED = Scheme("routed alone", "never")
GRAPH_BOTH = Scheme("graph, routed and flooded", "crossings", GRAPH)
GRAPH_ROUTED = Scheme("graph, routed alone", "never", GRAPH)
DOCUMENT = Scheme("the document's rule", "never", LITERAL)
DEAD = (0, 8)
WORST = 8
OURS = (ROUTED, BOTH, GRAPH_ROUTED, GRAPH_BOTH)
SCHEMES = (ROUTED, BOTH, GRAPH_ROUTED, GRAPH_BOTH, DOCUMENT)
MS, METRES = 70, 0.15
ALARM_BYTES = 31  # with a path of two


def walk(seed: int) -> tuple[list[list[float]], float]:
    """(a way straight out through one of the four sides, when the robot sets out)."""
    draw = stream(seed, "papers/walk")
    side = draw.draw(4)
    along = (LOW_M * 100 + draw.draw((HIGH_M - LOW_M) * 100)) / 100
    start_s = CROSSED_S - INSIDE_M + draw.draw(1_000_000) / 1e6
    low, out = side % 2 == 0, side // 2
    edge, way = (LOW_M, -1) if low else (HIGH_M, 1)
    ends = [edge - way * INSIDE_M, edge + way * OUTSIDE_M]
    return [[end, along] if out else [along, end] for end in ends], start_s


def make_testbed(scheme: Scheme, seed: int) -> MeshTestbed:
    """The network of one crossing."""
    way, start_s = walk(seed)
    square = [[LOW_M, LOW_M], [HIGH_M, LOW_M], [HIGH_M, HIGH_M], [LOW_M, HIGH_M]]
    robot = {"node": ROBOT, "waypoints": way, "speed_mps": 1.0, "start_s": start_s}
    more = (("fence", {"polygon": square, "flood": scheme.flood}), ("robot", [robot]))
    duration_s = CROSSED_S + 1 + AFTER_S
    return MeshTestbed(nodes=NODES, protocol=scheme.protocol, duration_s=duration_s, more=more)


def measure(scheme: Scheme, dead: int, seed: int) -> dict[str, Any]:
    """One crossing; the monitor is the gateway."""
    plan = make_testbed(scheme, seed).plan(seed)
    out_us = round((walk(seed)[1] + INSIDE_M) * 1e6)
    gone = beds.dying(plan, dead, (beds.GATEWAY, ROBOT))
    beds.kill(plan, gone, out_us - KNOWN_US)
    result = simulate(plan, trail=True)
    (crossing,) = all_crossings(result)
    came = crossing.accepted_us != NEVER
    flooded = _flooded(result, crossing.raised_us)
    return {
        "joined": _joined(plan, gone, out_us),
        "came": came,
        "ms": (crossing.accepted_us - crossing.raised_us) / 1e3 if came else None,
        "flood_ms": None if flooded is None else flooded / 1e3,
        "by_flood": crossing.flooded,
        "hops": crossing.hops if came else None,
        "overrun_m": crossing.overrun_m,
        "duplicates": duplicates(result),
    }


def _flooded(result: Any, since_us: int) -> int | None:
    """How long after the alarm the monitor heard its first flooded copy, us."""
    trail, sent = result.trail, result.sent
    heard = (
        (trail["node"] == beds.GATEWAY) & (trail["handler"] == ON_FRAME) & (trail["port"] == ALARM)
    )
    flood = (sent["kind"] == ALARM) & (sent["flags"] & FLOOD != 0) & (sent["origin"] == ROBOT)
    ends = sent["end"][flood & (sent["time"] >= since_us)]
    both = np.intersect1d(trail["time"][heard], ends)
    return int(both[0]) - since_us if len(both) and since_us != NEVER else None


def _joined(plan: Any, gone: list[int], at_us: int) -> bool:
    """True if good links of live nodes join the robot and the monitor where it crosses."""
    radio, count = plan.radio, plan.nodes
    (way,) = plan.walks
    x, y = position_cm(way, at_us)
    here = (round(x), round(y))
    links = [link for link in plan.good if way.node not in link]
    for node, place in enumerate(plan.positions_cm):
        if node != way.node:
            loss = placement.path_loss_cdb(placement.distance_cm(here, place), radio.exponent_c)
            there, back = way.node * count + node, node * count + way.node
            least = min(radio.base_cdb[there], radio.base_cdb[back])
            if least >= radio.rssi50_cdb + GOOD_CDB + loss:
                links.append((node, way.node))
    near = placement.neighbours(
        count, [(a, b) for a, b in links if a not in gone and b not in gone]
    )
    return bool(placement.distances(near, beds.GATEWAY)[way.node] != placement.UNREACHABLE)


def point(scheme: Scheme, dead: int, quick: bool) -> Point:
    """Crossings; a 99th percentile wants 300, and a few robots are cut off."""
    words = " ".join(f"{name}={value}" for name, value in scheme.protocol)
    what = f"crossings: {scheme.name} {words} {dead} dead"
    return Point.each(what, 0.08, 20 if quick else 400, measure, scheme, dead)


def told(got: Measured, scheme: Scheme, dead: int) -> dict[str, Any]:
    """What the crossings gave whose robot was connected to the monitor, an array a name.

    What never happened is infinite.
    """
    found = got[point(scheme, dead, got.quick)]
    joined = np.array(found["joined"])
    return {
        name: np.nan_to_num(np.array(values, float), nan=np.inf)[joined]
        for name, values in found.items()
    }


def air_ms() -> float:
    """A frame of an alarm, its turnaround and mean backoff: the least that a hop takes."""
    backoff_us = FAST.backoff_us * 7 / 2
    frame_us = (FAST.phy_bytes + ALARM_BYTES) * FAST.byte_ns / 1000
    return (backoff_us + FAST.turnaround_us + frame_us) / 1000


def points(quick: bool) -> list[Point]:
    """Every scheme without and with dead nodes."""
    return [point(scheme, k, quick) for scheme in SCHEMES for k in DEAD]


def draw(got: Measured) -> Figure:
    """Latency without and with dead nodes; overrun."""
    figure, axes = style.panels(style.WIDE_IN, 2.9, 1, 3, sharey=True)
    columns = ("a  nobody dead", 0, "ms"), ("b  8 dead", 8, "ms"), (
        f"c  overrun at 1 m/s, {WORST} dead", WORST, "overrun_m"
    )  # fmt: skip
    for ax, (title, dead, name) in zip(axes, columns, strict=True):
        for i, scheme in enumerate(SCHEMES):
            _curve(ax, told(got, scheme, dead)[name], i, scheme.name)
        if name == "ms":
            flooded = told(got, BOTH, dead)["flood_ms"]
            _curve(ax, flooded, len(SCHEMES), "flooded copies alone")
            ax.axvline(MS, color=style.INK, lw=0.8, ls=":")
            ax.set(xscale="log", xlim=(2, 4000), xlabel="from alarm to monitor (ms)")
        ax.set_title(title)
    axes[2].axvline(METRES, color=style.INK, lw=0.8, ls=":", label="asked for, 99 %")
    axes[2].set(xscale="log", xlim=(0.005, 6), xlabel="outside when the monitor knows (m)")
    axes[0].set(ylabel="crossings slower (%)", yscale="log", ylim=(0.3, 110))
    axes[0].set_yticks((1, 10, 100), ("1", "10", "100"))
    drawing.legend(figure, axes, ncols=4)
    return figure


def _curve(ax: Any, values: Any, i: int, label: str) -> None:
    """The share of values above x: its tail is what counts."""
    how = {"color": style.SERIES[i], "ls": style.DASHES[i % 4], "lw": 1}
    drawing.tail(ax, np.sort(values), label=label, **how)


def in_words(values: Any, unit: str, digits: int) -> str:
    """Median and 99th percentile of the finite values, as "1.2 / 3.4 ms"."""
    p50, p99 = np.percentile(values[np.isfinite(values)], (50, 99))
    return f"{p50:.{digits}f} / {p99:.{digits}f} {unit}"


def judge(got: Measured) -> Claims:
    """The document's two metrics; ours; what is left."""
    bar = f"99 % within {MS} ms and {METRES:g} m"
    yield _within(got, ROUTED, 0, LATENCY, f"nobody dead, frames sent up to three times and "
                  f"then another way (our bar: {bar})")  # fmt: skip
    yield _within(got, DOCUMENT, 0, LATENCY, f"nobody dead, to the letter (our bar: {bar})")
    yield _within(got, DOCUMENT, WORST, MUST, f"{WORST} unknown dead, to the letter, as an alarm "
                  f"that is repeated until it is acknowledged (our bar: all, {bar})")  # fmt: skip
    for scheme in OURS:
        claim = f"{scheme.name}: all alarms with {WORST} unknown dead, {bar}"
        yield _within(got, scheme, WORST, None, claim)
    yield _flood(got)
    yield _floor(got)


def _within(
    got: Measured, scheme: Scheme, dead: int, sentence: Sentence | None, claim: str
) -> Claim:
    """All come, and 99 % in time."""
    runs = told(got, scheme, dead)
    over, came = runs["overrun_m"], int(runs["came"].sum())
    late = np.percentile(over, 99)
    good = bool(runs["came"].all() and np.percentile(runs["ms"], 99) <= MS and late <= METRES)
    measured = (
        f"{scheme.name}, {dead} dead: {came} of {len(over)}, {in_words(runs['ms'], 'ms', 1)}, "
        f"overrun {in_words(over, 'm', 3)}"
    )
    why = "" if good else _late(runs["ms"])
    if sentence is None:
        return beyond(claim, measured, verdict(good), why)
    readings = ["A3", "A4"] if scheme is ROUTED else []
    return said(sentence, claim, measured, verdict(good, *readings), why)


def _late(ms: Any) -> str:
    """How late those are that are."""
    slow = ms[(ms > MS) & np.isfinite(ms)]
    words = f"{len(slow)} of {len(ms)} took more than {MS} ms"
    if not len(slow):
        return words
    return (
        f"{words}, half of them {np.median(slow):.0f} ms or more; an alarm that is not "
        "acknowledged is raised again with each beacon, 1 s: "
        f"{np.count_nonzero(slow >= 1000)} took so long"
    )


def _flood(got: Measured) -> Claim:
    runs = told(got, BOTH, WORST)
    first = runs["flood_ms"]
    alone = told(got, ROUTED, WORST)["ms"]
    (half, late), (half_alone, late_alone) = (
        np.percentile(ms, (50, 99)) for ms in (runs["ms"], alone)
    )
    return beyond(
        "a flood beside the routed alarm shortens the tail and costs nothing in the median",
        f"{WORST} dead, median / 99 %: {half_alone:.1f} / {late_alone:.1f} ms routed alone, "
        f"{half:.1f} / {late:.1f} ms both; flooded copies "
        f"alone {in_words(first, 'ms', 1)}, {sum(np.isfinite(first))} of {len(first)} came; the "
        f"flood won {int(runs['by_flood'].sum())} times",
        verdict(late < late_alone and half <= half_alone),
        "a flood needs no table and no ack; it goes out first, and the routed copy after it",
    )


def _floor(got: Measured) -> Claim:
    runs = told(got, BOTH, WORST)
    came = runs["came"] > 0
    hops, over = runs["hops"][came], runs["overrun_m"][came]
    each = runs["ms"][came] / hops
    sample = 0.02  # m, at 1 m/s and 50 Hz
    return beyond(
        "what is left is the air: a sample, then a frame and its backoff for every hop (1.5 times)",
        f"{np.median(each):.1f} ms a hop in the median, {hops.mean():.1f} hops, at most "
        f"{hops.max():.0f}; a frame with its turnaround and mean backoff is {air_ms():.1f} ms; of "
        f"{np.median(over):.3f} m overrun up to {sample:g} m is the time between two samples",
        verdict(np.median(each) < 1.5 * air_ms()),
        "a faster radio, more samples, or PREDICT were not run",
    )
