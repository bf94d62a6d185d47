"""RPL at the jobs of other networks."""

from functools import partial
from typing import Any

from innervate.papers.in_field import run_declared, warm_up, world_of
from innervate.papers.jobs import Entry, Given

INPUTS: dict[bool, Any] = {False: (1, {}), True: (2, {})}


def measure(storing: int, given: Given, seed: int) -> dict[str, Any]:
    """One run in storing or non-storing mode."""
    world = world_of(given, seed)
    return run_declared("rpl", {"storing": storing, "root": world.gateway}, INPUTS, world)


WARM_UP = partial(warm_up, "rpl")
WHAT = (
    "RPL, {mode} mode, MRHOF on ETX, Imin 64 ms, Imax 16 s, k 10, four transmissions a hop, a "
    "packet that is not acknowledged is given to the next parent; no acknowledgements from end to "
    "end; an alarm is a packet to the root"
)
ENTRIES = (
    Entry("mesh", "RPL, storing", WHAT.format(mode="storing"), partial(measure, 1), WARM_UP, 0.4),
    Entry("mesh", "RPL, non-storing", WHAT.format(mode="non-storing"), partial(measure, 0), WARM_UP,
          0.5),
)  # fmt: skip
