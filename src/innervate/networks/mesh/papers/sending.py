"""Messages under dead nodes that nobody knows of: the first of every source, and later ones."""

from __future__ import annotations

from typing import Any, NamedTuple

from innervate.networks.mesh.analysis.messages import duplicates, messages
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.analysis.summary import connected, looped
from innervate.networks.mesh.papers.testbed import (
    LITERAL,
    MeshTestbed,
    Options,
    dying,
    kill,
    send_rounds,
)
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers.experiment import Point

DEATHS_US = 7_000_000  # tables are there, and the next discovery is far
ROUNDS = 4
EVERY_US = 2_000_000
# No discovery between the deaths and the last message.
QUIET: Options = (("period_s", 60.0), ("period_max_s", 60.0))
DURATION_S = (DEATHS_US + ROUNDS * EVERY_US) / 1e6 + 2.5


class Rule(NamedTuple):
    """What is done when a hop does not answer."""

    name: str
    protocol: Options


DOCUMENT = Rule("document", LITERAL)
RANDOM, RSSI, ALTERNATE, SEARCH, GRAPH = (
    Rule(name, (("failover", name),)) for name in ("random", "rssi", "alternate", "search", "graph")
)
RULES = (DOCUMENT, RANDOM, RSSI, ALTERNATE, SEARCH, GRAPH)


def point(rule: Rule, dead: int, seeds: range, reliable: bool = True) -> Point:
    """The networks of a rule; not `reliable` = no second try from end to end either."""
    again: Options = () if reliable or rule is DOCUMENT else (("reliable", False),)
    testbed = MeshTestbed(protocol=(*QUIET, *rule.protocol, *again), duration_s=DURATION_S)
    return testbed.point(f"{dead} dead", seeds, measure, dead)


def measure(of: MeshTestbed, dead: int, seed: int) -> dict[str, Any]:
    """Messages of live nodes among themselves, after `dead` died; only of connected ones."""
    plan = of.plan(seed)
    gone = dying(plan, dead)
    kill(plan, gone, DEATHS_US)
    alive = [node for node in range(plan.nodes) if node not in gone]
    send_rounds(plan, alive, ROUNDS, DEATHS_US, EVERY_US)
    result = simulate(plan)
    found, ground = messages(result), Ground(plan)
    rounds = [connected(found.only(found.flow == k), ground) for k in range(ROUNDS)]
    return {
        "first": [rounds[0]["delivered"], rounds[0]["sent"]],
        "later": [sum(r[name] for r in rounds[1:]) for name in ("delivered", "sent")],
        "duplicates": duplicates(result),
        "looped": looped(result),
    }


def share(runs: dict[str, Any], which: str) -> tuple[int, int]:
    """Delivered, of how many, in the "first" or "later" rounds."""
    came, sent = (sum(counts) for counts in zip(*runs[which], strict=True))
    return came, sent
