"""What is counted of a declared network on the air: frames by what became of them, deliveries.

A frame counts once for every node that could hear it.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from innervate.sim.counts import Counts
from innervate.sim.own import Declared, came_of, with_messages
from innervate.sim.tables import Tables

SENT = 0
ARRIVED = 1
COLLIDED = 2
SENDING = 3
NOISY = 4
OFF = 5
BROKEN_OFF = 6
DELIVERED = 7
CUT = 8
BUSY = 9
FULL = 10
COUNTERS = 11
LOST = {"collision": COLLIDED, "sending": SENDING, "noise": NOISY, "off": OFF,
        "broken_off": BROKEN_OFF}  # fmt: skip


def tables_of(tables: Tables, plan: Any) -> dict[str, Any]:
    """What is counted, as `counters`; how much came of what users give."""
    return {"counters": tables.numbers(COUNTERS, 0, np.int64), "came": came_of(plan, tables)}


class Heard(Declared):
    """Nodes on the air whose protocol is declared."""

    def counts_of(self, kept: Any, off: tuple[int, ...], nodes: int) -> Counts:
        """Frames, one for each node that could hear it; what nodes were given and gave up.

        `kept` has the tables of `tables_of`.
        """
        found = Counts(
            nodes=nodes,
            off=off,
            sent=int(kept.counters[SENT]),
            arrived=int(kept.counters[ARRIVED]),
            lost_by=self.named(kept.counters, LOST),
            delivered=int(kept.counters[DELIVERED]),
            is_shared=True,
        )
        return with_messages(found, self.message_times, self.clock_us(), kept.came)

    def named(self, counters: Any, places: Mapping[str, int]) -> dict[str, int]:
        """Some of the counters by name."""
        return {name: int(counters[place]) for name, place in places.items()}
