"""From a plan to a world: all tables of a simulation, compiled (arrays) or plain (lists)."""

from typing import Any, NamedTuple

import numpy as np

from innervate.dialect import rng
from innervate.kernel import records
from innervate.kernel.records import Declaration
from innervate.scenario.actions.cables import LOSE
from innervate.sim import delays
from innervate.sim.cables import commands
from innervate.sim.cables import world as w
from innervate.sim.cables.loop import BATCH, PUSHED_PER_EVENT, ROWS_PER_EVENT
from innervate.sim.cables.wires import COUNTERS, LOSSY
from innervate.sim.recorded import Recorded
from innervate.sim.tables import DELIVERY, ROW, TAP, TRAIL, Names, Tables, get, longer, put, uniform
from innervate.sim.wheel import BUCKETS, FREE, FRESH, LAST, LEVELS, NIL, PENDING, WORDS

CACHE_LINE = 64


class Records(NamedTuple):
    """Declarations of a network's records, as columns of name, length, range, unit, meaning.

    Attributes:
        node: state of a node; `number`, `rng` and `choice`, where declared, are set here.
        frame, params: frames, and the parameters of the protocol.
        item: what a node is handed as input.
        sink: state of the node with a port per interface; () = all nodes are equal.
        delivery: names of the fields of a row of what users received.
        numbers: names of the recorder's own numbers, in `world.run`.
        outbox: most actions of a handler, besides one per interface.
    """

    node: Declaration
    frame: Declaration
    params: Declaration
    item: Declaration
    sink: Declaration = ()
    delivery: Names = DELIVERY
    numbers: tuple[str, ...] = ()
    outbox: int = 16


class Added(NamedTuple):
    """What a network adds to the tables of its cables.

    Attributes:
        watch, carrier: the recorder's tables, and those of what nodes sense.
        inputs: what nodes are given by their users, as rows of `world.COMMAND`.
        queues: frames may have to wait at their ports.
        ways: how many latencies are kept apart.
    """

    watch: Any = ()
    carrier: Any = ()
    inputs: tuple[tuple[int, ...], ...] = ()
    queues: bool = True
    ways: int = 0


class _Sizes(NamedTuple):
    """How long the tables are."""

    nodes: int
    ends: int
    tx_slots: int
    pool_slots: int
    limit: int  # actions of the outbox
    pool: int  # frames on their way
    queue: int  # frames that wait
    tapped: int


def build(plan: Any, of: Records, tables: Tables, kept: Recorded, added: Added) -> w.World:
    """The world of a plan, before its first event.

    Args:
        plan: see `scenario/cables.py`.
        of: its protocol's records.
        tables: makes them, compiled or plain.
        kept: what the run keeps.
        added: what is its network's own.
    """
    size = _sizes(plan, of, kept, added, tables.rows)
    states = tables.states(of.node, plan.graph.cells, _lines(of.node))
    low, high = records.bounds(of.node)
    world = w.World(
        run=tables.records((*w.RUN, *of.numbers), 1, wide={*w.WIDE, *of.numbers}),
        wheel=_wheel(tables, size.pool_slots, size.pool),
        frames=tables.states(of.frame, size.pool, _lines(of.frame)),
        queue=tables.states(of.frame, size.queue),
        cells=states,
        words=tables.words(states, of.node),
        low=low.tolist() if tables.plain else low,
        high=high.tolist() if tables.plain else high,
        pc=_sink(tables, of, plan.graph.interfaces),
        params=tables.states(of.params, 1),
        clocks=tables.records(w.CLOCK, size.nodes),
        starts=tables.records(w.START, size.nodes),
        alive=tables.numbers(size.nodes, w.OFF),
        ends=tables.records(w.END, size.ends),
        buffers=tables.records(w.BUFFER, size.ends),
        epoch=tables.numbers(size.ends),
        out=tables.outbox(size.limit, of.frame),
        sample=tables.states(of.item, 1),
        counters=tables.numbers(COUNTERS, 0, np.int64),
        watch=added.watch,
        carrier=added.carrier,
        commands=tables.records(w.COMMAND, len(plan.faults) + len(added.inputs) + 1),
        **_kept(tables, of, size, kept),
        delays=tables.records(w.DELAY, added.ways, wide=w.WIDE),
        delay_counts=tables.numbers(added.ways * delays.CLASSES),
    )
    _set_run(world, plan, size, kept, tables.rows)
    put(world.params, 0, **{field[0]: plan.params[field[0]] for field in of.params})
    _set_wires(world, plan)
    _set_nodes(world, plan, of)
    _set_commands(world, plan, added.inputs)
    return world


