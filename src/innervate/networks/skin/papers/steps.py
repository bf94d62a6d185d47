"""A simulation in steps, to look into it while it runs: penalties, counters, loads."""

from __future__ import annotations

from typing import Any

from innervate import scenario
from innervate.networks.skin.scenario.plan import Plan
from innervate.networks.skin.sim.simulate import simulation
from innervate.scenario import Scenario
from innervate.sim.status import DONE


class Steps:
    """Runs a scenario up to given times; between them `world` may be read.

    Rows that the run reports are dropped: what is asked of it here is its state.
    """

    def __init__(self, source: Scenario | dict[str, Any], seed: int | None = None) -> None:
        made = source if isinstance(source, Scenario) else scenario.from_dict(source, seed=seed)
        self.plan: Plan = scenario.plan(made)
        self._running = simulation(self.plan)

    @property
    def world(self) -> Any:
        """The tables of the simulation as they are now."""
        return self._running.world

    def to(self, time_s: float) -> None:
        """Run up to, not including, a time.

        Raises:
            InvariantBroken: a checker found what must not happen.
        """
        until_us = min(round(1e6 * time_s), self.plan.duration_us)
        while self._running.advance(until_us, self._running.slice_events) != DONE:
            pass
        self._running.take()

    def counters(self) -> list[int]:
        """The counters of sim/wires.py up to now."""
        return [int(count) for count in self.world.counters]
