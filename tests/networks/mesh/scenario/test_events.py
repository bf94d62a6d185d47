"""Whom random events of a mesh hit."""

from typing import Any

import pytest

from innervate.networks.mesh.scenario.plan import MeshPlan
from innervate.scenario import ScenarioError, loads, plan
from innervate.scenario.actions.field import KILL, REVIVE


def made(text: str, seed: int | None = None) -> Any:
    found = plan(loads(f'kind = "mesh"\n{text}', (), seed))
    assert isinstance(found, MeshPlan)
    return found


def test_random_events_spare_who_matters() -> None:
    text = "nodes = 12\nmonitor = 1\n[[robot]]\nnode = 4\nrandom = true\n"
    text += "[[flow]]\nfrom = 2\nto = 3\n"
    event = "[[event]]\nat_s = [3, 4]\naction = 'kill'\nrandom = 3\n"
    later = "[[event]]\nat_s = 5\naction = 'revive'\nrandom = 2\n"
    for seed in range(20):
        p = made(text + event + event + later, seed=seed)
        killed = [f.node for f in p.faults if f.action == KILL]
        assert len(killed) == len(set(killed)) == 6
        assert not {0, 1, 2, 3, 4} & set(killed)
        assert all(3_000_000 <= f.at_us <= 4_000_000 for f in p.faults[:6])
        assert {f.node for f in p.faults if f.action == REVIVE} < set(killed)
        assert p.absent == [0] * 12


def test_a_restart_revives_and_random_events_know_it() -> None:
    text = "nodes = 4\n"
    for at, action, whom in ((1, "kill", "node = 2"), (2, "restart", "node = 2"),
                             (3, "kill", "random = 3"), (4, "restart", "node = 3"),
                             (5, "revive", "random = 2")):  # fmt: skip
        text += f"[[event]]\nat_s = {at}\naction = '{action}'\n{whom}\n"
    p = made(text)
    assert [f.node for f in p.faults if f.action == KILL] == [2, 1, 2, 3]
    assert [f.node for f in p.faults if f.action == REVIVE] == [1, 2]


@pytest.mark.parametrize(("tail", "said"), [
    ("[[flow]]\nfrom = 'random'\nto = 1\npairs = 2", "but only 1 node can be drawn"),
    ("nodes = 3\n[[flow]]\nfrom = 'random'\nto = 1\npairs = 3", "but only 2 nodes can be drawn"),
    ("[[event]]\nat_s = 1\naction = 'kill'\nrandom = 2", "but there is 1 node that is alive and"),
    ("[[event]]\nat_s = 1\naction = 'revive'\nrandom = 2", "but there are no nodes that are dead"),
    ("[radio]\nmean_degree = 3", "but there is 1 other; "),
    ("[clusters]\ngateways = 1\nrun = 2", "but there is 1 cluster; "),
])  # fmt: skip
def test_a_single_one_that_is_left_to_be_drawn_is_counted_as_one(tail: str, said: str) -> None:
    with pytest.raises(ScenarioError) as found:
        made(tail if tail.startswith("nodes") else f"nodes = 2\n{tail}")
    assert said in str(found.value)
