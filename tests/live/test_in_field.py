"""Networks of one's own over a field, between processes."""

import asyncio

import pytest

from innervate import scenario as scenarios
from innervate.live import status
from innervate.live.errors import LiveError
from innervate.live.in_field import FieldDeployment
from tests.live.net import running, until
from tests.own import alone, bare

__all__ = ["alone", "bare"]
FIRST_S = 20
LINE = {"nodes": 4, "layout": "line", "protocol.hops": 3, "input": [], "event": []}


def planned(bare, **changes):
    return scenarios.plan(scenarios.load(bare.scenario, overrides={**LINE, **changes}.items()))


def test_news_go_from_process_to_process_and_past_none_of_a_line(bare):
    plan = planned(bare)
    assert plan.good == [(0, 1), (1, 2), (2, 3)]

    async def main():
        async with running(plan, bare.folder / "run") as network:
            give = {"do": "input", "kind": 1, "item": {"value": 41}}
            assert status.ask_one(network.socket("n0"), give) == {"ok": True}
            await until(lambda: heard(network) == [0, 1, 1, 1], FIRST_S)
            told = [status.ask_one(network.socket(f"n{i}"), {"do": "status"}) for i in range(4)]
            assert [one["fields"]["value"] for one in told] == [41] * 4
            assert [len(one["paths"]) for one in told] == [1, 2, 2, 1]
            assert not any(one["fields"]["busy"] for one in told)  # their own frames have ended

    asyncio.run(main())


def heard(network):
    told = [status.ask_one(network.socket(f"n{i}"), {"do": "status"}) for i in range(4)]
    return [one["counters"].get("delivered", 0) for one in told]


def test_what_cannot_be_brought_up_is_said_in_one_line(bare):
    with pytest.raises(LiveError, match="nodes of a field take --netns or UDP"):
        FieldDeployment(planned(bare)).check("pty", sealed=False)
    with pytest.raises(LiveError, match=r"node 0 hears nobody; raise air\.reach_m"):
        FieldDeployment(planned(bare, spacing_m=500)).file(0, [])
    cut = {"at_s": 1, "action": "cut", "node": 0, "other": 3}
    deployment = FieldDeployment(planned(bare, event=[cut]))
    with pytest.raises(LiveError, match=r"event\.0: n0 and n3 do not hear each other"):
        deployment.cable_of(deployment.plan.faults[0])
    assert deployment.cable_of(planned(bare, event=[{**cut, "other": 1}]).faults[0]) == 0
