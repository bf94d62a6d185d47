"""Managed flooding at the jobs of other networks."""

from functools import partial
from typing import Any

from innervate.papers.in_field import run_declared, warm_up, world_of
from innervate.papers.jobs import Entry, Given

EVERYBODY = 255
INPUTS = {False: (1, {}), True: (1, {"dest": EVERYBODY})}  # an alarm is for all


def measure(given: Given, seed: int) -> dict[str, Any]:
    """One run, with the hop limit that a world of this size needs."""
    return run_declared("flooding", {"hops": 7}, INPUTS, world_of(given, seed))


def measure_three(given: Given, seed: int) -> dict[str, Any]:
    """One run with the hop limit that is set if nobody sets one."""
    return run_declared("flooding", {"hops": 3}, INPUTS, world_of(given, seed))


WARM_UP = partial(warm_up, "flooding")
ENTRIES = (
    Entry("mesh", "flooding, 7 hops",
          "managed flooding as Meshtastic's, hop limit 7, direct messages and alarms acknowledged "
          "and sent again up to three times; an alarm is a broadcast", measure, WARM_UP, 0.4),
    Entry("mesh", "flooding, 3 hops", "the same with the usual hop limit", measure_three, WARM_UP,
          0.3),
)  # fmt: skip
