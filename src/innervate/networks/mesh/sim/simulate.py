"""Runs a mesh plan: builds the world, drives the loop in slices, collects its tables."""

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Any, ClassVar

from innervate.kernel import compilation
from innervate.networks.mesh.protocol import csma
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.protocol.constants import MTU
from innervate.networks.mesh.sim import build as builder
from innervate.networks.mesh.sim import channel, orders, over_channel, recorder, stacks
from innervate.networks.mesh.sim import world as w
from innervate.networks.radio.sim import recorder as radio_recorder
from innervate.networks.radio.sim import simulate as radio_simulate
from innervate.networks.radio.sim import stacks as radio_stacks
from innervate.sim import heap, rows, taps
from innervate.sim.driver import Left, Progress
from innervate.sim.field import access as over_medium
from innervate.sim.field import calls, loop, medium, motion, powers
from innervate.sim.field.simulation import Field
from innervate.sim.ranges import is_in_range
from innervate.sim.status import POOL_FULL
from innervate.sim.tables import ROW, TRAIL, get

SLICE_EVENTS = 200_000
PLAIN_SLICE_EVENTS = 2_000


@dataclass(slots=True, kw_only=True)
class MeshResult(Left):
    """What a mesh simulation leaves.

    Structured arrays with the fields of `ROW`, `TRAIL`, `world.SENT`, `DELIVERED` and `ROUND`;
    times in us.

    Attributes:
        rows: what nodes reported.
        sent: what was on the air, by its end; frames that their sender's death cut short have no
            receivers.
        delivered: what nodes gave to their users.
        rounds: what a gateway knew after each of its rounds.
        trail: all handler calls, if asked for; those of the medium access are numbered from
            `access.MAC`.
        counts: the numbers of the run by name, see COUNTS.
    """

    rows: Any
    sent: Any
    delivered: Any
    rounds: Any
    trail: Any
    counts: dict[str, int]


COUNTS = (
    "handled",  # handler calls
    "arrived",  # frames received
    "transmissions",  # frames that went on the air
    "gave_up",  # frames that the medium access returned
    "blocked",  # frames that came down while the radio was sending another
    "unasked",  # messages for a node that was off
)


def compiled_loop(entry: ModuleType, mac: str) -> Callable[..., None]:
    """The compiled loop of a router over a medium access protocol by name."""
    return _compiled(entry, radio_stacks.PROTOCOLS.get(mac))


@functools.cache
def _compiled(entry: ModuleType, access: radio_stacks.Protocol | None) -> Callable[..., None]:
    """The same; CSMA is what there is without a protocol for a channel that all share."""
    below = csma if access is None else access.entry
    own = entry is stacks.mesh() and compilation.is_own(entry) and compilation.is_own(below)
    name = f"{entry.__name__} over {below.__name__}" if own else ""
    return compilation.loop(name, lambda: _jitted(entry, access))


def _jitted(entry: ModuleType, access: radio_stacks.Protocol | None) -> Any:
    """That loop's functions registered, and the loop for Numba."""
    from innervate.dialect import arith, outbox, rng

    compilation.register(arith, outbox, rng, heap)
    compilation.register(
        *compilation.modules_of(entry), csma, medium, motion, recorder, rows, taps, hot=False
    )
    compilation.register_functions(powers.strength, *motion.CALLED)
    layer = stacks.Layer(over_medium)
    if access is not None:
        layer = stacks.Layer(over_channel, radio_simulate.registered(access, over_channel))
    compilation.register(calls, orders, loop, layer.part, hot=False)
    do = stacks.bind(entry, layer)
    compilation.register_functions(*filter(callable, vars(do).values()), hot=False)
    return compilation.compiled_as_one(loop.bind(do))


