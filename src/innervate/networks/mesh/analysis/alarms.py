"""Crossings of a mesh's fence: who noticed, when the monitor knew, how far the robot got."""

from typing import Any, NamedTuple

import numpy as np

from innervate.analysis.percentiles import usual
from innervate.networks.mesh.analysis.fence import Edge, crossings, edges_of, margin_cm, overrun_cm
from innervate.networks.mesh.analysis.messages import NEVER, timeout_us
from innervate.networks.mesh.analysis.summary_keys import Alarms
from innervate.networks.mesh.protocol.constants import ALARM, CROSS, FLOOD, PREDICT, REPORT_ALARM
from innervate.networks.mesh.scenario.plan import position_cm

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
    # rounded a robot can be outside just before it truly is
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


def all_crossings(result: Any) -> list[Crossing]:
    """Every crossing of a run, in order of time; none without a fence."""
    plan = result.plan
    edges = edges_of(plan)
    if not edges:
        return []
    rows = result.rows[result.rows["code"] == REPORT_ALARM]
    alarms = np.flatnonzero(result.delivered["kind"] == ALARM)
    found = []
    for walk in plan.walks:
        told = alarms[result.delivered["body0"][alarms] == walk.node]
        raised = rows[(rows["b"] == walk.node) & (rows["a"] == CROSS)]
        episodes = _episodes(plan, edges, walk, result.ended_us)
        befores = [0, *(back_us for _, back_us in episodes)]
        seen = [_seen_from(plan, edges, walk, before, out_us)
                for before, (out_us, _) in zip(befores, episodes, strict=False)]  # fmt: skip
        untils = [*seen[1:], result.ended_us]
        for spans in zip(befores, seen, episodes, untils, strict=False):
            found.append(_crossing(result, edges, walk, spans, raised, told))
    return sorted(found, key=lambda crossing: (crossing.crossed_us, crossing.robot))


def _episodes(plan: Any, edges: list[Edge], walk: Any, until_us: int) -> list[tuple[int, int]]:
    """(out, back) of every stay outside; what is out again before it was well inside is one stay.

    The protocol calls a robot inside again from `clear_margin` on, so only then it can cross anew.
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
        elif found and not _well_inside(plan, edges, walk, found[-1][1], at, clear_cm):
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


def alarms(found: list[Crossing]) -> Alarms:
    """The summary's part on alarms; a crossing that nobody noticed counts as not delivered."""
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
    }
