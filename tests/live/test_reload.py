"""SIGHUP on real processes: keys change while messages run, and nobody is shut out."""

import asyncio
import signal
import subprocess
import sys
import threading
import time

import pytest

from innervate import cli
from innervate import scenario as scenarios
from innervate.live import hangup, status
from innervate.live.up import Processes
from tests.fixtures.node_files import of_mesh
from tests.live.net import LINE, running, until

FIRST_S = 40.0
OLD, NEW = "11" * 32, "22" * 32
GRACE_S = 0.5
KEYS = {"use": 1, "secret.1": OLD, "grace_s": GRACE_S}


def told(network, name):
    return status.ask_one(network.socket(name), {"do": "status"})


ALONE = of_mesh(0, 2, f'socket = "{{folder}}/n0.sock"\n[keys]\nuse = 1\nsecret.1 = "{OLD}"')


class Sender(threading.Thread):
    """Messages from n0 to node 2, one after the other, until told to stop."""

    def __init__(self, network):
        super().__init__(daemon=True)
        self.where = network.socket("n0")
        self.states = []
        self.enough = threading.Event()

    def run(self):
        while not self.enough.is_set():
            for answer in status.ask(self.where, {"do": "send", "to": 2, "payload": "00"}):
                if answer["state"] in ("delivered", "expired", "refused"):
                    self.states.append(answer["state"])
                    break


def log(network, name):
    return (network.folder / f"{name}.log").read_text()


def test_other_keys_are_taken_over_node_by_node_and_no_message_is_lost(tmp_path):
    async def main():
        plan = scenarios.plan(scenarios.from_dict(LINE))
        async with running(plan, tmp_path, "udp", KEYS) as network:
            await until(lambda: all(told(network, n)["table"] for n in network.names), FIRST_S)
            sender = Sender(network)
            sender.start()
            network.keys = {"use": 2, "secret.2": NEW, "grace_s": GRACE_S}
            for name in network.names:
                network.write_file(name)
                network.processes[name].send_signal(signal.SIGHUP)
                await until(lambda name=name: "keys reloaded" in log(network, name), FIRST_S)
                assert told(network, name)["keys"]["accepted"] == [1, 2]
            only = {"use": 2, "accepted": [2]}
            await until(lambda: all(told(network, n)["keys"] == only for n in network.names))
            sent = len(sender.states)
            await until(lambda: len(sender.states) > sent + 5)
            sender.enough.set()
            await asyncio.to_thread(sender.join)
            counters = [told(network, name)["counters"] for name in network.names]
        return sender.states, counters

    states, counters = asyncio.run(main())
    assert set(states) == {"delivered"}
    for counted in counters:
        assert [what for what in counted if what.startswith("dropped")] == []


def test_what_cannot_be_reloaded_is_said_and_nothing_changes(tmp_path):
    async def main():
        plan = scenarios.plan(scenarios.from_dict(LINE))
        async with running(plan, tmp_path, "udp", KEYS) as network:
            path, process = tmp_path / "n0.toml", network.processes["n0"]
            good = path.read_text()
            for text, says in (
                (good.replace(OLD, NEW), "keys.secret.1 is another key now"),
                (good + "[keys]\n", "not valid TOML"),
                (good.replace("nodes = 3", "nodes = 4"), "for what else has changed: nodes"),
            ):  # fmt: skip
                path.write_text(text)
                process.send_signal(signal.SIGHUP)
                await until(lambda says=says: says in log(network, "n0"), FIRST_S)
                assert told(network, "n0")["keys"] == {"use": 1, "accepted": [1]}

    asyncio.run(main())


def test_nobody_can_hang_up_on_a_node_that_is_starting(tmp_path):
    path = tmp_path / "n0.toml"
    path.write_text(ALONE.format(folder=tmp_path))
    command = [sys.executable, "-m", "innervate.cli", "live", "node", str(path)]
    with hangup.held():
        node = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        while not status.answers(tmp_path / "n0.sock"):
            assert node.poll() is None
            node.send_signal(signal.SIGHUP)
            time.sleep(0.005)
        node.send_signal(signal.SIGTERM)
        _, said = node.communicate(timeout=FIRST_S)
    finally:
        node.kill()
    assert node.returncode == 0
    assert "keys reloaded" in said


@pytest.mark.parametrize("more", [[], ["--engine", "auto"], ["--firmware", "n0.elf"]])
def test_whatever_it_is_told_to_run_on_a_node_holds_hangups_before_it_loads_commands(
    monkeypatch, more
):
    blocked = []

    def look(*_):
        blocked.append(signal.pthread_sigmask(signal.SIG_BLOCK, ()))
        return 0

    monkeypatch.setattr("innervate.cli.app.main", look)
    monkeypatch.setattr("innervate.live.main.run", look)
    with hangup.held():
        hangup.let_in()
        assert cli.main(["live", "node", "n0.toml", *more]) == 0
    assert [signal.SIGHUP in one for one in blocked] == [True]


def test_nodes_of_a_network_are_started_with_hangups_held(monkeypatch, tmp_path):
    network = Processes(scenarios.plan(scenarios.from_dict(LINE)), tmp_path, "udp")
    blocked = []

    def begin(*_, **__):
        blocked.append(signal.pthread_sigmask(signal.SIG_BLOCK, ()))

    monkeypatch.setattr(subprocess, "Popen", begin)
    hangup.let_in()  # it is held where a test before ran `live node` in this process
    network.start_node("n0")
    assert [signal.SIGHUP in one for one in blocked] == [True]
    assert signal.SIGHUP not in signal.pthread_sigmask(signal.SIG_BLOCK, ())
