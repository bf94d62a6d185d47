"""Runs a radio plan: builds the world, drives the loop in slices, collects its tables."""

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Any, ClassVar

from innervate.kernel import compilation
from innervate.networks.radio.sim import build as builder
from innervate.networks.radio.sim import recorder, stacks
from innervate.scenario.actions.channel import KILL, LEAVE
from innervate.sim import heap, rows, taps
from innervate.sim.channel import listening, loop, medium, traffic
from innervate.sim.channel import world as w
from innervate.sim.channel.simulation import Channel
from innervate.sim.driver import Left, Progress
from innervate.sim.tables import ROW, TRAIL, get, put


@dataclass(slots=True, kw_only=True)
class RadioResult(Left):
    """What a radio simulation leaves.

    `rows` are what stations reported, `sent` all transmissions, `packets` all packets that their
    sender takes for delivered, `trail` all handler calls: structured arrays with the fields of
    `ROW`, `TRAIL`, `world.SENT` and `world.PACKET`, times in us.
    `counts` holds the numbers of the run by name.
    """

    rows: Any
    sent: Any
    packets: Any
    trail: Any
    counts: dict[str, int]


COUNTS = ("handled", "decoded", "garbled", "offers", "dropped", "completed", "silent", "partial",
          "again")  # fmt: skip


def compiled_loop(name: str) -> Callable[..., None]:
    """The compiled loop of a protocol by name."""
    return _compiled(stacks.PROTOCOLS[name])


@functools.cache
def _compiled(protocol: stacks.Protocol) -> Callable[..., None]:
    """Its loop; all names of one protocol share it."""
    name = protocol.entry.__name__ if compilation.is_own(protocol.entry) else ""
    return compilation.loop(
        name, lambda: compilation.compiled_as_one(loop.bind(registered(protocol, traffic)))
    )


def registered(protocol: stacks.Protocol, packets: ModuleType) -> ModuleType:
    """What the medium calls of a protocol; that and the medium may be compiled from now on."""
    from innervate.dialect import arith, outbox, rng

    compilation.register(traffic, rows, taps, hot=False)
    compilation.register(arith, outbox, rng, heap, medium)
    compilation.register(*compilation.modules_of(protocol.entry), hot=False)
    compilation.register(recorder, listening, packets, hot=False)
    compilation.register_functions(loop.pressing, *loop.FUNCTIONS, hot=False)
    do = stacks.bind(protocol.entry, recorder, packets)
    compilation.register_functions(*(one for one in vars(do).values() if callable(one)))
    return do


def simulate(
    plan: Any, *, progress: Progress | None = None, tap: taps.Tap | None = None, **how: bool
) -> RadioResult:
    """Run a radio plan to its end; an interrupt (Ctrl-C) ends it early and keeps what was done.

    `how` are `plain`, which runs the same loop uncompiled, and what `sim.recorded` knows.
    `tap` is handed copies of all frames as they leave and come in (see sim/taps.py).
    Raises InvariantBroken.
    """
    running = simulation(plan, tap=tap is not None, **how)
    ended = running.finish(progress, tap)
    return RadioResult(
        counts={name: int(get(running.world.run, 0, name)) for name in COUNTS},
        **running.left(ended),
        **ended.rows,
    )


class RadioSimulation(Channel):
    """A radio team under way."""

    tables: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "rows": ROW, "sent": w.SENT, "packets": w.PACKET, "trail": TRAIL,
    }  # fmt: skip

    broken_words: ClassVar[Mapping[int, str]] = {
        **Channel.broken_words,
        medium.BROKEN_DEAF: "{node} sent while its radio could not",
        recorder.BROKEN_TURNS: "{node} began a turn while another station had its own",
    }

    def prepare(self) -> None:
        """Compile the loop; all names of one protocol share it."""
        super().prepare()
        for name in self.loop_names() if self.name else ():
            compilation.mark_compiled(name)

    def loop_names(self) -> list[str]:
        """What `loop_name` says of plans that run on the same loop."""
        same = stacks.PROTOCOLS[self.plan.protocol]
        return [name.replace("/", "-") for name, one in stacks.PROTOCOLS.items() if one == same]

    def schedule(self, fault: Any) -> None:
        """As a plan with such events has it: turns may overlap, who is gone delivers no more."""
        super().schedule(fault)
        put(self.world.run, 0, exclusive=0)
        if fault.action in (KILL, LEAVE):
            put(self.world.run, 0, wanted=0)

    def whom(self) -> dict[str, str]:
        """The station that it concerns, in words."""
        return {"node": f"station {int(get(self.world.run, 0, 'broken_node'))}"}


def simulation(plan: Any, *, plain: bool = False, **kept: bool) -> RadioSimulation:
    """A plan's team before its first event; `kept` as in `sim.recorded`."""
    if plain:
        advance = loop.bind(stacks.bind(stacks.PROTOCOLS[plan.protocol].entry, recorder))
    else:
        advance = compiled_loop(plan.protocol)
    world = builder.build(plan, plain, **kept)
    name = "" if plain else plan.protocol.replace("/", "-")
    return RadioSimulation(plan, world, advance, name)
