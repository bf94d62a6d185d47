"""What several figures of the skin paper share: rules, skins, recoveries after a cut."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate import scenario
from innervate.networks.skin.analysis.recovery import recoveries
from innervate.networks.skin.analysis.rows import loop_episodes
from innervate.networks.skin.scenario.plan import Plan
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers.experiment import Measured, Point
from innervate.plot import style
from innervate.sim.cables.simulation import Result

SETUPS = tuple(f"setup-{i}" for i in range(1, 9))
SETTLE_PERIODS = 60  # until nothing changes any more: listening, the deepest cell, its fresh number
DRAWN_PERIODS = 5  # the cut comes at a random moment of these
WATCH_PERIODS = 100
INTERFACE = 1  # the port whose cable is cut
SILENT = {"data.rate_hz": 0}


class Rule(NamedTuple):
    """A rule of Algorithm 2, its M (0 = min(k, 5)), and what claims call it."""

    name: str
    m: int
    words: str = ""

    def case(self, setup: str, hz: float, k: int, cut: str = f"interface {INTERFACE}") -> Case:
        """Recoveries under it, with periodic beacons."""
        return Case(setup, hz, k, self.name, "periodic", self.m, cut)


# Those of which several figures show the recoveries.
RULES = (
    Rule("feasible", 0, "rule feasible"),
    Rule("paper", 1, "printed rule"),
    Rule("paper-lax", 1, "printed rule, laxer reading"),
)


def planned(
    setup: str, seed: int, duration_s: float, more: Mapping[str, Any] | None = None, **protocol: Any
) -> Plan:
    """The plan of a bundled skin without its events.

    `more` are other keys of the scenario, dotted; of those of [protocol] None leaves one as it is.
    """
    set_ = {f"protocol.{name}": value for name, value in protocol.items() if value is not None}
    changes = {**set_, "event": [], "duration_s": duration_s, **(more or {})}
    made: Plan = scenario.plan(scenario.load(setup, changes.items(), seed))
    return made


def tabled(tables: dict[str, Any], seed: int) -> Plan:
    """The plan of a scenario given as tables."""
    made: Plan = scenario.plan(scenario.from_dict(tables, seed=seed))
    return made


def simulated(tables: dict[str, Any], seed: int, **options: Any) -> Result:
    """Run a scenario given as tables."""
    return simulate(tabled(tables, seed), **options)


def plan_of(setup: str) -> Plan:
    """A bundled skin in which nothing happens."""
    made: Plan = scenario.plan(scenario.load(setup, [("event", [])]))
    return made


@dataclass(frozen=True, slots=True)
class Case:
    """A skin whose cable is cut once it has settled."""

    setup: str  # a bundled scenario
    beacon_hz: float
    k: int
    rule: str = "feasible"
    updates: str = "periodic"
    m: int = 0  # periods between sequence numbers; 0 = the default, min(k, 5)
    cut: str = f"interface {INTERFACE}"  # "interface 1", or "random link"
    gap_us: int = -1  # least time between two triggered beacons of a cell; -1 = the default, 500

    @property
    def period_ms(self) -> float:
        """The beacon period T_b, ms."""
        return 1000.0 / self.beacon_hz

    def __str__(self) -> str:
        """All of it in words."""
        number = f"m={self.m}" if self.m else "m=min(k,5)"
        number += f", gap {self.gap_us} us" if self.gap_us >= 0 else ""
        return (
            f"recovery {self.setup} {self.rule} {self.updates} {self.beacon_hz:g} Hz k={self.k} "
            f"{number}, {self.cut}"
        )

    def plan(self, seed: int) -> Plan:
        """The plan of one run."""
        period = 1 / self.beacon_hz
        settled = SETTLE_PERIODS * period
        what, which = self.cut.split()
        whose = {"random": which} if what == "random" else {what: int(which)}
        event = {"action": "cut", "at_s": [settled, settled + DRAWN_PERIODS * period], **whose}
        duration_s = settled + (DRAWN_PERIODS + self.k + WATCH_PERIODS) * period
        return planned(
            self.setup, seed, duration_s, SILENT | {"event": [event]}, rule=self.rule,
            updates=self.updates, beacon_hz=self.beacon_hz, k=self.k, m=self.m or None,
            gap_us=self.gap_us if self.gap_us >= 0 else None,
        )  # fmt: skip

    def point(self, seeds: int) -> Point:
        """The point that measures its recoveries, of so many seeds."""
        return Point.each(str(self), 0.02, seeds, recovery, self)

    def periods(self, got: Measured, seeds: int, name: str) -> Any:
        """A time of every seed in beacon periods; NaN where it did not happen."""
        return got.floats(self.point(seeds), name) / self.period_ms


def recovery(case: Case, seed: int) -> dict[str, Any]:
    """Everything a recovery has, and how many loops there were."""
    result = simulate(case.plan(seed))
    return {**recoveries(result)[0], "loops": len(loop_episodes(result).cell)}


def mean_of(values: Any) -> float:
    """Mean of what did happen."""
    return float(np.nanmean(values))


def rule_panels(height_in: float, drawn: Callable[[Axes, Rule], None]) -> tuple[Figure, Axes]:
    """A panel a rule, with its letter and name, `drawn` on it; the figure and its first panel."""
    figure, axes = style.panels(style.WIDE_IN, height_in, 1, len(RULES), sharey=True)
    for ax, letter, rule in zip(axes, "abc", RULES, strict=True):
        ax.set_title(f"{letter}  {rule.words}")
        drawn(ax, rule)
    return figure, axes[0]


def number(setup: str) -> str:
    """A setup in claims and at axes."""
    return f"setup {setup[-1]}"
