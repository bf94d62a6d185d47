"""From a skin's plan to a world: its records, what its observer keeps, what its cells feel."""

from typing import Any, NamedTuple

import numpy as np

from innervate.networks.skin.protocol import fields
from innervate.networks.skin.sim.observer import NUMBERS
from innervate.networks.skin.sim.orders import SLOTS
from innervate.scenario.actions.cables import GIVE
from innervate.sim.cables.build import Added, Records
from innervate.sim.cables.build import build as cables
from innervate.sim.cables.world import World
from innervate.sim.recorded import Recorded
from innervate.sim.tables import Tables
from innervate.sim.wheel import NIL
from innervate.topology import Graph
from innervate.topology.layout import cell_places

DELIVERY = (
    "time", "port", "cell", "seq", "hops", "latency",
    "proximity", ("force", 3), "temperature", ("accel", 3),
)  # fmt: skip
RECORDS = Records(
    node=fields.CELL,
    frame=fields.FRAME,
    params=fields.PARAMS,
    item=fields.FRAME,
    sink=fields.SINK,
    delivery=DELIVERY,
    numbers=NUMBERS,
)


class Watch(NamedTuple):
    """What the observer knows of every cell (see observer.py), and of the PC's commands."""

    port: Any  # parent port in force, -1 none
    routed: Any  # 1 = chain of parents reaches the PC over live cables
    had: Any  # 1 = it did so at some time
    joined: Any  # 1 = physically connected to the PC
    apart: Any  # since when it is on without being so, us; -1 = it is not
    ring: Any  # start of the forwarding loop the cell is in, -1 none
    before: Any  # `routed` as it was before the present command
    stack: Any
    was_on: Any  # 1 = it was switched on before
    forgot: Any  # why it forgot all that it announced (see proved.py); -1 = it did not
    clear_at: Any  # until when some of that may be under way, us
    due: Any  # per newest commands of the PC and cell: what is known (see orders.py)
    due_number: Any  # ... the commands' numbers, -1 none


class Touch(NamedTuple):
    """The synthetic touch (see touch.py), empty without one."""

    x: Any
    y: Any
    span: Any
    place: Any


def build(plan: Any, plain: bool = False, orders: bool = False, **kept: bool) -> World:
    """The world of a plan, before its first event.

    Args:
        plan: of a skin.
        plain: uncompiled.
        orders: make room for commands of the PC even if the plan has none.
        **kept: as in `sim.recorded`.
    """
    tables = Tables(plain)
    orders = orders or bool(plan.orders)
    has_data = plan.data_period_us > 0
    added = Added(
        watch=_watch(tables, plan.graph.cells, orders),
        carrier=_touch(tables, plan),
        inputs=tuple(order_row(plan, order) for order in plan.orders),
        queues=has_data or orders,  # beacons alone never wait
        ways=(plan.graph.interfaces if has_data else 0) + orders,
    )
    return cables(plan, RECORDS, tables, Recorded(**kept), added)


def order_row(plan: Any, order: Any) -> tuple[int, ...]:
    """A command of the PC as a row of `world.COMMAND`; whom it is for stands in its `end`."""
    return (order.at_us, GIVE, order.cell, plan.graph.sink, order.code << 16 | order.value, NIL)


def _watch(tables: Tables, cells: int, orders: bool) -> Watch:
    slots = SLOTS if orders else 0
    return Watch(
        port=tables.numbers(cells, NIL),
        routed=tables.numbers(cells),
        had=tables.numbers(cells),
        joined=tables.numbers(cells),
        apart=tables.numbers(cells, NIL, np.int64),
        ring=tables.numbers(cells, NIL),
        before=tables.numbers(cells),
        stack=tables.numbers(cells),
        was_on=tables.numbers(cells),
        forgot=tables.numbers(cells, NIL),
        clear_at=tables.numbers(cells, NIL, np.int64),
        due=tables.numbers(slots * cells),
        due_number=tables.numbers(slots, NIL),
    )


def _touch(tables: Tables, plan: Any) -> Touch:
    touch = plan.touch
    if not touch:
        return Touch(*map(tables.given, ((), (), (0, 0, 1), ())))
    span = (touch.radius_um, touch.force_mn, touch.step_us)
    return Touch(*map(tables.given, (touch.x_um, touch.y_um, span, places_um(plan.graph))))


def places_um(graph: Graph) -> list[int]:
    """Where the cells are, um: x and y of each, one after the other."""
    return [round(1000 * x) for place in cell_places(graph) for x in place]