def _kept(tables: Tables, of: Records, size: _Sizes, kept: Recorded) -> dict[str, Any]:
    """What a run leaves of what happened, until the loop stops for it to be taken away."""
    beyond = BATCH * (ROWS_PER_EVENT + size.limit)  # what a batch of events can add
    deliveries = tables.rows + beyond if kept.deliveries else 1
    return {
        "rows": tables.records(ROW, tables.rows + beyond, fresh=True),
        "deliveries": tables.records(of.delivery, deliveries, fresh=True),
        "trail": tables.records(TRAIL, tables.rows if kept.trail else 1, fresh=True),
        "taps": tables.records(TAP, size.tapped, fresh=True),
        "tapped": tables.states(of.frame, size.tapped),
    }


def _sizes(plan: Any, of: Records, kept: Recorded, added: Added, rows: int) -> _Sizes:
    graph, ends = plan.graph, len(plan.graph.peer)
    nodes = graph.cells + bool(of.sink)
    tx_slots = nodes * w.TIMER_SLOTS
    limit = max(of.outbox, graph.interfaces + 4)
    # What a batch of events and a command can add: every action empties a queue, the sink goes off.
    burst = (BATCH + 1) * limit * (1 + plan.queue_frames)
    return _Sizes(
        nodes=nodes,
        ends=ends,
        tx_slots=tx_slots,
        pool_slots=tx_slots + (ends if added.queues else 0),
        limit=limit,
        pool=2 * ends + BATCH * (PUSHED_PER_EVENT + limit) + 4 * limit,
        queue=ends * plan.queue_frames if added.queues else 1,
        tapped=rows + burst if kept.tap else 1,
    )


