"""What a mesh says of its robots, true or not: alarms that stand until they are taken back."""

from bisect import bisect_left
from typing import Any, NamedTuple

from innervate.networks.mesh.analysis.messages import took_effect
from innervate.networks.mesh.protocol.constants import CLEAR, CROSS, REPORT_ALARM
from innervate.scenario.actions.field import KILL, RESTART


class Said(NamedTuple):
    """A robot is said to be outside."""

    robot: int  # its node
    raised_us: int  # the first CROSS
    raised_by: int  # who that was: the robot, or a witness of its beacon
    until_us: int  # its CLEAR, or its death; the run's end if there was neither


def said(result: Any, robot: int) -> list[Said]:
    """All that a robot was said to be outside, in order of time.

    It raises CROSS again while nobody acknowledges it, and so do witnesses: these are one. A robot
    that dies or restarts forgets that it is outside, and raises CROSS anew.
    """
    rows = result.rows[(result.rows["code"] == REPORT_ALARM) & (result.rows["b"] == robot)]
    forgets = [fault.at_us for fault in took_effect(result.plan, result.ended_us)
               if fault.node == robot and fault.action in (KILL, RESTART)]  # fmt: skip
    own_clear = (rows["a"] == CLEAR) & (rows["node"] == robot)
    ends = sorted([*forgets, *rows["time"][own_clear].tolist()])
    found: list[Said] = []
    for time, node in rows[rows["a"] == CROSS][["time", "node"]].tolist():
        if not found or time >= found[-1].until_us:
            after = bisect_left(ends, time)
            until = ends[after] if after < len(ends) else result.ended_us
            found.append(Said(robot, time, node, until))
    return found
