"""What is the matter with a node is said by its process: what its sealer finds, too."""

import asyncio
import errno
import os

import pytest

from innervate.live import main
from innervate.live.build import open_keys
from innervate.live.machine import Machine, on
from innervate.live.multicast import MulticastLink
from innervate.live.nodefile import load
from innervate.live.serial import SerialLink
from innervate.live.udp import UdpLink
from tests.fixtures.node_files import of_mesh

KEY = bytes(range(32))
FILE = of_mesh(3, 5, '[keys]\nuse = 1\nsecret.1 = "{key}"')


class Listening(Machine):
    """This machine; it keeps what is said on it, and its clock is moved by hand."""

    def __init__(self):
        self.said, self.now_s = [], 0.0

    def say(self, text):
        self.said.append(text)

    def monotonic_ns(self):
        return round(1e9 * self.now_s)


@pytest.fixture
def node(tmp_path):
    path = tmp_path / "n3.toml"
    path.write_text(FILE.format(key=KEY.hex()))
    machine = Listening()
    with on(machine):

        async def made():
            return main.Process(load(path))

        yield asyncio.run(made()), machine


def test_two_nodes_with_one_number_are_said_once_a_minute(node):
    process, machine = node
    sealer = process.node.sealer
    for now_s in (0.0, 1.0, 59.9, 60.0, 61.0):
        machine.now_s = now_s
        sealer.note_twin(3, "at 10.0.0.7")
    said = "n3: two nodes have our number, 3: at 10.0.0.7; give one of them another"
    assert machine.said == [said, said]
    sealer.note_twin(4, "both are heard here")
    assert machine.said == [said, said], "the same matter"
    assert sealer.counts["two nodes with one number"] == 6
    assert sealer.twins == {3: "at 10.0.0.7", 4: "both are heard here"}


def test_callers_that_are_turned_away_are_said_when_they_are_more(node):
    process, machine = node
    process._look()
    assert machine.said == []
    process.node.callers["status: turned away"] = 2
    for now_s in (0.0, 61.0):
        machine.now_s = now_s
        process._look()
    said = "n3: too many callers: status: turned away {} (since the start)"
    assert machine.said == [said.format(2)]
    process.node.callers["status: turned away"] = 3
    process._look()
    assert machine.said == [said.format(2), said.format(3)]


def test_a_state_that_cannot_be_written_is_said_and_when_it_is_again(node):
    process, machine = node
    state = process.node.state
    state.trouble = "No space left on device"
    process._look()
    process._look()
    state.trouble = ""
    process._look()
    process._look()
    assert machine.said == [
        f"n3: {state.path}: cannot be written: No space left on device; going on, trying again",
        f"n3: {state.path}: written again",
    ]


def test_a_node_whose_protocol_is_gone_says_why_and_ends(node):
    process, machine = node
    assert not process.failed
    process.node.ended("n3: the board does not answer")
    assert process.failed
    assert process.ending.is_set()
    assert machine.said == ["n3: n3: the board does not answer"]


def test_a_device_that_is_not_there_is_said_and_when_it_is(node, tmp_path):
    process, machine = node
    device, link = tmp_path / "ttyUSB0", SerialLink(str(tmp_path / "ttyUSB0"), 115_200)
    process.node.paths.append(link.path)

    async def look():
        await link.open(lambda path, data: None)
        process._look()
        device.write_text("")
        link._try_open()
        assert link.path.trouble == f"{device}: no serial port; trying again"
        device.unlink()
        far, near = os.openpty()
        device.symlink_to(os.ttyname(near))
        link._try_open()
        process._look()
        process._look()
        link.close()
        for fd in (far, near):
            os.close(fd)

    asyncio.run(look())
    assert machine.said == [f"n3: {device}: No such file or directory; trying again",
                            f"n3: serial {device}: there again"]  # fmt: skip


class Away:
    """A socket whose interface is there or not."""

    error = None

    def sendto(self, data, address):
        if self.error is not None:
            raise self.error

    def setsockopt(self, *what):
        self.sendto(b"", None)


def test_a_neighbour_that_cannot_be_sent_to_is_said_and_when_it_can_again(node):
    process, machine = node
    (path,) = process.node.paths
    path.link.socket = sock = Away()
    for error in (OSError(errno.ENETUNREACH, "Network is unreachable"), BlockingIOError(), None):
        sock.error = error
        path.send(b"frame")
        process._look()
        process._look()
    assert machine.said == [
        "n3: udp 127.0.0.1:9: cannot be sent to: Network is unreachable; trying again",
        "n3: udp 127.0.0.1:9: there again",
    ]
    assert path.counters["unsent: full"] == path.counters["unsent: Network is unreachable"] == 1


def test_an_address_that_is_gone_is_said_once_for_all_neighbours_on_it(node):
    process, machine = node
    link = UdpLink(("10.0.0.1", 4700), [("10.0.0.2", 4700), ("10.0.0.3", 4700)])
    process.node.paths[:] = link.paths

    async def look():
        link._lost(OSError(errno.ENETDOWN, "Network is down"))
        process._look()
        for path in link.paths:
            path.trouble = ""
        process._look()
        link.close()

    asyncio.run(look())
    assert machine.said == [
        "n3: udp 10.0.0.1:4700: cannot be used: Network is down; trying again",
        "n3: udp 10.0.0.2:4700: there again",
    ]


def test_a_group_whose_interface_is_gone_is_said_and_when_it_is_back(node):
    process, machine = node
    link = MulticastLink(("239.77.0.1", 4700), "10.0.2.1")
    process.node.paths[:] = link.paths
    link.socket = sock = Away()

    async def look():
        for code in (errno.ENODEV, errno.EADDRINUSE):
            sock.error = OSError(code, os.strerror(code))
            link._renew()
            process._look()
            link._again.cancel()

    asyncio.run(look())
    assert machine.said == [
        "n3: udp 239.77.0.1:4700 on 10.0.2.1: not in the group: No such device; trying again",
        "n3: udp 239.77.0.1:4700 on 10.0.2.1: there again",
    ]


def test_keys_that_other_users_can_read_are_named(tmp_path):
    path, key = tmp_path / "n3.toml", tmp_path / "net.key"
    key.write_text(KEY.hex())
    for text, who in ((FILE.format(key=KEY.hex()), path), (FILE.format(key="file:net.key"), key)):
        path.write_text(text)
        for mode, found in ((0o600, []), (0o640, [who]), (0o604, [who])):
            path.chmod(0o600)
            key.chmod(0o600)
            who.chmod(mode)
            assert open_keys(load(path)) == found
