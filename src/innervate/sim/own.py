"""What a network says itself, of a run on any medium: its frames, invariants, messages."""

from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from types import ModuleType
from typing import Any

import numpy as np

from innervate.dialect.arith import MASK30
from innervate.folders import invariants_of
from innervate.kernel import compilation
from innervate.kernel.bits import mix
from innervate.network import Network, networks
from innervate.scenario.cables import Happening
from innervate.sim.came import Came
from innervate.sim.counts import Counts
from innervate.sim.driver import Simulation
from innervate.sim.sent import WORDS
from innervate.sim.tables import Tables

OWN_BROKEN = 64  # `run.broken` of the first of them; below it are those of the media


class Unfit(ValueError):
    """A protocol cannot be simulated as it is declared."""


class Declared(Simulation):
    """Nodes whose protocol is declared: what of it broke, in words; when they are given what."""

    def said(self, code: int) -> str:
        """What is broken: of its medium, of its frames, or an invariant of its own."""
        return self.broken_words.get(code) or {**WORDS, **words_of(self.plan.kind)}[code]

    @cached_property
    def message_times(self) -> list[int]:
        """When users give what is to be delivered, us."""
        return message_times(self.plan)


def frames_of(declared: Any, measured: Iterable[str] = ()) -> dict[str, Callable[..., Any]]:
    """What a medium does with frames, written out for their fields, by name.

    `copy_frame(to, frm)`; `digest(frame)`, but for `made_at` and what is `measured`;
    `kind_of(frame)`, -1 without one; `block_of(frame)`; and of a field `made_at`, where there is
    one, `stamp(frame, at)` and `latency_of(frame, time)`, us, -1 where nobody knows it.
    """
    names = {name for name, length, *_ in declared if not length}
    copies, words = [], []
    for name, length, *_ in declared:
        for place in [f"{name}[{i}]" for i in range(length)] if length else [name]:
            copies.append(f"    to.{place} = frm.{place}")
            if name not in ("made_at", *measured):
                words.append(f"    word = mix(word, frame.{place})")
    latency = f"(time - frame.made_at) & {MASK30} if frame.made_at > 0 else -1"
    text = "\n".join([
        "def copy_frame(to, frm):", *copies,
        "def digest(frame):", "    word = 1", *words, "    return word",
        "def kind_of(frame):", f"    return {'frame.kind' if 'kind' in names else -1}",
        "def block_of(frame):", "    return 0",
        "def stamp(frame, at):",
        f"    {f'frame.made_at = max(at & {MASK30}, 1)' if 'made_at' in names else 'pass'}",
        "def latency_of(frame, time):", f"    return {latency if 'made_at' in names else -1}",
    ])  # fmt: skip
    made: dict[str, Any] = {"mix": mix}
    exec(compile(text, "frames of a protocol", "exec"), made)
    return {name: made[name] for name in
            ("copy_frame", "digest", "kind_of", "block_of", "stamp", "latency_of")}  # fmt: skip


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


def modules_of(network: Network) -> list[ModuleType]:
    """The modules of its protocol and of its invariants, to be compiled."""
    found = compilation.modules_of(network.protocol)
    return found + (compilation.modules_of(network.invariants) if network.has("invariants") else [])


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
