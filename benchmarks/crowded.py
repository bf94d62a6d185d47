"""python -m benchmarks.crowded [NODES [SEED ...]]: what a field is full of, by kind of frame.

Of the comparison's case in which nobody dies (docs/compare.md), for RPL in storing mode, the same
with DelayDAO ten times as long, and the mesh: messages that came, the parents that RPL changed, and
airtime of all nodes by kind of frame, before anybody writes (20 s) and while all do.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

from innervate.network import networks
from innervate.networks.mesh.analysis.messages import NEVER as LOST
from innervate.networks.mesh.analysis.messages import messages
from innervate.networks.mesh.papers import comparison
from innervate.networks.mesh.protocol.constants import END_TO_END
from innervate.networks.mesh.sim.simulate import simulate
from innervate.networks.rpl.protocol.constants import REPORT_PARENT
from innervate.papers.in_field import World, plan_in
from innervate.scenario.cables import Input
from innervate.scenario.declared.field import sizes_of

RPL = {1: "DIO", 2: "DIS", 3: "DAO", 5: "data"}
MESH = {1: "request", 2: "response", 3: "table", 4: "table ack", 8: "data", 9: "end to end"}


def told(name: str, seed: int, came: int, world: World, spent: Any, kinds: dict[int, str]) -> None:
    """A line of what came, and one of airtime for each half."""
    print(f"{name}, seed {seed}: {100 * came / len(world.sent):.1f} % of all messages")
    spans = (world.since_us, world.duration_us - world.since_us)
    for words, by_kind, span in zip(("before", "then"), spent, spans, strict=True):
        shares = {kinds.get(k, "ack"): 100 * float(us) / span for k, us in enumerate(by_kind) if us}
        print(f"  {words}:", ", ".join(f"{kind} {share:.1f} %" for kind, share in shares.items()))


def by_kind(kinds: Any, us: Any, late: Any) -> Any:
    """Airtime by kind, before and then."""
    return [np.bincount(kinds[part], weights=us[part], minlength=17) for part in (~late, late)]


def rpl(world: World, seed: int, **protocol: int) -> None:
    """One run of RPL."""
    network = networks()["rpl"]
    plan = plan_in("rpl", {"root": world.gateway, **protocol}, world)
    plan.inputs += [Input(one.at_us, one.source, 1, {"dest": one.dest}) for one in world.sent]
    sizes, air = sizes_of(network.frames), world.air
    cost = np.array([(air["phy_bytes"] + sizes.get(k, 0)) * air["byte_ns"] // 1000
                     for k in range(17)])  # fmt: skip
    spent = np.zeros((2, 17))

    def tap(rows: Any, frames: Any, until_us: int) -> None:
        out = rows["out"] == 1
        kinds = frames["kind"][out]
        spent[:] += by_kind(kinds, cost[kinds], rows["time"][out] >= world.since_us)

    rows = network.simulation(plan, checks=False, observe=True, tap=True).finish(None, tap).rows
    to = {one.at_us: one.dest for one in world.sent}
    deliveries = rows["deliveries"]
    begun = (deliveries["time"] - deliveries["latency"]).tolist()
    came = {at for at, node in zip(begun, deliveries["node"].tolist(), strict=True)
            if to.get(at) == node}  # fmt: skip
    name = f"RPL, DelayDAO {plan.params['dao_us'] / 1e6:g} s"
    told(name, seed, len(came), world, spent, RPL)
    moved = rows["rows"]["time"][rows["rows"]["code"] == REPORT_PARENT]
    print(f"  parents changed: {(moved < world.since_us).sum()}, {(moved >= world.since_us).sum()}")


def mesh(given: dict[str, Any], world: World, seed: int) -> None:
    """One run of a mesh."""
    plan = comparison.plan_of(given, seed)
    plan.offers = [comparison._offer(one, END_TO_END) for one in world.sent]
    result = simulate(plan, checks=False)
    sent = result.sent
    late = sent["time"] >= world.since_us
    spent = by_kind(sent["kind"], sent["end"] - sent["time"], late)
    came = int((messages(result).delivered_us != LOST).sum())
    told("mesh", seed, came, world, spent, MESH)


def main() -> None:
    """Measure and print."""
    words = [int(word) for word in sys.argv[1:]] or [254]
    for seed in words[1:] or range(1, 6):
        given = {"world": comparison.HERE, "rounds": 2, "nodes": words[0], "dead": 0}
        world = comparison.world(given, seed)
        rpl(world, seed)
        rpl(world, seed, dao_us=2_000_000)
        mesh(given, world, seed)


if __name__ == "__main__":
    main()
