"""A network of which the toolkit is told only protocol, fields and layout is brought up live."""

import asyncio
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from innervate import scenario as scenarios
from innervate.cli import live_status
from innervate.live import play, status, tap
from innervate.live.build import build
from innervate.live.errors import LiveError
from innervate.live.nodefile import load
from innervate.live.up import Processes
from innervate.network import networks
from innervate.web.live import Live
from innervate.web.messages import Cut, Heal
from tests.live.net import until

FIRST_S = 40.0
RING = {"kind": "tokenring", "name": "round", "nodes": 3, "lost_us": 200_000}


def asked(network, name, **request):
    return status.ask_one(network.socket(name), {"do": "status", **request})


def laps(network):
    return [asked(network, name)["fields"]["lap"] for name in network.names]


def test_a_ring_comes_up_over_udp_is_sealed_watched_cut_and_mended(tmp_path):
    plan = scenarios.plan(scenarios.from_dict(RING))
    keys = {"use": 1, "secret.1": "11" * 32}

    async def main():
        network = Processes(plan, tmp_path, "udp", keys)
        assert network.links == [(0, 2), (0, 1), (1, 2)]
        await network.up()
        (tmp_path / "scenario.toml").write_text(scenarios.dump(scenarios.from_dict(RING)))
        live = None
        try:
            await until(lambda: min(laps(network)) > 5, FIRST_S)
            told = [asked(network, name) for name in network.names]
            live = Live([network.socket(name) for name in network.names])
            scene = live.scene()
            assert (scene["kind"], scene["name"], len(scene["links"])) == ("tokenring", "round", 3)
            await watched(network, live)
            return told
        finally:
            if live is not None:
                live.close()
            await network.down()

    told = asyncio.run(main())
    assert live_status.headline(told, []) == "ok: All 3 nodes answer."
    assert live_status.headline(told, [Path("run/n9.sock")]) == (
        "degraded: 1 of 4 nodes does not answer or is cut off."
    )
    lines = live_status.lines(told[1])
    assert lines[0].startswith("n1: tokenring node, up ")
    assert lines[0].endswith(", sealed")
    assert lines[1].startswith("  lap ")
    assert "tokens, load 0 0 raw" in lines[1]
    assert lines[2].startswith("  port 0: udp 127.0.0.1:")


async def watched(network, live):
    """The page cuts a cable and sees that the token stops, puts it back and sees it go on."""
    live.do(Cut(0))
    live.work()
    state = live.fields()
    assert state["link_up"].tolist() == [0, 1, 1]
    assert state["headline"]["level"] == "ok"  # the others still join all
    assert set(state["fields"]) == {"lap", "passed", "made_at"}
    at = asked(network, "n2")["fields"]["lap"]
    await asyncio.sleep(0.5)
    assert asked(network, "n2")["fields"]["lap"] <= at + 1
    live.do(Heal(0))
    await until(lambda: asked(network, "n2")["fields"]["lap"] > at + 5, FIRST_S)


def test_its_events_are_played_and_its_users_give_and_hear(tmp_path):
    event = [
        {"at_s": 0.1, "action": "cut", "node": 1},
        {"at_s": 0.3, "action": "restore", "node": 1},
    ]
    plan = scenarios.plan(scenarios.from_dict({**RING, "event": event}))

    async def main():
        network, told = Processes(plan, tmp_path, "udp"), []
        happening = play.events(network.deployment)
        await network.up()
        try:
            await play.Player(network, happening, told.append).play()
            request = {"do": "input", "kind": 1, "item": {"load": [7, 8]}}
            assert asked(network, "n1", **request) == {"ok": True}
            await asyncio.to_thread(hear, network)
            with pytest.raises(LiveError, match="weight is no field of a frame"):
                asked(network, "n1", do="input", kind=1, item={"weight": 7})
            with pytest.raises(LiveError, match="load has 2 values"):
                asked(network, "n1", do="input", kind=1, item={"load": 7})
            for load in ([0, 2**60], [0, -1], [True, 0], [0, 1e999], [0, None]):
                with pytest.raises(LiveError, match="whole numbers from 0 to 255"):
                    asked(network, "n1", do="input", kind=1, item={"load": load})
            with pytest.raises(LiveError, match="a tokenring has no messages"):
                asked(network, "n1", do="send", payload="00")
        finally:
            await network.down()
        return [one.text for one in told]

    assert asyncio.run(main()) == ["cut n1 - n2", "restore n1 - n2"]


def hear(network):
    """Until a token that carries what was given comes to the next node."""
    answers = status.ask(network.socket("n2"), {"do": "listen"})
    assert next(answers) == {"listening": "n2"}
    one = next(answer for answer in answers if answer["load"] == [7, 8])
    assert (one["from"], one["kind"]) == ("n2", 1)
    assert networks()["tokenring"].live_words.heard(one).startswith("kind 1, lap ")


def test_live_up_brings_it_up_from_a_file_and_its_nodes_are_found(tmp_path, monkeypatch):
    file = tmp_path / "round.toml"
    file.write_text('kind = "tokenring"\nnodes = 3\n')
    monkeypatch.delenv("INNERVATE_RUN", raising=False)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    command = [sys.executable, "-m", "innervate.cli", "live", "up", file, "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=dict(os.environ)) as up:
        told = json.loads(up.stdout.readline())
        assert set(told["nodes"]) == {"n0", "n1", "n2"}
        assert status.where() == Path(told["folder"])
        assert [found.stem for found in status.sockets()] == ["n0", "n1", "n2"]
        up.terminate()
    assert up.returncode == 0
    assert status.sockets() == []


@pytest.mark.parametrize(("old", "new", "says"), [
    ("ports = [1]", "ports = [1, 0]", "ports must name the node's port of each of its 1 paths"),
    ("hold_us = 5", "hold_us = 0", "protocol.hold_us = 0 must be 1 to 1000000 us"),
    ("hold_us = 5", "wait_us = 5", "protocol.wait_us is unknown; it knows hold_us, lost_us"),
    ("ports = [1]", "rank = 1", "rank is for nodes of a mesh; remove it"),
    ("ports = [1]", "role = 'sink'", "role of a tokenring node can be node"),
    ("'tokenring'", "'token'", "kind must be skin or radio or mesh or tokenring"),
])  # fmt: skip
def test_what_is_wrong_with_its_node_file_is_said_in_one_line(tmp_path, old, new, says):
    good = (
        "kind = 'tokenring'\nnumber = 1\nports = [1]\nprotocol = {hold_us = 5}\n"
        "[[link]]\nkind = 'udp'\nbind = '127.0.0.1:0'\npeers = ['127.0.0.1:9']\n"
    )
    path = tmp_path / "n1.toml"
    path.write_text(good)
    node = build(load(path))
    assert tap.about(node)["paths"][0][:2] == (0, 1)
    path.write_text(good.replace(old, new))
    with pytest.raises(LiveError) as caught:
        build(load(path))
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)
