"""Mesh plans for tests, without a scenario file."""

from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.scenario.plan import ONE, MeshPlan, MeshRadio, Offer
from innervate.networks.mesh.sim.simulate import simulate
from innervate.topology.placement import UNHEARD
from tests.fixtures.scenarios import plan_head
from tests.networks.mesh import pinger as mesh_pinger

LOUD = -6_000  # 0.01 dBm: received for certain
TICK_US = 1_000_000
BYTE_NS = 32_000  # 250 kbit/s
TURN_US = 192


def radio(n, rssi=None, prob=ONE, **more):
    """A medium; `rssi` is {(sender, receiver): 0.01 dBm}, all pairs LOUD by default."""
    levels = [UNHEARD] * (n * n)
    if rssi is None:
        rssi = {(i, j): LOUD for i in range(n) for j in range(n) if i != j}
    for (i, j), level in rssi.items():
        levels[i * n + j] = level
    values = {
        "byte_ns": BYTE_NS,
        "phy_bytes": 6,
        "turnaround_us": TURN_US,
        "collisions": True,
        "sense_cdb": -9_800,
        "capture_cdb": 600,
        "rssi50_cdb": -9_500,
        "rssi_cdb": levels,
        "prob_q15": [prob if level > UNHEARD else 0 for level in levels],
    }
    return MeshRadio(**(values | more))


def both_ways(links):
    """{(a, b): level} as it is for a, b and for b, a."""
    return {pair: level for (a, b), level in links.items() for pair in ((a, b), (b, a))}


def parameters(n, capacity, **more):
    """Parameters at the value in range nearest 0, but for those that every run needs."""
    params = {
        name: [min(max(0, low), high)] * length if length else min(max(0, low), high)
        for name, length, low, high, *_ in mesh_fields.PARAMS
    }
    row_bytes = mesh_fields.row_bytes(capacity)
    needed = {
        "nodes": n,
        "row": row_bytes,
        "told": 1,
        "tick_us": TICK_US,
        "width": capacity,
        "forget": 60,
    }
    return params | needed | more


def mesh_plan(n, medium=None, offers=(), duration_s=2.0, seed=1, capacity=32, params=None, **more):
    """A plan; `offers` are (us, node, dest, length), all nodes start at time 0."""
    plan = MeshPlan(
        **plan_head("mesh", seed, duration_s),
        nodes=n,
        capacity=capacity,
        names=[f"n{i}" for i in range(n)],
        params=parameters(n, capacity, **(params or {})),
        ranks=[0] + [-1] * (n - 1),
        robots=[0] * n,
        absent=[0] * n,
        starts_us=[0] * n,
        mac="csma",
        mac_params={"backoff_us": 320},
        radio=medium or radio(n),
        positions_cm=[],
        good=[],
        offers=[Offer(at, node, dest, 0, length, 0) for at, node, dest, length in offers],
    )
    for name, value in more.items():
        setattr(plan, name, value)
    return plan


def run(plan, plain=True, **more):
    """Run such a plan with the pinger."""
    return simulate(plan, plain=plain, entry=mesh_pinger, **more)
