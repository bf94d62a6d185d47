"""Managed flooding at the jobs of other networks."""

from functools import partial
from typing import Any

from innervate.papers.in_field import run_declared, warm_up, world_of
from innervate.papers.jobs import Entry, Given

EVERYBODY = 255
INPUTS = {False: (1, {}), True: (1, {"dest": EVERYBODY})}  # an alarm is for all


def measure(hops: int, given: Given, seed: int) -> dict[str, Any]:
    """One run with a hop limit."""
    return run_declared("flooding", {"hops": hops}, INPUTS, world_of(given, seed))


WARM_UP = partial(warm_up, "flooding")
ENTRIES = (
    Entry("mesh", "flooding, 7 hops",
          "managed flooding as Meshtastic's, hop limit 7, direct messages and alarms acknowledged "
          "and sent again up to three times; an alarm is a broadcast", partial(measure, 7), WARM_UP,
          0.4),
    Entry("mesh", "flooding, 3 hops", "the same with the usual hop limit", partial(measure, 3),
          WARM_UP, 0.3),
)  # fmt: skip
