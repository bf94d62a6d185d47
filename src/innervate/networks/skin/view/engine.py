"""A skin that can be touched while it is watched."""

from typing import Any

from innervate.networks.skin.scenario.orders import Order
from innervate.networks.skin.sim import simulate
from innervate.networks.skin.sim.build import order_row
from innervate.networks.skin.sim.simulate import SkinSimulation
from innervate.networks.skin.view.touching import Finger
from innervate.sim.driver import Simulation
from innervate.web.engine import Engine, Mark

CELLS_MAX = 20_000
ORDERS_CELLS_MAX = 2_000  # of a skin without data or commands of its own: they need room to wait


class SkinEngine(Engine):
    """A skin under way, and a finger on it."""

    running: SkinSimulation
    finger: Finger | None = None  # once a hand has touched the skin

    def __init__(self, running: Simulation) -> None:
        self.orders: list[Order] = []  # given by hand
        super().__init__(running)

    @property
    def takes_orders(self) -> bool:
        """Is there room for commands of the PC?"""
        return takes_orders(self.plan)

    def give(self, order: Order) -> None:
        """Have the PC send a command, not before `earliest_us`."""
        self.orders.append(order)
        self.running.schedule_row(order_row(self.plan, order))

    def touch(self, cell: int | None) -> None:
        """Touch a cell from now on, or none."""
        if self.finger is None:
            self.finger = Finger(self.plan)
        self.finger.move(self.earliest_us, cell)
        self.running.world = self.finger.into(self.world)

    def back_to(self, mark: Mark) -> None:
        """Go back to a moment that was remembered; what was touched later is touched again."""
        super().back_to(mark)
        for order in self.orders:
            if order.at_us >= self.now_us:
                self.running.schedule_row(order_row(self.plan, order))
        if self.finger is not None:
            self.running.world = self.finger.into(self.world)


def unwatchable(plan: Any) -> str:
    """Why a skin cannot be watched; "" if it can."""
    if plan.graph.cells > CELLS_MAX:
        return f"{plan.graph.cells:,} cells are too many to be drawn; at most {CELLS_MAX:,}"
    if plan.script:
        return "its [script] replaces the clock; use: innervate run"
    return ""


def takes_orders(plan: Any) -> bool:
    """Is there room for commands of the PC, though the plan may have none?"""
    known = bool(plan.orders) or plan.data_period_us > 0
    return known or plan.graph.cells <= ORDERS_CELLS_MAX


def simulation(plan: Any) -> simulate.SkinSimulation:
    """The skin as it is watched: with all samples that the PC receives."""
    kept = plan.data_period_us > 0
    return simulate.simulation(plan, deliveries=kept, orders=takes_orders(plan))
