"""Keys of [protocol] for the document's rule by both its words, and for ways on demand."""

from __future__ import annotations

import pytest

from innervate.networks.mesh.scenario.plan import MeshPlan
from innervate.scenario import ScenarioError, loads, plan


def made(text: str) -> MeshPlan:
    found = plan(loads(f'kind = "mesh"\n{text}'))
    assert isinstance(found, MeshPlan)
    return found


@pytest.mark.parametrize(("settings", "values"), [
    ("", [3, 0, 0]), ('failover = "rssi"', [1, 0, 0]), ('failover = "heard"', [1, 1, 0]),
    ("on_demand = true", [3, 0, 1]), ('failover = "heard"\navoid = "origin"', [1, 1, 0]),
])  # fmt: skip
def test_a_rule_by_both_words_and_ways_on_demand(settings: str, values: list[int]) -> None:
    params = made(f"nodes = 30\n[protocol]\n{settings}").params
    assert [params[name] for name in ("failover", "recent", "on_demand")] == values


def test_ways_on_demand_want_acks() -> None:
    for settings in ("on_demand = true", "reliable = false"):
        made(f"nodes = 30\n[protocol]\n{settings}")
    with pytest.raises(ScenarioError, match="there are none; leave one out"):
        made("nodes = 30\n[protocol]\non_demand = true\nreliable = false")
