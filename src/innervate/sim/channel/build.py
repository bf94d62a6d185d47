"""From a radio plan to a world: all tables of a simulation, compiled (arrays) or plain (lists)."""

from typing import Any, NamedTuple

import numpy as np

from innervate.dialect import rng
from innervate.kernel import records
from innervate.scenario.actions.channel import BEGIN
from innervate.sim.channel import world as r
from innervate.sim.channel.loop import BATCH, ROWS_PER_EVENT
from innervate.sim.channel.medium import NEVER
from innervate.sim.heap import AIRS, COMMAND, OFFER, key_of, push
from innervate.sim.recorded import Recorded
from innervate.sim.tables import ROW, TAP, TRAIL, Names, Tables, longer, put, uniform

OUTBOX = 16


class Records(NamedTuple):
    """Declarations of a protocol's records, as columns of name, length, range, unit, meaning.

    Attributes:
        station: state of a station; `number`, `rng` and `choice`, where declared, are set here.
        params, frame, packet: parameters, frames, and what a station is handed to send.
        outbox: actions of one call of a handler at most.
        delivered: names of the fields of a row of what was delivered.
    """

    station: Any
    params: Any
    frame: Any
    packet: Any
    outbox: int = OUTBOX
    delivered: Names = r.PACKET


def build(plan: Any, of: Records, plain: bool, kept: Recorded, room: int | None = None) -> r.World:
    """The world of a plan, before its first event.

    Args:
        plan: of stations on a channel.
        of: the records of its protocol.
        plain: uncompiled.
        kept: what the run keeps; observed are reports, transmissions and delivered packets.
        room: for so many rows before the loop stops; None = as many as is usual.
    """
    tables = Tables(plain)
    n = plan.stations
    fields = of.station
    stations = tables.states(fields, n)
    low, high = records.bounds(fields)
    world = r.World(
        run=tables.records(r.RUN, 1, wide=r.WIDE),
        heap=r.Heap(tables.numbers(64 * n + 1024, 0, np.int64), tables.numbers(1, 0, np.int64)),
        above=(),
        stations=stations,
        words=tables.words(stations, fields),
        low=low.tolist() if plain else low,
        high=high.tolist() if plain else high,
        params=tables.states(of.params, 1),
        radios=tables.records(r.RADIO, n + 1, wide=r.WIDE),
        due=tables.numbers(n * r.TIMERS, NEVER, np.int64),
        told=tables.numbers(n + 2, 0, np.int64),
        air=tables.records(r.AIR, n * AIRS, wide=r.WIDE),
        frames=tables.states(of.frame, n * AIRS),
        **_neighbours(tables, plan),
        **_packets(tables, plan),
        item=tables.states(of.packet, 1),
        out=tables.outbox(of.outbox, of.frame),
        commands=tables.records(r.COMMAND, len(plan.faults) + 1, wide=r.WIDE),
        **_kept(tables, n, of, kept, room or tables.rows),
    )
    _set_run(world, plan, of, kept)
    _set_stations(world, plan, {name for name, *_ in fields})
    _set_events(world, plan)
    return world


def grow_heap(world: Any) -> Any:
    """The same world, of the radio or of a mesh, with twice the room for events."""
    keys = world.heap.keys
    return world._replace(heap=world.heap._replace(keys=longer(keys, 2 * len(keys))))


def _kept(tables: Tables, n: int, of: Records, kept: Recorded, room: int) -> dict[str, Any]:
    """What a run leaves of what happened, until the loop stops for it to be taken away."""
    beyond = BATCH * (ROWS_PER_EVENT + of.outbox) + n * of.outbox  # see `loop.pressing`
    rows = room + beyond if kept.observe else 1
    trail = tables.rows + beyond if kept.trail else 1
    tapped = tables.rows + of.outbox * n * BATCH if kept.tap else 1
    return {
        "rows": tables.records(ROW, rows, fresh=True, wide=r.WIDE),
        "sent": tables.records(r.SENT, rows, fresh=True, wide=r.WIDE),
        "packets": tables.records(of.delivered, rows, fresh=True, wide=r.WIDE),
        "trail": tables.records(TRAIL, trail, fresh=True, wide=r.WIDE),
        "taps": tables.records(TAP, tapped, fresh=True, wide=r.WIDE),
        "tapped": tables.states(of.frame, tapped),
    }


