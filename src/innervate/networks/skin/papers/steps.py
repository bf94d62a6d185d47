"""A simulation in steps, to look into it while it runs: penalties, counters, loads."""

from __future__ import annotations

from typing import Any

from innervate import scenario
from innervate.networks.skin.protocol.constants import RULE_PAPER
from innervate.networks.skin.scenario.plan import Plan
from innervate.networks.skin.sim.simulate import SLICE_EVENTS, InvariantBroken, compiled_loop
from innervate.scenario import Scenario
from innervate.sim.cables import build
from innervate.sim.status import BROKEN, DONE, POOL_FULL, ROWS_FULL
from innervate.sim.tables import put

RULE_STATIC = RULE_PAPER + 1


class Steps:
    """Runs a scenario up to given times; between them `world` may be read.

    Rows that the run reports are dropped when their table is full: what is asked of it here is
    its state.
    """

    def __init__(self, source: Scenario | dict[str, Any], seed: int | None = None) -> None:
        made = source if isinstance(source, Scenario) else scenario.from_dict(source, seed=seed)
        self.plan: Plan = scenario.plan(made)
        self.world: Any = build.build(self.plan)
        self._advance = compiled_loop(self.plan.params["rule"] == RULE_STATIC)

    def to(self, time_s: float) -> None:
        """Run up to, not including, a time.

        Raises:
            InvariantBroken: a checker found what must not happen.
        """
        until = min(round(1e6 * time_s), self.plan.duration_us)
        while True:
            self._advance(self.world, until, SLICE_EVENTS)
            status = int(self.world.run["status"][0])
            if status == DONE:
                return
            if status == BROKEN:
                raise InvariantBroken(f"invariant broken (seed {self.plan.seed})")
            if status == POOL_FULL:
                self.world = build.grow_pool(self.world)
            elif status == ROWS_FULL:
                put(self.world.run, 0, rows=0)

    def counters(self) -> list[int]:
        """The counters of sim/wires.py up to now."""
        return [int(count) for count in self.world.counters]
