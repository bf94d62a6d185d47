"""The mesh's simulator, compiled and plain: the same rows, states and fingerprint."""

import functools

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.protocol.constants import ALL, DATA, PARITY
from innervate.networks.mesh.scenario.plan import ONE, MeshFault, Offer
from innervate.networks.mesh.sim.simulate import simulate
from innervate.scenario import from_dict, load
from innervate.scenario import plan as plan_of
from innervate.scenario.actions.field import CUT, JAM, KILL, QUIET, RESTART, RESTORE, REVIVE
from innervate.scenario.robots import Walk
from innervate.sim.tables import uniform
from innervate.topology.placement import UNHEARD
from tests.networks.mesh.runs import mesh_plan, radio, run

QUIET_RUN = settings(deadline=None, suppress_health_check=list(HealthCheck))
TABLES = ("rows", "sent", "delivered", "rounds", "trail")
END_US = 300_000


@st.composite
def plans(draw):
    """Small networks in every kind of trouble, for a fraction of a second."""
    n = draw(st.integers(1, 7))
    seed = draw(st.integers(0, 2**32))
    levels = (-10_500 + uniform(seed, "levels", n * n, 6_000)).tolist()
    links = {
        (i, j): levels[i * n + j]
        for i in range(n)
        for j in range(n)
        if i != j and levels[i * n + j] % 5
    }
    chance = draw(st.sampled_from([ONE, ONE * 3 // 4]))
    more = {"collisions": draw(st.sampled_from([True, True, False]))}
    places = (uniform(seed, "places", 2 * n, 3_000)).tolist()
    if draw(st.booleans()):
        more["base_cdb"] = [UNHEARD if i == j else -5_500 for i in range(n) for j in range(n)]
    moments, node = st.integers(0, END_US - 1), st.integers(0, n - 1)
    told = draw(st.lists(st.tuples(moments, node, st.integers(0, 40)), max_size=25))
    action = st.sampled_from([KILL, REVIVE, CUT, RESTORE, JAM, QUIET, RESTART])
    trouble = draw(st.lists(st.tuples(moments, action, node, node), max_size=8))
    trouble = [
        (at, what, i, j) for at, what, i, j in trouble if i != j or what not in (CUT, RESTORE)
    ]
    robot = draw(node)
    errs = draw(st.sampled_from([(0, 0), (400_000, 0), (90_000_000, 50_000)]))
    plan = mesh_plan(
        n,
        radio(n, links, chance, **more),
        duration_s=END_US / 1e6,
        seed=seed,
        mac=draw(st.sampled_from(["csma", "csma", "none"])),
        params={"period": draw(st.sampled_from([0, 2])), "tick_us": 40_000, "unit_cm": 1},
        faults=[MeshFault(at, what, i, j, -8_000, 0) for at, what, i, j in sorted(trouble)],
        absent=draw(st.lists(st.sampled_from([0, 0, 0, 1]), min_size=n, max_size=n)),
        starts_us=[700 * i for i in range(n)],
        positions_cm=[(places[2 * i], places[2 * i + 1]) for i in range(n)],
        robots=[int(i == robot) for i in range(n)],
        walks=[Walk(robot, ((0, 0, 0), (END_US // 2, 900, 400), (END_US, 900, -100)), *errs)],
    )
    plan.offers = [
        Offer(at, i, draw(st.sampled_from([255, (i + 1) % n])), 0, size, 0)
        for at, i, size in sorted(told)
    ]
    return plan


def states(result):
    """All words of all nodes at the end."""
    nodes = result.world.nodes
    found = []
    for name, length, *_ in mesh_fields.node(result.plan.capacity):
        for node in nodes:
            value = getattr(node, name) if isinstance(nodes, list) else node[name]
            found.append([int(item) for item in value] if length else int(value))
    return found


@functools.cache
def bundled():
    return plan_of(load("mesh-field")).params


def hurried(plan):
    """The same network with the mesh itself, whose rounds take a fraction of a second."""
    fast = {"tick_us": 20_000, "listen_us": 5_000, "spread_us": 40_000, "collect_us": 60_000,
            "e2e_us": 40_000, "job_us": 30_000, "jitter_us": 5_000}  # fmt: skip
    plan.params = bundled() | fast | {"nodes": plan.nodes}
    return plan


def check(plan, simulated=run):
    one, other = (simulated(plan, plain=plain, trail=True) for plain in (False, True))
    for name in TABLES:
        assert np.array_equal(getattr(one, name), getattr(other, name)), f"{name}, {plan}"
    assert one.counts == other.counts
    assert states(one) == states(other), plan
    assert one.fingerprint == other.fingerprint, plan


@given(plans())
@settings(QUIET_RUN, max_examples=12)
def test_compiled_equals_plain(plan):
    check(hurried(plan), simulate)


def test_what_a_node_says_to_itself_is_none_of_what_it_numbers():
    """A message to oneself has its handle for a number, which an alarm of its own may have, too."""
    walk = Walk(0, ((0, 0, 0), (END_US // 2, 900, 400), (END_US, 900, -100)))
    places = {"positions_cm": [(2244, 2604)], "robots": [1], "walks": [walk]}
    plan = mesh_plan(1, radio(1, {}, ONE), duration_s=END_US / 1e6, seed=0, starts_us=[0], **places)
    plan.offers = [Offer(0, 0, dest, 0, 0, 0) for dest in (255, 0)]
    found = simulate(hurried(plan), plain=True)
    assert found.delivered["seq"].tolist() == [1, 1, 2]


def test_compiled_equals_plain_where_there_is_much_traffic():
    n = 12
    offers = [(1_000 + 3_000 * k, k % n, 255, k % 60) for k in range(90)]
    check(hurried(mesh_plan(n, offers=offers, duration_s=0.3)), simulate)


@pytest.mark.parametrize("protocol", [
    {"on_demand": True}, {"on_demand": True, "tables": False}, {"failover": "heard"},
])  # fmt: skip
def test_compiled_equals_plain_by_the_rules_that_are_chosen(protocol):
    """All send from the first moment on; half of them die. Nobody floods one try twice."""
    flow = {"from": "random", "to": "random", "pairs": 8, "every_s": 0.5, "start_s": 0.0}
    deaths = [{"at_s": 3.0, "action": "kill", "node": node} for node in range(1, 7)]
    plan = plan_of(from_dict({"kind": "mesh", "nodes": 14, "duration_s": 4.0, "seed": 5,
                              "protocol": protocol, "flow": [flow], "event": deaths}))  # fmt: skip
    check(plan, simulate)
    sent = simulate(plan).sent
    floods = sent[(sent["kind"] == DATA) & (sent["link_dst"] == ALL)]
    tries = [
        tuple(map(int, (f["node"], f["origin"], f["seq"], f["flags"] & PARITY))) for f in floods
    ]
    assert bool(tries) == ("on_demand" in protocol)
    assert len(set(tries)) == len(tries)


@pytest.mark.slow
@given(plans())
@settings(QUIET_RUN, max_examples=600)
def test_many_compiled_runs_equal_plain_ones(plan):
    check(plan)
    check(hurried(plan), simulate)
