"""Whole networks drawn from one number: settings, sizes and faults; the checkers are always on.

A network that breaks something is made smaller as long as it still does, and saved as a scenario.
Which ones there are, their parts `random` say: `SHARE`, from where to where in 0 .. 1
a first number has to lie for one to be drawn; `drawn(generator, seed)`; `smaller(tables)`; and
`trouble(summary)`, what a run broke, where there is something that no checker is for.
"""

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from innervate import scenario as scenarios
from innervate.network import networks
from innervate.running.run import run
from innervate.scenario.shrink import Tables
from innervate.sim.driver import InvariantBroken

TRIES = 400


@dataclass(frozen=True, slots=True)
class Broken:
    """A network that breaks something."""

    seed: int  # what it was drawn from
    why: str  # what is broken, in one line
    tables: Tables  # the scenario, made as small as it goes
    tries: int  # how many smaller ones were tried

    def save(self, folder: Path) -> Path:
        """Write the scenario; `innervate run` plays it."""
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"broken-{self.seed}.toml"
        loaded = scenarios.from_dict(self.tables)
        path.write_text(f"# {self.why}\n{scenarios.dump(loaded)}", encoding="utf-8")
        return path


def drawn(seed: int) -> Tables:
    """The scenario that a number stands for."""
    draw = random.Random(f"wild/{seed}")
    share = draw.random()
    for network in networks().values():
        if network.has("random") and network.random.SHARE[0] <= share < network.random.SHARE[1]:
            made: Tables = network.random.drawn(draw, seed)
            return made
    raise LookupError("no network has this share of the networks that are drawn")


def trouble(tables: Tables) -> str:
    """What this scenario breaks, in one line; "" nothing."""
    try:
        done = run(scenarios.from_dict(tables))
    except InvariantBroken as error:
        return str(error)
    part = networks()[tables["kind"]].random
    return str(part.trouble(done.summary)) if hasattr(part, "trouble") else ""


def smaller(tables: Tables) -> Iterator[Tables]:
    """Simpler scenarios next to this one."""
    events = tables.get("event", [])
    for half in (events[: len(events) // 2], events[len(events) // 2 :]):
        if len(half) < len(events):
            yield tables | {"event": half}
    for i in range(len(events)):
        yield tables | {"event": events[:i] + events[i + 1 :]}
    yield from networks()[tables["kind"]].random.smaller(tables)


def shrink(tables: Tables, breaks: Callable[[Tables], str]) -> tuple[Tables, int]:
    """The smallest scenario found that still breaks something, and how many were tried."""
    tries = 0
    found = True
    while found and tries < TRIES:
        found = False
        for candidate in smaller(tables):
            tries += 1
            if tries >= TRIES:
                break
            try:
                still = bool(breaks(candidate))
            except scenarios.ScenarioError:
                continue  # what an event speaks of is gone
            if still:
                tables, found = candidate, True
                break
    return tables, tries


def attempt(seed: int, breaks: Callable[[Tables], str] = trouble) -> Broken | None:
    """Draw a network, run it; what it breaks, made small."""
    tables = drawn(seed)
    why = breaks(tables)
    if not why:
        return None
    small, tries = shrink(tables, breaks)
    return Broken(seed, breaks(small), small, tries)
