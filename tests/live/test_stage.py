"""What `live up` writes for each node and does to it, with processes that only note it."""

import asyncio
import json
import signal
import tomllib
from types import SimpleNamespace

import pytest

from innervate import scenario as scenarios
from innervate.live import up
from innervate.live.errors import LiveError
from innervate.live.up import Processes

MESH = {
    "kind": "mesh", "nodes": 3, "radio": {"profile": "ip"}, "standby": [2],
    "link": [{"a": 0, "b": 1}, {"a": 1, "b": 2}],
}  # fmt: skip
SKIN = {
    "kind": "skin", "patch": [{"columns": 2, "rows": 2}], "data": {"rate_hz": 20},
    "interface": [{"row": 1, "column": 1, "port": "E"}, {"row": 0, "column": 0, "port": "W"}],
}  # fmt: skip


class Process:
    """One that ends when it is told to, or has ended."""

    def __init__(self, ended=False):
        self.code, self.signals = 0 if ended else None, []

    def poll(self):
        return self.code

    def send_signal(self, number):
        self.signals.append(number)
        self.code = 0

    def wait(self):
        return self.code


class Noted(Processes):
    """A network whose processes are started in name only; what their sockets are asked is kept."""

    def __init__(self, told, folder, cables="udp", **more):
        super().__init__(scenarios.plan(scenarios.from_dict(told)), folder, cables, **more)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.started, self.ready, self.asked = [], [], []

    def start_node(self, name):
        self.started.append(name)
        self.processes[name] = Process()

    async def _ready(self, names):
        self.ready += names


@pytest.fixture
def noted(tmp_path, monkeypatch):
    def made(told=MESH, **more):
        network = Noted(told, tmp_path / "run", **more)

        async def ask(socket, request):
            network.asked.append((socket.stem, request["do"], request["port"], request["loss"]))

        monkeypatch.setattr(up, "ask", ask)
        asyncio.run(network.up())
        return network

    return made


def file(network, name):
    return tomllib.loads((network.folder / f"{name}.toml").read_text())


def test_both_ends_of_a_cable_name_each_other(noted):
    network = noted()
    ends = {}
    for name in network.names:
        for link in file(network, name)["link"]:
            assert link["kind"] == "udp"
            ends[link["bind"]] = link["peers"]
    assert len(ends) == 4
    assert all(ends[far] == [own] for own, (far,) in ends.items())
    assert [len(file(network, name)["link"]) for name in network.names] == [1, 2, 1]
    heads = [file(network, name) for name in network.names]
    assert [head["number"] for head in heads] == [0, 1, 2]
    assert [head["role"] for head in heads] == ["gateway", "node", "standby"]
    assert [head["socket"] for head in heads] == [str(network.socket(n)) for n in network.names]
    assert network.started == network.ready == ["n0", "n1", "n2"]


def test_serial_cables_are_joined_at_both_ends_and_a_skins_files_name_its_ports(noted):
    network = noted(SKIN, cables="pty")
    try:
        found = {name: file(network, name) for name in network.names}
        devices = network.relay.devices
        for cable, (a, b) in enumerate(network.links):
            for node, own, far in ((a, 2 * cable, 2 * cable + 1), (b, 2 * cable + 1, 2 * cable)):
                place = network._ports[node].index(cable)
                link = found[network.names[node]]["link"][place]
                assert (link["device"], link["far"]) == (devices[own], devices[far])
                if network.names[node] != "pc":
                    port = network.deployment.port_of(node, cable)
                    assert found[network.names[node]]["ports"][place] == port
        assert {found[name]["rate_hz"] for name in network.names if name != "pc"} == {20.0}
        assert found["pc"]["role"] == "sink"
        (first, second) = network._ports[network.names.index("pc")]
        assert [network.deployment.port_of(4, k) for k in (first, second)] == [0, 1]
        assert first > second, "its cables are in another order than its ports"
    finally:
        network.relay.stop()


def test_each_node_has_its_own_identity_or_all_one_key(noted):
    network = noted(keys={"identity": "keys/n{number}.identity"})
    for number, name in enumerate(network.names):
        assert file(network, name)["keys"] == {"identity": f"keys/n{number}.identity"}
    network.keys = {"use": 1, "secret.1": "11" * 32}
    network.write_file("n2")
    assert file(network, "n2")["keys"] == {"use": 1, "secret": {"1": "11" * 32}}
    assert "identity" in file(network, "n1")["keys"]
    assert (network.folder / "n2.toml").stat().st_mode & 0o777 == 0o600


def change(network, *changes):
    async def all_of_them():
        for cable, what, *loss in changes:
            await network.change(cable, what, *loss)

    asyncio.run(all_of_them())
    told, network.asked = network.asked, []
    return told


def test_who_is_started_again_is_told_that_a_link_is_cut_and_who_is_out_of_reach(noted):
    network = noted()
    node = network.names[network.links[1][0]]
    place = network._ports[network.links[1][0]].index(1)

    def told_again():
        asyncio.run(network.end_node(node, gently=False))
        network.asked = []
        asyncio.run(network.begin_node(node))
        return {one[:3] for one in network.asked}

    change(network, (1, "cut"), (1, "apart"), (1, "near"), (1, "apart"))
    assert told_again() == {(node, "cut", place), (node, "apart", place)}
    change(network, (1, "near"))
    assert told_again() == {(node, "cut", place)}
    change(network, (1, "restore"))
    assert told_again() == set()


