"""Nodes that end, and interfaces that go away and come back."""

import asyncio
import json
import signal
import socket
import subprocess
import sys

import pytest

from innervate import scenario as scenarios
from innervate.live import status
from innervate.live.netns import Lab
from tests.live.net import LINE, running, until

FIRST_S = 40.0
MANY = 40


def told(where):
    return status.ask_one(where, {"do": "status"})


def test_a_node_that_is_told_to_end_gets_rid_of_its_messages_first(tmp_path):
    async def main():
        plan = scenarios.plan(scenarios.from_dict(LINE))
        async with running(plan, tmp_path) as network:
            where, far = network.socket("n0"), network.socket("n2")
            await until(lambda: all(told(network.socket(n))["table"] for n in network.names), 40)
            with socket.socket(socket.AF_UNIX) as sock:
                sock.connect(str(where))
                lines = sock.makefile("rw")
                for _ in range(MANY):
                    request = {"do": "send", "to": 2, "payload": "00", "wait": False}
                    lines.write(json.dumps(request) + "\n")
                lines.flush()
                assert [json.loads(lines.readline())["state"] for _ in range(MANY)]
                left = told(where)["backlog"]
                network.processes["n0"].send_signal(signal.SIGTERM)
                code = await asyncio.to_thread(network.processes["n0"].wait)
            return code, left, told(far)["counters"]["messages received"]

    code, left, received = asyncio.run(main())
    assert code == 0
    assert left > 0, "nothing was under way: the test shows nothing"
    assert received == MANY


@pytest.mark.needs_root
@pytest.mark.needs_netns
@pytest.mark.parametrize("kind", [pytest.param("udp", marks=pytest.mark.slow), "multicast"])
def test_an_interface_that_vanishes_comes_back_by_itself(tmp_path, kind):
    lab = Lab("ivaway", 2, [(0, 1)])
    own = [lab.address(0, node) for node in range(2)]
    links = {
        "udp": [f'bind = "{own[i]}:4700"\npeers = ["{own[1 - i]}:4700"]' for i in range(2)],
        "multicast": [f'group = "239.77.0.1:4700"\ninterface = "{own[i]}"' for i in range(2)],
    }[kind]
    sockets = [tmp_path / f"n{i}.sock" for i in range(2)]
    running = []
    lab.up()
    try:
        for i in (1, 0):
            role = "gateway" if i == 0 else "node"
            path = tmp_path / f"n{i}.toml"
            path.write_text(
                f'kind = "mesh"\nnumber = {i}\nnodes = 2\nrole = "{role}"\n'
                f'socket = "{sockets[i]}"\n[[link]]\nkind = "{kind}"\n{links[i]}\n'
            )
            command = [sys.executable, "-m", "innervate.cli", "live", "node", str(path)]
            running.append(subprocess.Popen(lab.inside(i, command)))
        asyncio.run(away_and_back(lab, sockets))
    finally:
        for process in running:
            process.terminate()
        codes = [process.wait(timeout=30) for process in running]
        lab.down()
    assert codes == [0, 0]


async def away_and_back(lab, sockets):
    await until(lambda: all(map(status.answers, sockets)), FIRST_S)
    await until(lambda: all(told(where)["table"] for where in sockets), FIRST_S)
    assert await asyncio.to_thread(send, sockets[0]) == "delivered"
    lab.run(0, ["ip", "link", "del", "c0"])
    await until(lambda: all(told(where)["broken"] for where in sockets), FIRST_S)
    lab.plug(0)
    await until(lambda: not any(told(where)["broken"] for where in sockets), FIRST_S)
    assert await asyncio.to_thread(send, sockets[0]) == "delivered"


def send(where):
    for answer in status.ask(where, {"do": "send", "to": 1, "payload": "00"}):
        if answer["state"] in ("delivered", "expired", "refused"):
            return answer["state"]
    return "gone"