def _lines(declaration: Declaration) -> int:
    """Bytes of a record in whole cache lines."""
    used = records.dtype(declaration).itemsize
    return -(-used // CACHE_LINE) * CACHE_LINE


def _sink(tables: Tables, of: Records, ports: int) -> Any:
    """The state of the node with a port per interface, if there is one."""
    if not of.sink:
        return ()
    sink = w.Sink(tables.states(of.sink, 1), tables.numbers(ports))
    put(sink.own, 0, ports=ports)
    return sink


def _wheel(tables: Tables, pool_slots: int, pool: int) -> w.Wheel:
    """An empty event queue with room for `pool` events and a slot for each wait."""
    wheel = w.Wheel(
        clock=tables.numbers(2, 0, np.int64),
        links=tables.numbers(BUCKETS + pool_slots + pool),
        tails=tables.numbers(BUCKETS),
        words=tables.numbers(LEVELS * WORDS, 0, np.int64),
        events=tables.records(w.EVENT, pool_slots + pool, fresh=True),
        pool=tables.numbers(3, 0, np.int64),
    )
    for bucket in range(BUCKETS):
        wheel.tails[bucket] = bucket
        wheel.links[bucket] = NIL
    _fill(wheel.events, "bucket", NIL, pool_slots)
    wheel.clock[PENDING] = NIL
    wheel.pool[FREE], wheel.pool[FRESH], wheel.pool[LAST] = NIL, pool_slots, pool
    return wheel


def grow_pool(world: w.World) -> w.World:
    """The same world with twice the room for frames on their way."""
    pool = world.wheel.pool
    first, last = int(get(world.run, 0, "pool_slots")), int(pool[LAST])
    events = longer(world.wheel.events, first + 2 * last)
    links = longer(world.wheel.links, BUCKETS + first + 2 * last)
    pool[LAST] = 2 * last
    return world._replace(
        frames=longer(world.frames, 2 * last),
        wheel=world.wheel._replace(events=events, links=links),
    )


def _fill(table: Any, name: str, values: Any, count: int) -> None:
    """Set a field of the first `count` records: to one value, or to one each."""
    if isinstance(table, list):
        for i in range(count):
            setattr(table[i], name, values if isinstance(values, int) else int(values[i]))
    else:
        table[name][:count] = values


def _set_run(world: w.World, plan: Any, size: _Sizes, kept: Recorded, rows: int) -> None:
    low, high = plan.latency_us
    put(
        world.run,
        0,
        cells=plan.graph.cells,
        nodes=size.nodes,
        tx_slots=size.tx_slots,
        pool_slots=size.pool_slots,
        wire_us=plan.wire_us,
        latency_low=low,
        latency_high=high,
        latency_per_frame=int(plan.latency_per_frame),
        queue_frames=plan.queue_frames,
        source_us=plan.data_period_us,
        rng=rng.seeded(int(uniform(plan.seed, "medium", 1, 1 << 30)[0])),
        checks=int(kept.checks),
        watchful=int(kept.is_watchful),
        observe=int(kept.observe or kept.checks),
        broken_at=-1,
        row_limit=len(world.rows),
        delivery_limit=len(world.deliveries) if kept.deliveries else 0,
        trail_limit=rows if kept.trail else 0,
        tap_limit=rows if kept.tap else 0,
    )


def _set_wires(world: w.World, plan: Any) -> None:
    ends = len(plan.graph.peer)
    low, high = plan.latency_us
    _fill(world.ends, "peer", np.frombuffer(plan.graph.peer, np.int32), ends)
    _fill(world.ends, "latency", low + uniform(plan.seed, "latency", ends, high - low + 1), ends)
    if plan.loss_q15:
        _fill(world.buffers, "loss", plan.loss_q15, ends)
        _fill(world.ends, "impaired", LOSSY, ends)


def _set_nodes(world: w.World, plan: Any, of: Records) -> None:
    """Clocks, generators, and the moment each node is switched on."""
    cells, nodes = plan.graph.cells, len(world.clocks)
    steep = round(plan.drift_ppm * (1 << 30) / 1_000_000)
    rates = uniform(plan.seed, "drift", nodes, 2 * steep + 1) - steep
    _fill(world.clocks, "rate", rates, nodes)
    _fill(world.starts, "inverse", (1 << 60) // ((1 << 30) + rates), nodes)
    _fill(world.clocks, "offset", uniform(plan.seed, "offset", nodes, 1 << 30), nodes)
    first = {
        "rng": uniform(plan.seed, "nodes", cells, rng.FIXED_POINT - 1) + 1,
        "number": np.arange(cells) & 0xFFFF,
        "choice": rng.GENERATE,
    }
    for name, *_ in of.node:
        if name in first:
            _fill(world.cells, name, first[name], cells)
    if plan.data_period_us:
        source = uniform(plan.seed, "source", nodes, plan.data_period_us)
        _fill(world.starts, "source", source, nodes)
    _fill(world.starts, "phase", uniform(plan.seed, "phase", nodes, plan.start_us), nodes)


def _set_commands(world: w.World, plan: Any, inputs: tuple[tuple[int, ...], ...]) -> None:
    """What is done to the network from outside, in order of time; faults before inputs."""
    rows = sorted([*map(fault_row, plan.faults), *inputs], key=lambda row: row[0])
    rows = [(0, commands.BEGIN, NIL, NIL, 0, NIL), *rows]
    put(world.run, 0, commands=len(rows))
    if isinstance(world.commands, list):
        for i, row in enumerate(rows):
            put(world.commands, i, **dict(zip(w.COMMAND, row, strict=True)))
    else:
        world.commands[:] = rows


def fault_row(fault: Any) -> tuple[int, ...]:
    """A fault of the plan as a row of `world.COMMAND`."""
    value = fault.frames if fault.action == LOSE else fault.loss_q15
    return (fault.at_us, fault.action, fault.end, fault.node, value, fault.index)
