"""Messages under dead nodes that nobody knows of: the first of every source, and later ones."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from innervate.networks.mesh.analysis.messages import duplicates, latencies_us, messages
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.analysis.summary import connected, looped, stretch
from innervate.networks.mesh.papers.testbed import (
    LITERAL,
    MeshTestbed,
    Options,
    dying,
    kill,
    send_rounds,
)
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers.experiment import Results

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


def _rule(failover: str) -> Rule:
    return Rule(failover, (("failover", failover),))


DOCUMENT = Rule("document", LITERAL)
SEARCH = _rule("search")
GRAPH = _rule("graph")
RULES = (DOCUMENT, _rule("random"), _rule("rssi"), _rule("alternate"), SEARCH, GRAPH)


def make_testbed(rule: Rule, reliable: bool = True, more: Options = ()) -> MeshTestbed:
    """The networks of a rule; not `reliable` = no second try from end to end either."""
    again: Options = () if reliable or rule is DOCUMENT else (("reliable", False),)
    return MeshTestbed(protocol=(*QUIET, *rule.protocol, *again, *more), duration_s=DURATION_S)


def measure(of: MeshTestbed, seed: int, dead: int) -> dict[str, Any]:
    """Messages of live nodes among themselves, after `dead` died; only of connected ones."""
    plan = of.plan(seed)
    gone = dying(plan, dead)
    kill(plan, gone, DEATHS_US)
    alive = [node for node in range(plan.nodes) if node not in gone]
    send_rounds(plan, alive, ROUNDS, DEATHS_US, EVERY_US)
    result = simulate(plan)
    found, ground = messages(result), Ground(plan)
    rounds = [connected(found.only(found.flow == k), ground) for k in range(ROUNDS)]
    waited = latencies_us(found.only(found.flow == 0)) / 1e3
    return {
        "first": [rounds[0]["delivered"], rounds[0]["sent"]],
        "later": [sum(r[name] for r in rounds[1:]) for name in ("delivered", "sent")],
        "duplicates": duplicates(result),
        "looped": looped(result),
        "stretch": stretch(found, ground)["mean"],
        "waited_ms": np.round(waited, 3).tolist(),
        "hops": found.hops[(found.flow == 0) & (found.hops > 0)].tolist(),
    }


def point(of: MeshTestbed, dead: int, seeds: range) -> Any:
    """The point of so many dead."""
    return of.point(f"{dead} dead", seeds, measure, dead)


def told(results: Results, of: MeshTestbed, dead: int, seeds: range) -> list[dict[str, Any]]:
    """What was measured with so many dead, one dict for each seed."""
    runs: list[dict[str, Any]] = results[of.key_of(f"{dead} dead", seeds)]
    return runs


def share(runs: list[dict[str, Any]], which: str) -> tuple[int, int]:
    """Delivered, of how many, in the "first" or "later" rounds."""
    came, sent = np.sum([run[which] for run in runs], axis=0).tolist()
    return came, sent
