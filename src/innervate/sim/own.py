"""What a network says itself, of a run on any medium: its invariants, and what messages are."""

from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from innervate.folders import invariants_of
from innervate.network import networks
from innervate.scenario.cables import Happening
from innervate.sim.came import Came
from innervate.sim.counts import Counts
from innervate.sim.tables import Tables

OWN_BROKEN = 64  # `run.broken` of the first of them; below it are those of the media


def check_of(own: Iterable[Callable[..., Any]], states: str) -> Callable[..., None]:
    """`check_own(world, node, now)`: the first of a network's `node_...` that does not hold.

    Args:
        own: its functions.
        states: the table of the world that has its nodes' records.
    """
    names = {f"holds_{place}": holds for place, holds in enumerate(own)}
    lines = [
        line for place, name in enumerate(names)
        for line in (f"    if run.checks and run.broken == 0 and not {name}(state, params, now):",
                     f"        run.broken = {OWN_BROKEN + place}",
                     "        run.broken_node = node")
    ]  # fmt: skip
    text = "\n".join([
        "def check_own(world, node, now):", "    run = world.run[0]",
        f"    state = world.{states}[node]", "    params = world.params[0]", *lines,
    ])  # fmt: skip
    made: dict[str, Any] = dict(names)
    exec(compile(text, "invariants of a protocol", "exec"), made)
    check: Callable[..., None] = made["check_own"]
    return check


def message_times(plan: Any) -> list[int]:
    """When users give what is to be delivered, us: inputs of the kinds `MESSAGES`, or of all."""
    kinds = getattr(networks()[plan.kind].fields, "MESSAGES", None)
    given = [one for one in plan.inputs if not isinstance(one, Happening)]
    return sorted(one.at_us for one in given if kinds is None or one.kind in kinds)


def came_of(plan: Any, tables: Tables) -> Came:
    """Nothing of what users give has been delivered yet."""
    moments = sorted({one.at_us for one in plan.inputs})
    return Came(tables.given(moments, np.int64), tables.numbers(len(moments), 0, np.int64))


def with_messages(counts: Counts, given_us: Sequence[int], now_us: int, came: Came) -> Counts:
    """Counts with what users gave, and of how much of that at least nobody got anything.

    Args:
        counts: the others; what was delivered is among them.
        given_us: when each message was given, in order of time.
        now_us: the time until which they count.
        came: what was delivered of those of which it is known when they were given.
    """
    given = Counter(given_us[: bisect_right(given_us, now_us)])
    known = {int(at_us): int(many) for at_us, many in zip(came.moments, came.counts, strict=True)}
    missing = sum(max(many - known.get(at_us, 0), 0) for at_us, many in given.items())
    unknown = counts.delivered - sum(known.values())
    return counts._replace(offered=given.total(), unheard=max(missing - unknown, 0))


def words_of(kind: str) -> dict[int, str]:
    """What is broken, by number, with {node} for who it concerns."""
    own = invariants_of(networks()[kind], "node_")
    return {OWN_BROKEN + place: f"{title}: {{node}}" for place, title in enumerate(own)}
