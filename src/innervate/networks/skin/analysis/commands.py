"""What became of the PC's commands: whom they were for, whom they reached, how long it took."""

from typing import Any

import numpy as np

from innervate.networks.skin.analysis.frames import number_of, traffic_of, under_way
from innervate.networks.skin.analysis.latency import command_latency_ms
from innervate.networks.skin.analysis.summary_keys import Commands
from innervate.networks.skin.sim import counters as words
from innervate.networks.skin.sim import orders

# Why a cell that a command was for did not get it, by its state when the command was given.
REASONS = {"off": orders.WAS_OFF, "no_route": orders.HAD_NO_WAY, "on_the_way": orders.HAD_A_WAY}


def commands_summary(result: Any) -> Commands:
    """Commands from the PC down to the cells."""
    counters = result.counters
    missed, in_flight = _open(result.world, result.plan.graph.cells)
    lost_by = {
        name: counters[words.MISSED + state - orders.WAS_OFF] + missed[state]
        for name, state in REASONS.items()
    }
    addressed, lost = counters[words.ADDRESSED], sum(lost_by.values())
    traffic = traffic_of(result, "commands")
    return {
        "sent": counters[words.GIVEN],
        "addressed": addressed,
        "delivered": counters[words.REACHED],
        "lost": lost,
        "loss_ratio": lost / addressed if addressed else None,
        "lost_by": lost_by,
        "in_flight": in_flight,
        "repeated": counters[words.REPEATED],
        "latency_ms": command_latency_ms(result),
        "frames": {
            "sent": traffic.sent,
            "lost_by": traffic.lost,
            "duplicates": counters[words.AGAIN],
            "too_far": counters[words.TOO_FAR],
        },
    }


def missed_on_the_way(world: Any, cells: int) -> int:
    """How often, so far, a command did not reach a cell that had a way as it was given."""
    if not world.counters[words.GIVEN]:
        return 0
    still, _ = _open(world, cells)
    settled = world.counters[words.MISSED + orders.HAD_A_WAY - orders.WAS_OFF]
    return int(settled) + still[orders.HAD_A_WAY]


def _open(world: Any, cells: int) -> tuple[dict[int, int], int]:
    """Of the last commands: how many cells did not get one, by state; for how many it flies."""
    missed = dict.fromkeys(REASONS.values(), 0)
    in_flight = 0
    flying = {number_of(frame, "sq") for frame in under_way(world)}
    due = np.array(world.watch.due, np.int64)
    for slot, number in enumerate(int(number) for number in world.watch.due_number):
        if number < 0:
            continue
        states = due[slot * cells : (slot + 1) * cells]
        counts = {state: int(np.count_nonzero(states == state)) for state in missed}
        if number in flying:
            in_flight += counts.pop(orders.HAD_A_WAY) + counts.pop(orders.HAD_NO_WAY)
        for state, count in counts.items():
            missed[state] += count
    return missed, in_flight