def _packets(tables: Tables, plan: Any) -> dict[str, Any]:
    """What stations are handed to send, and what became of it."""
    n = plan.stations
    return {
        "arrivals": tables.given([at for times in plan.arrivals for at in times] + [0]),
        "sizes": tables.given([_repeated(sizes, r.RING) for sizes in plan.sizes]),
        "offered": tables.numbers(n * r.RING, 0, np.int64),
        "got": tables.numbers(n * r.RING),
        "tries": tables.numbers(n * r.RING),
        "last": tables.numbers(n * n, NEVER),
    }


def _repeated(sizes: Any, count: int) -> np.ndarray[Any, Any]:
    """So many of these, again and again from the first; `np.resize` takes twenty times as long."""
    return np.tile(sizes, count // len(sizes) + 1)[:count]


def _neighbours(tables: Tables, plan: Any) -> dict[str, Any]:
    """Per station: who hears it and after how long, the nearest first; and how many."""
    n = plan.stations
    delays = np.array(plan.delays_us, np.int64)
    far = np.where(delays < 0, 1 << 40, delays)
    np.fill_diagonal(far, 1 << 40)
    order = np.lexsort((np.broadcast_to(np.arange(n), (n, n)), far), axis=1)
    sorted_delays = np.take_along_axis(far, order, axis=1)
    degree = (sorted_delays < 1 << 40).sum(axis=1)
    return {
        "degree": tables.given(degree),
        "order": tables.given(order),
        "delay": tables.given(sorted_delays),
    }


def _set_run(world: r.World, plan: Any, of: Records, kept: Recorded) -> None:
    limit = len(world.rows) if kept.observe else 0
    put(
        world.run,
        0,
        stations=plan.stations,
        slot_us=plan.params["slot_us"],
        ta_us=plan.params["ta_us"],
        oracle=plan.params["oracle"],
        full_duplex=plan.params["full_duplex"],
        period=plan.params["period_us"],
        loss=plan.loss_q15,
        rng=rng.seeded(int(uniform(plan.seed, "medium", 1, 1 << 30)[0])),
        saturated=int(plan.saturated),
        forced=int(plan.forced),
        per_turn=plan.params["per_turn"],
        wanted=plan.wanted,
        checks=int(kept.checks),
        watchful=int(kept.is_watchful),
        row_limit=limit,
        sent_limit=limit,
        packet_limit=limit,
        trail_limit=len(world.trail) if kept.trail else 0,
        broken_at=-1,
    )
    tapped = of.outbox * plan.stations * BATCH  # what a batch of events can add
    put(world.run, 0, tap_limit=max(0, len(world.taps) - tapped))
    put(world.params, 0, **{field[0]: plan.params[field[0]] for field in of.params})


def _set_stations(world: r.World, plan: Any, names: set[str]) -> None:
    n = plan.stations
    seeds = uniform(plan.seed, "stations", n, rng.FIXED_POINT - 1) + 1
    offsets = uniform(plan.seed, "offset", n, 1 << 30)
    first = 0
    for i in range(n):
        own = {"number": i, "rng": int(seeds[i]), "choice": rng.GENERATE}
        put(world.stations, i, **{name: own[name] for name in own if name in names})
        put(world.radios, i, offset=int(offsets[i]), first_offer=first, next_offer=first)
        put(world.radios, i, candidate=NEVER, leaving=int(plan.absent[i]), told_at=NEVER)
        first += len(plan.arrivals[i])
    put(world.radios, n, first_offer=first)


def _set_events(world: r.World, plan: Any) -> None:
    for i in range(plan.stations):
        if len(plan.arrivals[i]):
            push(world.heap, key_of(int(plan.arrivals[i][0]), OFFER, i, 0))
    put(world.commands, 0, action=BEGIN)  # before whatever else is done at time 0
    push(world.heap, key_of(0, COMMAND, 0, 0))
    for place, fault in enumerate(plan.faults, 1):
        put_command(world, place, fault)


def put_command(world: r.World, place: int, fault: Any) -> None:
    """Something that is to be done to stations, in its place among the commands; and queue it."""
    put(world.commands, place, action=fault.action, node=fault.node, value=fault.value)
    put(world.commands, place, index=fault.index)
    push(world.heap, key_of(fault.at_us, COMMAND, 0, place))
