"""Addresses and names of a lab of network namespaces, and what is done to each; nothing is made."""

import shutil

import pytest

from benchmarks.live.lab import Lab
from innervate.live import netns
from innervate.live.errors import LiveError

LINKS = [(0, 1), (1, 2), (0, 2)]


@pytest.fixture
def lab(monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda tool: f"/sbin/{tool}")
    done = []
    monkeypatch.setattr(netns, "_run", lambda command, text="": done.append((command, text)) or "")
    made = Lab("iv", 3, LINKS)
    made.done = done
    return made


def test_both_ends_of_a_cable_are_in_one_small_network_of_its_own(lab):
    for link, (a, b) in enumerate(LINKS):
        assert lab.address(link, a) == f"10.77.0.{4 * link + 1}"
        assert lab.address(link, b) == f"10.77.0.{4 * link + 2}"
    assert [lab.loopback(node) for node in range(3)] == ["10.78.0.1", "10.78.0.2", "10.78.0.3"]
    assert Lab("iv", 2, [(0, 1)] * 100).address(64, 1) == "10.77.1.2"


def test_neighbours_and_interfaces_of_a_node(lab):
    assert lab.peers(1) == ["10.77.0.1:4700", "10.77.0.6:4700"]
    assert lab.peers(2) == ["10.77.0.5:4700", "10.77.0.9:4700"]
    assert [lab.interfaces(node) for node in range(3)] == [["c0", "c2"], ["c0", "c1"], ["c1", "c2"]]
    assert lab.name(2) == "iv-2"
    assert lab.inside(1, ["ls", "-l"]) == ["ip", "netns", "exec", "iv-1", "ls", "-l"]


def test_a_cable_is_cut_at_both_ends_and_a_node_at_all_its_own(lab):
    def changed():
        found = [(command[3], command[5], command[-2]) for command, _ in lab.done]
        lab.done.clear()
        return found

    lab.cut(1)
    assert changed() == [("iv-1", "add", "c1"), ("iv-2", "add", "c1")]
    lab.restore(1)
    assert changed() == [("iv-1", "delete", "c1"), ("iv-2", "delete", "c1")]
    lab.isolate(0)
    assert changed() == [("iv-0", "add", "c0, c2")]
    lab.rejoin(0)
    assert changed() == [("iv-0", "delete", "c0, c2")]


def test_a_cable_has_an_interface_with_its_address_in_each_namespace(lab):
    lab.plug(1)
    (made, _), *ends = lab.done
    assert made == ["ip", "link", "add", "c1", "netns", "iv-1", "type", "veth", "peer", "name",
                    "c1", "netns", "iv-2"]  # fmt: skip
    assert [(command[2], text.splitlines()[0]) for command, text in ends] == [
        ("iv-1", "addr add 10.77.0.5/30 dev c1"), ("iv-2", "addr add 10.77.0.6/30 dev c1"),
    ]  # fmt: skip


def test_bytes_of_ip_are_those_of_both_ends_without_ethernets_heads(lab):
    counts = {1: "1000 10\n", 2: "514\n1\n"}
    lab.run = lambda node, command: counts[node]
    assert lab.ip_bytes(1) == (1000 - 140) + (514 - 14)


def test_a_tool_that_is_missing_is_named(monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda tool: None if tool == "nft" else tool)
    with pytest.raises(LiveError, match="network namespaces need nft; install nftables"):
        Lab("iv", 1, [])


@pytest.mark.parametrize(("said", "why"), [("first\nlast\n", "last"), ("", "failed")])
def test_a_command_that_fails_says_why(tmp_path, said, why):
    (tmp_path / "said").write_text(said)
    command = ["sh", "-c", f"cat {tmp_path}/said >&2; exit 3"]
    with pytest.raises(LiveError, match=f"; exit 3: {why}; namespaces need root"):
        netns._run(command)
    assert netns._run(["cat"], "through") == "through"
