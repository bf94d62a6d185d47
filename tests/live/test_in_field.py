"""Networks of one's own over a field, between processes."""

import asyncio

import pytest

from innervate import scenario as scenarios
from innervate.live import status
from innervate.live.errors import LiveError
from innervate.live.in_field import FieldDeployment
from innervate.live.up import Processes
from tests.live.net import until
from tests.own import alone, made

__all__ = ["alone"]
FIRST_S = 20
LINE = {"nodes": 4, "layout": "line", "protocol.hops": 3, "input": [], "event": []}


@pytest.fixture
def flood(alone, capsys):
    network = made(alone / "flood", "field")
    capsys.readouterr()
    return network


def planned(flood, **changes):
    return scenarios.plan(scenarios.load(flood.scenario, overrides={**LINE, **changes}.items()))


def test_news_go_from_process_to_process_and_past_none_of_a_line(flood):
    plan = planned(flood)
    assert plan.good == [(0, 1), (1, 2), (2, 3)]

    async def main():
        network = Processes(plan, flood.folder / "run", "udp")
        await network.up()
        try:
            give = {"do": "input", "kind": 1, "item": {"value": 41}}
            assert status.ask_one(network.socket("n0"), give) == {"ok": True}
            await until(lambda: heard(network) == [0, 1, 1, 1], FIRST_S)
            told = [status.ask_one(network.socket(f"n{i}"), {"do": "status"}) for i in range(4)]
            assert [one["fields"]["value"] for one in told] == [41] * 4
            assert [len(one["paths"]) for one in told] == [1, 2, 2, 1]
            assert not any(one["fields"]["busy"] for one in told)  # their own frames have ended
        finally:
            await network.down()

    asyncio.run(main())


def heard(network):
    told = [status.ask_one(network.socket(f"n{i}"), {"do": "status"}) for i in range(4)]
    return [one["counters"].get("delivered", 0) for one in told]


def test_what_cannot_be_brought_up_is_said_in_one_line(flood):
    with pytest.raises(LiveError, match="nodes of a field take --netns or UDP"):
        FieldDeployment(planned(flood)).check("pty", sealed=False)
    with pytest.raises(LiveError, match=r"node 0 hears nobody; raise air\.reach_m"):
        FieldDeployment(planned(flood, spacing_m=500)).file(0, [])
    cut = {"at_s": 1, "action": "cut", "node": 0, "other": 3}
    deployment = FieldDeployment(planned(flood, event=[cut]))
    with pytest.raises(LiveError, match=r"event\.0: n0 and n3 do not hear each other"):
        deployment.cable_of(deployment.plan.faults[0])
    assert deployment.cable_of(planned(flood, event=[{**cut, "other": 1}]).faults[0]) == 0
