"""Timers by the number of nodes."""

from typing import Any

import pytest

import innervate
from innervate.networks.mesh.scenario.plan import MeshPlan
from innervate.networks.mesh.scenario.words import warnings
from innervate.scenario import loads, plan

WAITING = "standby = [1]\nprotocol.guard_s = 0"  # for requests alone


def made(text: str, *sets: Any) -> MeshPlan:
    found = plan(loads(f'kind = "mesh"\n{text}', sets))
    assert isinstance(found, MeshPlan)
    return found


def test_rounds_of_many_nodes_take_their_time() -> None:
    """As long as ever up to 32 nodes, or where a standby waits for them; what is chosen stands."""
    names = ("jitter_us", "flood_us", "listen_us", "spread_us", "collect_us", "period", "job_tries")
    few, crowd, asking, late = (
        [made(f"nodes = {n}\n{more}").params[name] for name in names]
        for n, more in ((32, ""), (64, ""), (64, "standby = [1]"), (64, WAITING))
    )
    assert few == [100_000, 12_500, 300_000, 400_000, 1_500_000, 10, 3]
    assert crowd == [200_000, 12_500, 600_000, 1_200_000, 2_866_667, 30, 6]
    assert asking == crowd
    assert late == [*crowd[:5], 10, 6]
    chosen = made("nodes = 64", "protocol.spread_s=1", "protocol.period_s=20").params
    assert (chosen["spread_us"], chosen["period"], chosen["period_max"]) == (1_000_000, 20, 60)
    assert made("nodes = 254").params["period"] == made("nodes = 254").params["period_max"] == 149
    assert made("nodes = 64\nradio.profile = 'ip'").params["period"] == 8


@pytest.mark.parametrize(("nodes", "failover", "often"), [
    (32, "search", (2, 3, 0)), (33, "search", (3, 5, 1)), (33, "alternate", (3, 5, 1)),
    (33, "graph", (2, 3, 0)), (33, "auto", (2, 3, 0)), (33, "random", (2, 3, 0)),
    (33, "rssi", (2, 3, 0)),
])  # fmt: skip
def test_where_many_are_requests_and_hops_are_tried_more_often(nodes, failover, often):
    """But not where everybody floods the graph, nor by the document's own rules."""
    params = made(f"nodes = {nodes}", f"protocol.failover='{failover}'").params
    assert (params["copies"], params["transmissions"], params["asks"]) == often


@pytest.mark.slow
@pytest.mark.parametrize(
    ("radio", "nodes", "seconds"), [("250k", 64, 30), ("250k", 150, 60), ("38k4", 120, 300)]
)
def test_all_have_tables_of_a_first_round_that_saw_nearly_all_links(radio, nodes, seconds):
    """Of 20 networks each, drawn as the scenario says nothing of them; in one somebody may wait."""
    given = {"kind": "mesh", "nodes": nodes, "duration_s": seconds, "radio": {"profile": radio}}
    late = []
    for seed in range(3001, 3021):
        found = innervate.run(given, seed=seed).summary["discovery"]
        assert found["recall"] >= 0.98, seed
        late += [seed] * (found["with_tables"] < nodes)
    assert len(late) <= 1, late


@pytest.mark.parametrize(
    ("more", "most"),
    [("", 200), ("standby = [1]", 200), (WAITING, 120), ("radio.profile = '38k4'", 50)],
)
def test_more_nodes_than_tables_reach_in_time_are_warned_of(more: str, most: int) -> None:
    few, many = (warnings(made(f"nodes = {n}\n{more}")) for n in (most, most + 1))
    assert not any("will not be everywhere" in line for line in few)
    assert any(f"more than {most} fill a" in line for line in many)


@pytest.mark.parametrize(("more", "warned"), [("", False), ("protocol.asks = true", True)])
def test_a_round_is_not_over_before_those_that_are_asked_again_have_answered(more, warned):
    """Of 200 nodes answers are collected for 7.4 s, and as long again."""
    told = warnings(made(f"nodes = 200\n{WAITING}\nprotocol.failover = 'random'\n{more}"))
    said = "a round every 10 s, but answers are collected for 14.8 s: no round is ever complete"
    assert any(said in line and "raise protocol.period_s to 15" in line for line in told) == warned
