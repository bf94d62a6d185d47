"""From a plan to a world: all tables of a simulation, compiled (arrays) or plain (lists)."""

from __future__ import annotations

from typing import Any

import numpy as np

from innervate.dialect import rng
from innervate.kernel import records
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.networks.skin.sim.orders import SLOTS
from innervate.scenario.actions.cables import GIVE, LOSE
from innervate.sim import delays
from innervate.sim.cables import commands
from innervate.sim.cables import world as w
from innervate.sim.cables.loop import BATCH
from innervate.sim.cables.wires import COUNTERS, LOSSY
from innervate.sim.tables import ACTION, TAP, Out, Tables, _longer, get, put, uniform
from innervate.sim.wheel import BUCKETS, FREE, FRESH, LAST, LEVELS, NIL, PENDING, WORDS
from innervate.topology.layout import cell_places

ROWS = 1 << 16
CELL_BYTES = 256  # whole cache lines
FRAME_BYTES = 128


def build(
    plan: Any,
    plain: bool = False,
    checks: bool = True,
    observe: bool = True,
    deliveries: bool = False,
    trail: bool = False,
    tap: bool = False,
    orders: bool = False,
) -> w.World:
    """The world of a plan, before its first event.

    `deliveries` keeps a row per tactile sample the PC receives, `trail` a row per handler call,
    `tap` copies of frames as they leave and come in. `orders` makes room for commands of the PC
    even if the plan has none.
    """
    tables = Tables(plain)
    graph = plan.graph
    cells, nodes, ends = graph.cells, graph.cells + 1, len(graph.peer)
    tx_slots = nodes * w.TIMER_SLOTS
    orders = orders or bool(plan.orders)
    waits = bool(plan.data_period_us) or orders  # beacons alone never wait
    pool_slots = tx_slots + (ends if waits else 0)
    limit = max(16, graph.interfaces + 4)
    pool = 2 * ends + BATCH * 16 + 4 * limit
    queue_frames = ends * plan.queue_frames if waits else 1
    # What a batch of events and a command can add: every action empties a queue, the PC goes off.
    burst = (BATCH + 1) * limit * (1 + plan.queue_frames)
    tapped = ROWS + burst if tap else 1
    states = tables.states(skin_fields.CELL, cells, CELL_BYTES)
    world = w.World(
        run=tables.records(w.RUN, 1, wide=w.WIDE),
        wheel=_wheel(tables, pool_slots, pool),
        frames=tables.states(skin_fields.FRAME, pool, FRAME_BYTES),
        queue=tables.states(skin_fields.FRAME, queue_frames),
        cells=states,
        pc=w.Sink(tables.states(skin_fields.SINK, 1), tables.numbers(graph.interfaces)),
        params=tables.states(skin_fields.PARAMS, 1),
        clocks=tables.records(w.CLOCK, nodes),
        starts=tables.records(w.START, nodes),
        alive=tables.numbers(nodes, w.OFF),
        ends=tables.records(w.END, ends),
        buffers=tables.records(w.BUFFER, ends),
        epoch=tables.numbers(ends),
        out=_outbox(tables, limit),
        sample=tables.states(skin_fields.FRAME, 1),
        counters=tables.numbers(COUNTERS, 0, np.int64),
        watch=_watch(tables, cells, states),
        commands=tables.records(w.COMMAND, len(plan.faults) + len(plan.orders) + 1),
        rows=tables.records(w.ROW, ROWS + 8 * limit, fresh=True),
        deliveries=tables.records(w.DELIVERY, ROWS if deliveries else 1, fresh=True),
        trail=tables.records(w.TRAIL, ROWS if trail else 1, fresh=True),
        taps=tables.records(TAP, tapped, fresh=True),
        tapped=tables.states(skin_fields.FRAME, tapped),
        **_books(tables, plan, orders),
        **_touch(tables, plan),
    )
    _set_run(world, plan, tx_slots, pool_slots)
    put(world.run, 0, checks=int(checks), watchful=int(checks or trail), broken_at=-1,
        row_limit=len(world.rows), observe=int(observe or checks))  # fmt: skip
    put(world.run, 0, delivery_limit=ROWS if deliveries else 0, trail_limit=ROWS if trail else 0)
    put(world.run, 0, tap_limit=ROWS if tap else 0)
    put(world.params, 0, **{field[0]: plan.params[field[0]] for field in skin_fields.PARAMS})
    put(world.pc.own, 0, ports=graph.interfaces)
    _set_wires(world, plan)
    _set_nodes(world, plan)
    _set_commands(world, plan)
    return world


def _wheel(tables: Tables, pool_slots: int, pool: int) -> w.Wheel:
    """An empty event queue."""
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


def _outbox(tables: Tables, limit: int) -> Out:
    """An empty outbox with room for `limit` actions."""
    return Out(
        count=tables.numbers(1, 0, np.int64),
        limit=tables.numbers(1, limit, np.int64),
        overflow=tables.numbers(1, 0, np.int64),
        action=tables.records(ACTION, limit),
        frame=tables.states(skin_fields.FRAME, limit),
    )


def _books(tables: Tables, plan: Any, orders: bool) -> dict[str, Any]:
    """What is kept of latencies, and of the PC's commands."""
    ways = (plan.graph.interfaces if plan.data_period_us else 0) + orders
    slots = SLOTS if orders else 0
    return {
        "delays": tables.records(w.DELAY, ways, wide=w.WIDE),
        "delay_counts": tables.numbers(ways * delays.CLASSES),
        "due": tables.numbers(slots * plan.graph.cells),
        "due_number": tables.numbers(slots, NIL),
    }


