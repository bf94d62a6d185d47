import asyncio
import json
import os
import resource
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest

from innervate import scenario as scenarios
from innervate.live import status
from innervate.live.up import Processes
from tests.live.net import until

RING = 5
FIRST_S = 30.0


def ring_scenario():
    links = [{"a": i, "b": (i + 1) % RING} for i in range(RING)]
    return scenarios.from_dict(
        {
            "kind": "mesh",
            "node": [{"name": f"r{i}"} for i in range(RING)],
            "link": links,
            "radio": {"profile": "ip"},
            "protocol": {"ack_us": 30_000, "e2e_s": 0.3, "beacon_s": 0.1, "period_s": 0.5,
                         "period_max_s": 0.5},
        }
    )  # fmt: skip


def skin_scenario():
    return scenarios.from_dict(
        {
            "kind": "skin",
            "patch": [{"columns": 3, "rows": 2}],
            "interface": [{"row": 0, "column": 0}, {"row": 1, "column": 2}],
            "protocol": {"beacon_hz": 50, "k": 5},
            "data": {"rate_hz": 50},
        }
    )


def ask(network, name, **request):
    return status.ask_one(network.socket(name), {"do": "status", **request})


async def network_of(scenario, folder, cables="udp"):
    network = Processes(scenarios.plan(scenario), folder, cables)
    await network.up()
    return network


def send(network, name, to, text):
    """The last state of a message."""
    request = {"do": "send", "to": to, "payload": text.encode().hex()}
    for answer in status.ask(network.socket(name), request):
        if answer["state"] in ("delivered", "expired", "refused"):
            return answer["state"]
    return "gone"


def states(network, name, to):
    """How many of 50 messages, one after the other on one connection, had just one end."""
    good = 0
    with socket.socket(socket.AF_UNIX) as sock:
        sock.connect(str(network.socket(name)))
        lines = sock.makefile("rw")
        for _ in range(50):
            lines.write(json.dumps({"do": "send", "to": to, "payload": "00"}) + "\n")
            lines.flush()
            told = [json.loads(lines.readline())["state"]]
            while told[-1] not in ("delivered", "expired"):
                told.append(json.loads(lines.readline())["state"])
            good += told[0] == "accepted" and len(told) == len(set(told))
    return good


def test_killed_and_started_again_a_node_rejoins(tmp_path):
    async def main():
        network = await network_of(ring_scenario(), tmp_path)
        try:
            await until(lambda: all(ask(network, n)["table"] for n in network.names), FIRST_S)
            assert await asyncio.to_thread(send, network, "n0", 2, "one") == "delivered"
            assert await asyncio.to_thread(states, network, "n0", 1) == 50
            for name in ("n1", "n0"):  # one in the middle, and the gateway itself
                network.processes[name].send_signal(signal.SIGKILL)
                network.processes[name].wait()
                network.start_node(name)
                await until(lambda name=name: status.answers(network.socket(name)), FIRST_S)
                await until(lambda name=name: ask(network, name)["table"], FIRST_S)
            assert await asyncio.to_thread(send, network, "n1", 3, "two") == "delivered"
        finally:
            await network.down()
        return [process.returncode for process in network.processes.values()]

    assert asyncio.run(main()) == [0] * RING  # SIGTERM is a clean end


def test_a_cut_cable_is_named_and_messages_go_round(tmp_path):
    async def main():
        network = await network_of(ring_scenario(), tmp_path)
        try:
            await until(lambda: all(ask(network, n)["table"] for n in network.names), FIRST_S)
            ask(network, "n1", do="cut", port=0)
            assert await asyncio.to_thread(send, network, "n0", 1, "round") == "delivered"
            await until(lambda: len(ask(network, "n0")["broken"]) == 1, FIRST_S)
        finally:
            await network.down()

    asyncio.run(main())


