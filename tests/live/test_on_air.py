"""Networks of one's own on a shared channel, between processes."""

import asyncio

import pytest

from innervate import scenario as scenarios
from innervate.cli import live_status, main
from innervate.live import status
from innervate.live.build import build
from innervate.live.channel import SLOT_US, TURNAROUND_US
from innervate.live.errors import LiveError
from innervate.live.nodefile import load
from innervate.live.on_channel import ChannelDeployment
from innervate.live.play import events
from innervate.network import networks
from tests.live.net import running, until
from tests.own import alone, talk

__all__ = ["alone", "talk"]
FIRST_S = 20


def planned(talk, **changes):
    found = scenarios.load(talk.scenario, overrides={"nodes": 3, "event": [], **changes}.items())
    return scenarios.plan(found)


def test_its_nodes_hear_each_other_over_a_channel_of_processes(talk, monkeypatch):
    plan = planned(talk, input=[])

    async def main():
        async with running(plan, talk.folder / "run") as network:
            give = {"do": "input", "kind": 1, "item": {"value": 41}}
            assert status.ask_one(network.socket("n0"), give) == {"ok": True}
            await until(lambda: heard(network) == [0, 1, 1], FIRST_S)
            monkeypatch.setenv("INNERVATE_NETWORKS", "")  # who asks knows the folder by its name
            networks.cache_clear()
            told = status.ask_one(network.socket("n0"), {"do": "status"})
            assert told["fields"]["value"] == 41
            assert live_status.lines(told)[0].startswith("n0: talk node, up ")
            assert live_status.headline([told], []).startswith("ok: ")

    asyncio.run(main())


def heard(network):
    told = [status.ask_one(network.socket(f"n{i}"), {"do": "status"}) for i in range(3)]
    return [one["counters"].get("delivered", 0) for one in told]


def test_a_scenario_too_fast_for_processes_is_slowed_down_as_a_whole(talk):
    event = [{"at_s": 0.2, "action": "kill", "node": 1}]
    deployment = ChannelDeployment(planned(talk, event=event))
    assert deployment.slower() == 100  # slots of 100 us become 10 ms
    assert deployment.channel() == (SLOT_US, TURNAROUND_US)
    _, tables = deployment.file(0, [])
    assert tables["protocol"] == {"wait_us": 1_000_000, "length_slots": 5}
    assert [one.at_s for one in events(deployment)] == [20.0]
    slow = ChannelDeployment(planned(talk, **{"air.slot_us": 2_000, "air.turnaround_us": 6_000}))
    assert (slow.slower(), slow.channel()) == (1, (2_000, 6_000))


@pytest.mark.parametrize(
    ("changes", "sealed", "says"),
    [
        ({"hidden": [[0, 1]]}, False, "all hear each other; leave hidden out"),
        ({}, True, "leave --pty, --netns, --sealed and --identities out"),
        ({"protocol.wait_us": 20_000}, False, "protocol.wait_us: live slots are 100 times"),
    ],
)
def test_what_cannot_be_brought_up_is_said_in_one_line(talk, changes, sealed, says):
    plan = planned(talk, **changes)
    with pytest.raises(LiveError, match=says):
        brought_up(plan, sealed)


def brought_up(plan, sealed):
    deployment = ChannelDeployment(plan)
    deployment.check("udp", sealed)
    deployment.file(0, [])


def test_a_node_file_beside_its_network_needs_no_more(talk, monkeypatch, tmp_path):
    monkeypatch.setenv("INNERVATE_NETWORKS", "")
    networks.cache_clear()
    path = tmp_path / "n1.toml"
    head = "kind = 'talk'\nnumber = 1\n[[link]]\n"
    path.write_text(f"{head}kind = 'medium'\naddress = 'nowhere:1'\n")
    assert build(load(path)).radio.mode == "off"
    path.write_text(f"{head}kind = 'udp'\nbind = ':1'\npeers = [':2']")
    with pytest.raises(LiveError, match=r"n1.toml: a node on a channel has one \[\[link\]\]"):
        build(load(path))


def test_who_asks_far_from_the_network_is_told_what_to_name(talk, monkeypatch, capsys, tmp_path):
    (tmp_path / "far").mkdir()
    monkeypatch.chdir(tmp_path / "far")
    monkeypatch.setenv("INNERVATE_NETWORKS", "")
    networks.cache_clear()
    monkeypatch.setattr(status, "sockets", lambda: ["n0"])
    monkeypatch.setattr(status, "ask_one", lambda *_: {"kind": "talk", "name": "n0", "paths": []})
    assert main(["live", "status"]) == 2
    assert "no network here is called 'talk'; name its folder: --network DIR" in (
        capsys.readouterr().err
    )