def simulate(
    plan: Any,
    *,
    plain: bool = False,
    progress: Progress | None = None,
    entry: ModuleType | None = None,
    through: Callable[[Any], Any] | None = None,
    tap: taps.Tap | None = None,
    **kept: bool,
) -> MeshResult:
    """Run a mesh plan to its end; an interrupt (Ctrl-C) ends it early and keeps what was done.

    Args:
        plan: what `scenario` made of a file.
        plain: the same loop uncompiled, on lists and objects.
        progress: called with the time reached and the whole duration, us, now and then.
        entry: the router's module; the mesh's own if none is given.
        through: plain runs only: every frame passes through it on its way to the air.
        tap: is handed copies of all frames as they leave and come in (see sim/taps.py).
        kept: as in `sim.recorded`.

    Raises:
        InvariantBroken: a checker found something that must not happen.
    """
    running = simulation(
        plan, plain=plain, entry=entry, through=through, tap=tap is not None, **kept
    )
    ended = running.finish(progress, tap)
    return MeshResult(
        counts={name: int(get(running.world.run, 0, name)) for name in COUNTS},
        **running.left(ended),
        **ended.rows,
    )


class MeshSimulation(Field):
    """A mesh that is simulated in slices: its plan, its world, its loop."""

    wide = w.WIDE
    tables: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "rows": ROW, "sent": w.SENT, "delivered": w.DELIVERED, "rounds": w.ROUND,
        "trail": TRAIL,
    }  # fmt: skip
    broken_words: ClassVar[Mapping[int, str]] = {
        **Field.broken_words, recorder.BROKEN_TWICE: "{node} delivered a packet twice",
    }  # fmt: skip

    def grow(self, status: int) -> None:
        """Make room for more events, or for more deliveries to be remembered."""
        if status == POOL_FULL:
            self.world = channel.grown(self.world)
        if status == orders.DUPLICATES_FULL:
            self.world = builder.grow_duplicates(self.world)

    def broken_between(self) -> tuple[int, int] | None:
        """The ranges of gateways' records: of hundreds of words, which few events change."""
        fields = mesh_fields.gate(self.plan.capacity)
        nodes = (node for node, rank in enumerate(self.plan.ranks) if rank >= 0)
        for gate, node in zip(self.world.gates, nodes, strict=False):
            if not is_in_range(gate, fields):
                return medium.BROKEN_RANGE, node
        return None

    def broken_line(self) -> str:
        """The broken invariant, in one line; what is below has its own words."""
        if int(get(self.world.run, 0, "broken")) == recorder.BROKEN_BELOW:
            below = radio_simulate.RadioSimulation(self.plan, self.world.below, self._advance)
            return below.broken_line()
        return super().broken_line()

    def whom(self) -> dict[str, str]:
        """A node, as the scenario calls it."""
        name = self.plan.names[int(get(self.world.run, 0, "broken_node"))]
        return {"node": f"node {name}"}


def simulation(
    plan: Any,
    *,
    plain: bool = False,
    entry: ModuleType | None = None,
    through: Callable[[Any], Any] | None = None,
    **kept: bool,
) -> MeshSimulation:
    """A plan's mesh before its first event; arguments as for `simulate`."""
    if through is not None and not plain:
        raise ValueError("frames pass through a function in plain runs only")
    _check_mac(plan.mac)
    router = entry or stacks.mesh()
    if plain:
        advance = loop.bind(stacks.plain(router, _plain_layer(plan.mac), through))
    else:
        advance = compiled_loop(router, plan.mac)
    world = builder.build(plan, plain, **kept)
    made = MeshSimulation(plan, world, advance, "" if plain else loop_name(plan))
    made.slice_events = PLAIN_SLICE_EVENTS if plain else SLICE_EVENTS
    return made


def _check_mac(mac: str) -> None:
    known = (*builder.MACS, *radio_stacks.PROTOCOLS)
    if mac not in known:
        raise ValueError(f"mac must be one of {', '.join(known)}, not {mac!r}")


def loop_name(plan: Any) -> str:
    """Which loop a plan runs on, for `kernel.compilation.is_compiled`."""
    access = radio_stacks.PROTOCOLS.get(plan.mac)
    below = f"-{access.entry.__name__.rpartition('.')[2]}" if access else ""
    longer = f"-{plan.params['mtu']}" if plan.params["mtu"] > MTU else ""
    return f"mesh-{plan.capacity}{longer}{below}"


def _plain_layer(mac: str) -> stacks.Layer:
    """What is below the router in a plain run."""
    if mac in builder.MACS:
        return stacks.Layer(over_medium)
    entry = radio_stacks.PROTOCOLS[mac].entry
    return stacks.Layer(over_channel, radio_stacks.bind(entry, radio_recorder, over_channel))