@pytest.mark.parametrize("cables", ["udp", pytest.param("pty", marks=pytest.mark.slow)])
def test_a_skin_of_six_processes_heals(tmp_path, cables):
    async def main():
        network = await network_of(skin_scenario(), tmp_path, cables)
        try:
            await until(lambda: sum(ask(network, "pc")["cells"]) == 6, FIRST_S)
            network.processes["c1"].send_signal(signal.SIGKILL)
            network.processes["c1"].wait()
            await until(lambda: sum(ask(network, "pc")["cells"]) == 5, FIRST_S)
            ask(network, "pc", do="cut", port=0)
            await until(lambda: ask(network, "pc")["cells"][1] == 5, FIRST_S)
            network.start_node("c1")
            network.processes["pc"].send_signal(signal.SIGKILL)
            network.processes["pc"].wait()
            network.start_node("pc")
            await until(lambda: status.answers(network.socket("pc")), FIRST_S)
            await until(lambda: sum(ask(network, "pc")["cells"]) == 6, FIRST_S)
        finally:
            await network.down()

    asyncio.run(main())


def node_file(folder, **more):
    lines = [
        'kind = "mesh"', "number = 0", "nodes = 2", 'role = "gateway"',
        f'socket = "{folder / "n0.sock"}"',
        *(f"{key} = {json.dumps(value)}" for key, value in more.items()),
        "[[link]]", 'kind = "udp"', 'bind = "127.0.0.1:0"', 'peers = ["127.0.0.1:9"]',
    ]  # fmt: skip
    path = folder / "n0.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


START = """
import os, signal, sys, threading, time
from innervate.cli import main
def end():
    while not os.path.exists({socket!r}):
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGTERM)
threading.Thread(target=end).start()
code = main(["live", "node", {file!r}])
print(sorted({{"numpy", "numba", "polars", "cyclopts"}} & set(sys.modules)))
sys.exit(code)
"""


def test_a_node_starts_quickly_and_stays_small(tmp_path):
    path = node_file(tmp_path)
    code = START.format(socket=str(tmp_path / "n0.sock"), file=str(path))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert done.stdout == "[]\n"
    assert "no key" in done.stderr
    # CPU time: wall time says more about the machine's other work.
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 0.4


def test_memory_metrics_and_one_node_to_a_socket(tmp_path):
    port = free_port()
    path = node_file(tmp_path, metrics=f"127.0.0.1:{port}")
    command = [sys.executable, "-m", "innervate.cli", "live", "node", str(path)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert "ready" in process.stderr.readline()
        kib = next(
            int(line.split()[1])
            for line in Path(f"/proc/{process.pid}/status").read_text().splitlines()
            if line.startswith("VmRSS")
        )
        url = f"http://127.0.0.1:{port}/metrics"
        page = urllib.request.urlopen(url, timeout=10).read().decode()
        second = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=30) == 0
    assert kib < 40 * 1024
    assert 'innervate_up_seconds{node="n0"}' in page
    assert 'innervate_path_broken{node="n0",path="udp 127.0.0.1:9"} 1' in page
    assert second.returncode == 2
    assert "runs already" in second.stderr
    assert second.stderr.count("\n") == 1


def test_no_node_is_said_in_one_line(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "innervate.cli", "live", "status"],
        capture_output=True, text=True, timeout=60, check=False,
        env={**os.environ, "INNERVATE_RUN": str(tmp_path)},
    )  # fmt: skip
    assert done.returncode == 2
    assert "no node runs here" in done.stderr


def free_port():
    with socket.socket() as sock:
        sock.bind(("127.0.0.1", 0))
        return sock.getsockname()[1]


@pytest.mark.needs_root
@pytest.mark.needs_netns
def test_in_network_namespaces_a_silent_cut_costs_no_probe(tmp_path):
    from benchmarks.live.__main__ import one_run
    from benchmarks.live.lab import Lab
    from benchmarks.live.shapes import ring
    from benchmarks.live.sides import Innervate

    shape = ring(4)
    lab = Lab("ivtest", shape.count, shape.links)
    lab.up()
    side = Innervate(shape, lab, tmp_path, ["chrt", "--fifo", "20"])
    try:
        side.start()
        time.sleep(side.settle_s)  # discovery: rounds of 2 s
        row = one_run(side, "cut")
    finally:
        side.stop()
        lab.down()
    assert row["lost"] == row["duplicates"] == 0
    assert row["outage_ms"] <= 40