def test_a_cable_is_cut_at_both_its_ends_and_stays_so_for_who_is_started_again(noted):
    network = noted()
    a, b = network.links[1]
    names = [network.names[node] for node in (a, b)]
    places = [network._ports[node].index(1) for node in (a, b)]
    ends = list(zip(names, places, strict=True))
    assert change(network, (1, "loose", 0.25)) == [(n, "loose", p, 0.25) for n, p in ends]
    asyncio.run(network.end_node("n1", gently=False))
    assert network.processes["n1"].signals == [signal.SIGKILL]
    asyncio.run(network.begin_node("n1"))
    again = [(name, "loose", place, 0.25) for name, place in ends if name == "n1"]
    assert (network.started[3:], network.asked) == (["n1"], again)
    network.asked = []
    asyncio.run(network.begin_node("n1"))
    assert (network.started[3:], network.asked) == (["n1"], []), "it runs already"
    change(network, (1, "restore"), (0, "cut"))
    asyncio.run(network.end_node("n2", gently=True))
    assert network.processes["n2"].signals == [signal.SIGTERM]
    asyncio.run(network.begin_node("n2"))
    assert network.asked == [], "its cable was put back"
    asyncio.run(network.end_node("n0", gently=True))
    asyncio.run(network.end_node("n0", gently=True))
    asyncio.run(network.end_node("nobody", gently=True))
    assert len(network.processes["n0"].signals) == 1
    asyncio.run(network.begin_node("n0"))
    assert [one[:2] for one in network.asked] == [("n0", "cut")]


def test_who_joins_later_has_a_file_and_no_process(noted):
    team = {**MESH, "event": [{"at_s": 1.0, "action": "revive", "node": 2}]}
    network = noted(team)
    assert network.absent <= {"n2"}
    network.absent = {"n1"}
    network.started, network.ready = [], []
    asyncio.run(network.up())
    assert network.started == network.ready == ["n0", "n2"]
    assert (network.folder / "n1.toml").exists()


def test_how_a_node_is_started(tmp_path, monkeypatch):
    """The command, its folder, and a log that goes on."""
    plan = scenarios.plan(scenarios.from_dict(MESH))
    network, begun = Processes(plan, tmp_path, "udp", images={"n1": tmp_path / "image"}), []

    def popen(command, cwd, stdin, stdout, stderr):
        begun.append((command[3:] if command[0] != "in" else command[:2], cwd))
        stdout.write("started\n")
        return Process()

    monkeypatch.setattr(up.subprocess, "Popen", popen)
    for name in ("n0", "n1"):
        network.start_node(name)
    network.engine = "auto"
    for name in ("n0", "n1"):
        network.start_node(name)
    node = ["live", "node"]
    image = ["--firmware", str(tmp_path / "image")]
    assert begun == [
        ([*node, "n0.toml"], tmp_path), ([*node, "n1.toml", *image], tmp_path),
        ([*node, "n0.toml", "--engine", "auto"], tmp_path), ([*node, "n1.toml", *image], tmp_path),
    ]  # fmt: skip
    assert (tmp_path / "n0.log").read_text() == "started\n" * 2
    network.lab = SimpleNamespace(inside=lambda node, command: ["in", node, *command])
    network.start_node("n1")
    assert begun[-1] == (["in", 1], tmp_path)


@pytest.mark.parametrize(("log", "says"), [
    ("first\n\nn0: no such port\n", "n0 ended: no such port"), ("", "n0 ended: no message"),
])  # fmt: skip
def test_who_does_not_come_up_says_why(tmp_path, log, says):
    network = Processes(scenarios.plan(scenarios.from_dict(MESH)), tmp_path, "udp")
    network.processes["n0"] = Process(ended=True)
    (tmp_path / "n0.log").write_text(log)
    with pytest.raises(LiveError, match=f"^{says}$"):
        asyncio.run(network._ready(["n0"]))


def test_at_the_end_all_are_told_to_end_and_who_does_not_is_killed(noted, monkeypatch):
    network = noted()
    monkeypatch.setattr(up, "STOP_S", 0.0)

    class Deaf(Process):
        def send_signal(self, number):
            self.signals.append(number)

        def kill(self):
            self.signals.append("kill")
            self.code = -9

    deaf = network.processes["n1"] = Deaf()
    gone = network.processes["n2"] = Process(ended=True)
    asyncio.run(network.down())
    assert deaf.signals == [signal.SIGTERM, "kill"]
    assert network.processes["n0"].signals == [signal.SIGTERM]
    assert gone.signals == []


def test_files_are_toml_with_keys_first_then_tables_then_links(noted):
    network = noted()
    text = (network.folder / "n1.toml").read_text()
    assert text.index("[protocol]") < text.index("[[link]]")
    assert text.splitlines()[0] == f"kind = {json.dumps('mesh')}"
