"""What several figures of the skin paper share: setups, recoveries after a cut, words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from innervate import scenario
from innervate.networks.skin.analysis.rows import loop_episodes
from innervate.networks.skin.analysis.summary import recoveries
from innervate.networks.skin.scenario.plan import Plan
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers.experiment import Point, Results
from innervate.sim.cables.simulation import Result

# Rules of which several figures show the recoveries, with their M (0 = min(k, 5)), and their names.
RULES = (("feasible", 0), ("paper", 1), ("paper-lax", 1))
RULE_NAMES = {
    "feasible": "rule feasible",
    "paper": "printed rule",
    "paper-lax": "printed rule, laxer reading",
}
SETTLE_PERIODS = 60  # until nothing changes any more: listening, the deepest cell, its fresh number
DRAWN_PERIODS = 5  # the cut comes at a random moment of these
WATCH_PERIODS = 100
INTERFACE = 1  # the port whose cable is cut


@dataclass(frozen=True, slots=True)
class Case:
    """A skin whose cable is cut once it has settled.

    Attributes:
        setup: a bundled scenario.
        cut: "interface 1", or "random link".
        m: periods between sequence numbers; 0 = the default, min(k, 5).
        gap_us: least time between two triggered beacons of a cell; -1 = the default, 500.
    """

    setup: str
    beacon_hz: float
    k: int
    rule: str = "feasible"
    updates: str = "periodic"
    m: int = 0
    cut: str = f"interface {INTERFACE}"
    gap_us: int = -1

    @property
    def period_ms(self) -> float:
        """The beacon period T_b, ms."""
        return 1000.0 / self.beacon_hz

    def key(self, seeds: Sequence[int]) -> str:
        """All of it in words."""
        number = f"m={self.m}" if self.m else "m=min(k,5)"
        number += f", gap {self.gap_us} us" if self.gap_us >= 0 else ""
        return (
            f"recovery {self.setup} {self.rule} {self.updates} {self.beacon_hz:g} Hz k={self.k} "
            f"{number}, {self.cut}, seeds {seeds[0]}-{seeds[-1]}"
        )

    def plan(self, seed: int) -> Plan:
        """The plan of one run."""
        period = 1 / self.beacon_hz
        settled = SETTLE_PERIODS * period
        event: dict[str, Any] = {
            "action": "cut",
            "at_s": [settled, settled + DRAWN_PERIODS * period],
        }
        what, which = self.cut.split()
        event |= {"random": which} if what == "random" else {what: int(which)}
        overrides: list[tuple[str, Any]] = [
            ("protocol.rule", self.rule),
            ("protocol.updates", self.updates),
            ("protocol.beacon_hz", self.beacon_hz),
            ("protocol.k", self.k),
            ("data.rate_hz", 0),
            ("event", [event]),
            ("duration_s", settled + (DRAWN_PERIODS + self.k + WATCH_PERIODS) * period),
        ]
        if self.m:
            overrides.append(("protocol.m", self.m))
        if self.gap_us >= 0:
            overrides.append(("protocol.gap_us", self.gap_us))
        made: Plan = scenario.plan(scenario.load(self.setup, overrides, seed))
        return made


def measure_recoveries(case: Case, seeds: Sequence[int]) -> dict[str, list[Any]]:
    """One number a seed of everything a recovery has, and how many loops there were."""
    found: dict[str, list[Any]] = {}
    for seed in seeds:
        result = simulate(case.plan(seed))
        one = recoveries(result)[0] | {"loops": len(loop_episodes(result).cell)}
        for name, value in one.items():
            found.setdefault(name, []).append(value)
    return found


def recovery_point(case: Case, seeds: Sequence[int]) -> Point:
    """The point of a case: measure_recoveries over the seeds."""
    return Point.of(case.key(seeds), 0.02 * len(seeds), measure_recoveries, case, seeds)


def periods(results: Results, case: Case, seeds: Sequence[int], name: str) -> Any:
    """A time of every seed in beacon periods; NaN where it did not happen."""
    values = results[case.key(seeds)][name]
    return np.array([np.nan if ms is None else ms for ms in values]) / case.period_ms


def seeds_of(count: int) -> range:
    """The seeds 1 .. count."""
    return range(1, count + 1)


def simulated(tables: dict[str, Any], seed: int, **options: Any) -> Result:
    """Run a scenario given as tables."""
    return simulate(scenario.plan(scenario.from_dict(tables, seed=seed)), **options)


def percent(share: float, digits: int = 0) -> str:
    """A share, 0 to 1, as "12 %"."""
    return f"{100 * share:.{digits}f} %"


def mean_of(values: Any) -> float:
    """Mean of what did happen."""
    return float(np.nanmean(values))


def joined(words: Iterable[Any]) -> str:
    """Things as text, with commas between them."""
    return ", ".join(str(word) for word in words)
