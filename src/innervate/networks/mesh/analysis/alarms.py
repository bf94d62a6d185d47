"""Crossings of a mesh's fence: who noticed, when the monitor knew, how far the robot got.

Whether a robot is outside is judged by where it is, not by where it believes to be. An alarm is of
a crossing if it stood while the robot was outside, though it was raised before; else it is false.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from innervate.analysis.percentiles import usual
from innervate.networks.mesh.analysis.fence import Edge, crossings, edges_of, margin_cm, overrun_cm
from innervate.networks.mesh.analysis.messages import NEVER, timeout_us
from innervate.networks.mesh.analysis.said import Said, said
from innervate.networks.mesh.analysis.summary_keys import Alarms
from innervate.networks.mesh.protocol.constants import ALARM, CROSS, FLOOD, PREDICT, REPORT_ALARM
from innervate.scenario.robots import position_cm

# A place is rounded along each axis, by half a cm and by half a unit: at most so far away.
ROUNDED_UNITS = 2**0.5

# End of the stay before, from when this one can be seen, out and back, from when the next can be.
Spans = tuple[int, int, tuple[int, int], int]


class Crossing(NamedTuple):
    """A robot leaves the fence."""

    robot: int  # its node
    crossed_us: int  # when it truly did; 0 if it begins outside
    back_us: int  # when it came back inside; the run's end if it did not
    # the sample at which somebody raised the alarm, NEVER if nobody did; with its place
    # rounded, or wrong, a robot can be outside before it truly is
    raised_us: int
    raised_by: int  # who that was: the robot, or a witness of its beacon
    accepted_us: int  # when the monitor's user had the first alarm of it, NEVER if it did not
    row: int  # that delivery, in `result.delivered`; NEVER
    flooded: bool  # it came by the flood, not by the routed copy
    hops: int  # transmissions on its way
    warned_us: int  # when the monitor had been told that the robot was about to cross, NEVER
    # greatest distance outside until the alarm was accepted, else until the robot was back or
    # the run ended
    overrun_m: float
    open: bool  # not accepted, but too shortly before the run's end to say that it was lost


class FalseAlarm(NamedTuple):
    """A robot is said to be outside, and is inside all the time."""

    robot: int  # its node
    raised_us: int
    raised_by: int  # who that was: the robot, or a witness of its beacon
    until_us: int  # when it was taken back; the run's end if it was not
    accepted_us: int  # when the monitor's user had it, NEVER if it did not
    inside_m: float  # how far from the fence the robot was when it was raised


class Judged(NamedTuple):
    """All alarms of a run held against where the robots were, in order of time."""

    crossings: list[Crossing]
    false: list[FalseAlarm]


def all_crossings(result: Any) -> list[Crossing]:
    """Every crossing of a run, in order of time; none without a fence."""
    return judged(result).crossings


def judged(result: Any) -> Judged:
    """Every crossing of a run, and every alarm that is of none; none without a fence."""
    plan = result.plan
    found: list[Crossing] = []
    false: list[FalseAlarm] = []
    edges = edges_of(plan)
    if not edges:
        return Judged([], [])
    rows = result.rows[result.rows["code"] == REPORT_ALARM]
    alarms = np.flatnonzero(result.delivered["kind"] == ALARM)
    for walk in plan.walks:
        told = alarms[result.delivered["body0"][alarms] == walk.node]
        raised = rows[(rows["b"] == walk.node) & (rows["a"] == CROSS)]
        stood = said(result, walk.node)
        stays = _stays(plan, edges, walk, result.ended_us, stood)
        befores = [0, *(back_us for _, back_us in stays)]
        windows = _windows(plan, edges, walk, stays, stood, result.ended_us)
        for before, (since, until), stay in zip(befores, windows, stays, strict=False):
            spans = (before, since, stay, until)
            found.append(_crossing(result, edges, walk, spans, raised, told))
        false += _false(result, edges, walk, list(zip(windows, stays, strict=True)), stood, told)
    return Judged(sorted(found, key=lambda one: (one.crossed_us, one.robot)),
                  sorted(false, key=lambda one: (one.raised_us, one.robot)))  # fmt: skip


def _stays(
    plan: Any, edges: list[Edge], walk: Any, until_us: int, stood: list[Said]
) -> list[tuple[int, int]]:
    """(out, back) of every stay outside; what is out again before it was well inside is one stay.

    The protocol calls a robot inside again from `clear_margin` on, so only then it can cross anew.
    One that errs may be well inside and not know it: then the alarm stands, and it is one stay.
    Who begins outside is so from time 0 on, for which it raises the alarm, too.
    """
    outside = margin_cm(edges, position_cm(walk, 0)) < 0
    found: list[tuple[int, int]] = [(0, until_us)] if outside else []
    clear_cm = plan.params["clear_margin"] * plan.params["unit_cm"]
    for crossing in crossings(edges, walk, until_us):
        at = round(crossing.time_us)
        if not crossing.outward:
            if found:
                found[-1] = (found[-1][0], at)
        elif found and not (
            _well_inside(plan, edges, walk, found[-1][1], at, clear_cm)
            and not (walk.noise_um and _stands(stood, found[-1][1], at))
        ):
            found[-1] = (found[-1][0], until_us)
        else:
            found.append((at, until_us))
    return found


def _well_inside(
    plan: Any, edges: list[Edge], walk: Any, since_us: int, until_us: int, clear_cm: float
) -> bool:
    """True if at some sample in between the robot was inside by more than so much."""
    return any(
        margin_cm(edges, position_cm(walk, at)) > clear_cm
        for at in range(since_us, until_us, plan.sample_us)
    )


def _stands(stood: list[Said], since_us: int, until_us: int) -> bool:
    """True if an alarm stood all the time."""
    return any(one.raised_us <= since_us and one.until_us >= until_us for one in stood)


def _windows(
    plan: Any, edges: list[Edge], walk: Any, stays: list[tuple[int, int]], stood: list[Said],
    ended_us: int,
) -> list[tuple[int, int]]:  # fmt: skip
    """From when to when alarms are of each stay.

    Of a robot that errs, from the first that stood while it was outside to the next that did not.
    """
    if not walk.noise_um:
        befores = [0, *(back_us for _, back_us in stays)]
        seen = [_seen_from(plan, edges, walk, before, out_us)
                for before, (out_us, _) in zip(befores, stays, strict=False)]  # fmt: skip
        return list(pairwise([*seen, ended_us]))
    found = []
    for out_us, back_us in stays:
        its = [one for one in stood if one.raised_us <= back_us and one.until_us > out_us]
        later = [one.raised_us for one in stood if one.raised_us > back_us]
        found.append((its[0].raised_us, min([*later, ended_us])) if its else (out_us, out_us))
    return found


def _false(
    result: Any, edges: list[Edge], walk: Any,
    stays: list[tuple[tuple[int, int], tuple[int, int]]], stood: list[Said], told: Any,
) -> list[FalseAlarm]:  # fmt: skip
    """Alarms that are of no stay outside; `stays` with the windows of their alarms."""
    rows, found = result.delivered, []
    crossed = told[rows["body3"][told] == CROSS]
    nexts = [*(one.raised_us for one in stood[1:]), result.ended_us]
    for one, until in zip(stood, nexts, strict=False):
        if any(one.raised_us <= back_us and (one.until_us > out_us or one.raised_us >= since)
               for (since, _), (out_us, back_us) in stays):  # fmt: skip
            continue
        times = rows["time"][crossed]
        came = times[(times >= one.raised_us) & (times < until)][:1]
        inside_cm = margin_cm(edges, position_cm(walk, one.raised_us))
        accepted = int(came[0]) if len(came) else NEVER
        found.append(FalseAlarm(*one, accepted, inside_cm / 100))
    return found


def _crossing(
    result: Any, edges: list[Edge], walk: Any, spans: Spans, raised: Any, told: Any
) -> Crossing:
    """One crossing, and what was raised and told of it."""
    before, from_us, (out_us, back_us), until = spans
    first = raised[(raised["time"] >= from_us) & (raised["time"] < until)][:1]
    rows = result.delivered
    times, kinds = rows["time"][told], rows["body3"][told]
    came = told[(kinds == CROSS) & (times >= from_us) & (times < until)][:1]
    warned = told[(kinds == PREDICT) & (times >= before) & (times < out_us)][-1:]
    accepted = int(rows["time"][came[0]]) if len(came) else NEVER
    known = accepted if len(came) else min(back_us, result.ended_us)
    return Crossing(
        robot=walk.node,
        crossed_us=out_us,
        back_us=back_us,
        raised_us=int(first["time"][0]) if len(first) else NEVER,
        raised_by=int(first["node"][0]) if len(first) else NEVER,
        accepted_us=accepted,
        row=int(came[0]) if len(came) else NEVER,
        flooded=bool(len(came) and rows["flags"][came[0]] & FLOOD),
        hops=int(rows["path_len"][came[0]]) if len(came) else NEVER,
        warned_us=int(rows["time"][warned[0]]) if len(warned) else NEVER,
        overrun_m=overrun_cm(edges, walk, out_us, known) / 100,
        open=not len(came) and out_us + timeout_us(result.plan) > result.ended_us,
    )


def _seen_from(plan: Any, edges: list[Edge], walk: Any, before_us: int, out_us: int) -> int:
    """From when on a robot can have seen itself outside, since it knows its place rounded.

    That is at most one sample before the first of those, without a gap before the crossing, at
    which it was as near to the fence as its place may be wrong.
    """
    wrong_cm = ROUNDED_UNITS * plan.params["unit_cm"]
    at = out_us
    while at > before_us and margin_cm(edges, position_cm(walk, at)) <= wrong_cm:
        at -= plan.sample_us
    return max(at, before_us)


def robot_hours(result: Any) -> float:
    """How long all robots together were in the run."""
    return float(len(result.plan.walks) * result.ended_us / 3.6e9)


def alarms(found: list[Crossing], false: Sequence[FalseAlarm] = (), hours: float = 0.0) -> Alarms:
    """The summary's part on alarms; a crossing that nobody noticed counts as not delivered.

    `hours` are those of all robots together, 0 if there is none.
    """
    decided = [crossing for crossing in found if not crossing.open]
    came = [crossing for crossing in decided if crossing.accepted_us != NEVER]
    warned = [c for c in decided if c.warned_us != NEVER]
    # One that was accepted was raised: nothing else makes a packet of it.
    waited = [c.accepted_us - c.raised_us for c in came if c.raised_us != NEVER]
    return {
        "sent": len(decided),
        "delivered": len(came),
        "latency_ms": usual(waited, 1e-3),
        "overrun_m": usual([crossing.overrun_m for crossing in decided]),
        "noticed": sum(crossing.raised_us != NEVER for crossing in decided),
        "by_witness": sum(c.raised_by not in (NEVER, c.robot) for c in decided),
        "by_flood": sum(crossing.flooded for crossing in came),
        "warned": len(warned),
        "warning_ms": usual([c.crossed_us - c.warned_us for c in warned], 1e-3),
        "after_ms": usual([c.accepted_us - c.crossed_us for c in came], 1e-3),
        "false": len(false),
        "false_delivered": sum(one.accepted_us != NEVER for one in false),
        "false_per_hour": len(false) / hours if hours else None,
    }