def _touch(tables: Tables, plan: Any) -> dict[str, Any]:
    """Tables of the synthetic touch, empty without one."""
    touch = plan.touch
    span = (touch.radius_um, touch.force_mn, touch.step_us) if touch else (0, 0, 1)
    places = [round(1000 * x) for place in cell_places(plan.graph) for x in place] if touch else ()
    return {
        "touch_x": _numbers(tables, touch.x_um if touch else ()),
        "touch_y": _numbers(tables, touch.y_um if touch else ()),
        "touch_span": _numbers(tables, span),
        "place": _numbers(tables, places),
    }


def grow_pool(world: w.World) -> w.World:
    """The same world with twice the room for frames on their way."""
    pool = world.wheel.pool
    first, last = int(get(world.run, 0, "pool_slots")), int(pool[LAST])
    events = _longer(world.wheel.events, first + 2 * last)
    links = _longer(world.wheel.links, BUCKETS + first + 2 * last)
    pool[LAST] = 2 * last
    return world._replace(
        frames=_longer(world.frames, 2 * last),
        wheel=world.wheel._replace(events=events, links=links),
    )


def _fill(table: Any, name: str, values: Any, count: int) -> None:
    """Set a field of the first `count` records: to one value, or to one each."""
    if isinstance(table, list):
        for i in range(count):
            setattr(table[i], name, values if isinstance(values, int) else int(values[i]))
    else:
        table[name][:count] = values


def _numbers(tables: Tables, values: Any) -> Any:
    made = np.array(values, np.int64)
    return made.tolist() if tables.plain else made


def _watch(tables: Tables, cells: int, states: Any) -> w.Watch:
    low, high = records.bounds(skin_fields.CELL)
    return w.Watch(
        port=tables.numbers(cells, NIL),
        routed=tables.numbers(cells),
        had=tables.numbers(cells),
        joined=tables.numbers(cells),
        apart=tables.numbers(cells, NIL, np.int64),
        ring=tables.numbers(cells, NIL),
        before=tables.numbers(cells),
        stack=tables.numbers(cells),
        low=low.tolist() if tables.plain else low,
        high=high.tolist() if tables.plain else high,
        words=tables.words(states, skin_fields.CELL),
    )


def _set_run(world: w.World, plan: Any, tx_slots: int, pool_slots: int) -> None:
    low, high = plan.latency_us
    put(
        world.run,
        0,
        cells=plan.graph.cells,
        nodes=plan.graph.cells + 1,
        tx_slots=tx_slots,
        pool_slots=pool_slots,
        wire_us=plan.wire_us,
        latency_low=low,
        latency_high=high,
        latency_per_frame=int(plan.latency_per_frame),
        queue_frames=plan.queue_frames,
        source_us=plan.data_period_us,
        rule=plan.params["rule"],
        rng=rng.seeded(int(uniform(plan.seed, "medium", 1, 1 << 30)[0])),
    )


def _set_wires(world: w.World, plan: Any) -> None:
    ends = len(plan.graph.peer)
    low, high = plan.latency_us
    _fill(world.ends, "peer", np.frombuffer(plan.graph.peer, np.int32), ends)
    _fill(world.ends, "latency", low + uniform(plan.seed, "latency", ends, high - low + 1), ends)
    if plan.loss_q15:
        _fill(world.buffers, "loss", plan.loss_q15, ends)
        _fill(world.ends, "impaired", LOSSY, ends)


def _set_nodes(world: w.World, plan: Any) -> None:
    """Clocks, generators, and the moment each node is switched on."""
    cells, nodes = plan.graph.cells, plan.graph.cells + 1
    steep = 0 if plan.lock_step else round(plan.drift_ppm * (1 << 30) / 1_000_000)
    rates = uniform(plan.seed, "drift", nodes, 2 * steep + 1) - steep
    _fill(world.clocks, "rate", rates, nodes)
    _fill(world.starts, "inverse", (1 << 60) // ((1 << 30) + rates) - 1, nodes)
    _fill(world.clocks, "offset", uniform(plan.seed, "offset", nodes, 1 << 30), nodes)
    seeds = uniform(plan.seed, "nodes", cells, rng.FIXED_POINT - 1) + 1
    _fill(world.cells, "rng", seeds, cells)
    _fill(world.cells, "number", np.arange(cells) & 0xFFFF, cells)
    _fill(world.cells, "choice", rng.GENERATE, cells)
    period = 1 if plan.lock_step else plan.params["beacon_us"]
    phases = uniform(plan.seed, "phase", nodes, period)
    if plan.data_period_us:
        source = uniform(plan.seed, "source", nodes, plan.data_period_us)
        _fill(world.starts, "source", source, nodes)
    _fill(world.starts, "phase", phases, nodes)


def _set_commands(world: w.World, plan: Any) -> None:
    """What is done to the network from outside, in order of time; faults before commands."""
    rows = [*map(fault_row, plan.faults), *map(order_row, plan.orders)]
    rows = [(0, commands.BEGIN, NIL, NIL, 0, NIL), *sorted(rows, key=lambda row: row[0])]
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


def order_row(order: Any) -> tuple[int, ...]:
    """A command of the PC as a row of `world.COMMAND`."""
    return (order.at_us, GIVE, NIL, order.cell, order.code << 16 | order.value, NIL)
