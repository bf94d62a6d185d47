"""What a live node does with frames that leave and come in: counted, sealed, told to taps."""

import asyncio
from itertools import compress
from types import SimpleNamespace

import pytest

from innervate.live.engine import clock_us
from innervate.live.links import Link, Path
from innervate.live.machine import Machine, machine, on
from innervate.live.node import CUT, LiveNode
from innervate.live.state import State
from tests.live import time_by_hand
from tests.live.net import Mesh
from tests.live.test_engine import Stack


class Plug(Path):
    """A path that keeps what is sent on it."""

    def __init__(self, port):
        super().__init__(f"plug {port}", port)
        self.own, self.said = f"here {port}", []

    def send(self, data):
        self.said.append(data)
        self.sent(data)


class Plugs(Link):
    def __init__(self, *ports, strangers=0, unread=0):
        self.paths = [Plug(port) for port in ports]
        self.strangers, self.dropped = strangers, unread
        self.is_open = None

    async def open(self, receive):
        self.receive, self.is_open = receive, True

    def close(self):
        self.is_open = False

    def unread(self):
        return self.dropped


class Plain(Stack):
    """A protocol whose frames are bytes, on the ports that it is told."""

    silent_us = 1_000_000
    ports = None

    def encode(self, frame):
        return frame

    def ports_of(self, port, frame, attempt):
        return self.ports

    def status(self, now):
        return {"kind": "plain", "clock": now}


class Sealer:
    """Turns bytes round; what begins with "x" is not taken, with "c" said below the protocol."""

    def __init__(self):
        self.refused, self.taken, self.done = 0, [], []
        self.dropped, self.counts = {"sealed: x": 3}, {"handshakes": 2}

    def start(self, paths):
        self.done.append([path.port for path in paths])

    def stop(self):
        self.done.append("stop")

    def status(self):
        return {"use": 1}

    def close(self, path, data):
        return data[::-1] if data != b"wait" else None

    def open(self, path, data):
        self.refused += data[:1] == b"x"
        return None if data[:1] in b"xc" else SimpleNamespace(frame=data[::-1], sender=9)

    def take(self, opened):
        self.taken.append(opened.frame)


def run(what, *links, sealer=None, state=None):
    """Have `what(node, told)` happen; `told` is what a tap was told, without its times."""

    async def main():
        node = LiveNode("n7", Plain(), [*links] or [Plugs(0, 1)], sealer, state)
        told = []
        node.taps.append(lambda _at, *one: told.append(one))
        async with node:
            await asyncio.sleep(1.5)
            await what(node, told)
        return node

    return time_by_hand.run(main())


@pytest.mark.parametrize(("seconds", "begun"), [(500, [0]), (540, [0, 1]), (3600, [0, 1])])
def test_who_did_not_run_for_half_the_protocols_clock_begins_anew(seconds, begun):
    """Behind that its times, modulo 2^30 us, lie ahead: a cell of a skin was not heard for long."""

    async def suspended(node, _told):
        node.stack.arm(0, 1_000_000)
        node.engine.call(lambda _: None, clock_us())
        clock = machine()
        read = clock.monotonic_ns
        clock.monotonic_ns = lambda: read() + seconds * 1_000_000_000
        await asyncio.sleep(2.0)
        anew = node.counters()["begun anew: did not run for long"]
        assert [cause for what, _, cause in node.stack.heard if what == "start"] == begun
        assert anew == len(begun) - 1

    run(suspended)


def test_a_path_is_known_by_its_port_and_no_other():
    node = Mesh(3, [(0, 1), (0, 2)]).nodes[0]
    assert [node.path_at(port) for port in (0, 1)] == node.paths
    for port in (-1, 2):
        with pytest.raises(ValueError, match=rf"no port {port}; this node has 0 to 1"):
            node.path_at(port)


def test_paths_of_all_links_are_opened_and_closed_with_the_node():
    links = Plugs(0), Plugs(1, 2)

    async def look(node, _told):
        assert [path.port for path in node.paths] == [0, 1, 2]
        assert [link.is_open for link in links] == [True, True]

    run(look, *links)
    assert [link.is_open for link in links] == [False, False]


@pytest.mark.parametrize(("ports", "leaves"), [(None, [0, 1, 2]), ([2, 0], [2, 0]), ([], [])])
def test_a_frame_leaves_on_the_paths_that_the_protocol_names(ports, leaves):
    async def send(node, told):
        node.stack.ports = ports
        node.paths[1].cut = True
        node._transmit(0, b"frame", 0, 0)
        assert told == [(port, True, b"frame", CUT if port == 1 else "") for port in leaves]
        for path in node.paths:
            there = path.port in leaves and path.port != 1
            assert path.said == [b"frame"] * there
            assert path.counters == ({"sent": 1, "sent bytes": 5} if there else {})

    run(send, Plugs(0, 1, 2))


def test_a_frame_that_comes_in_is_counted_told_and_handed_on_but_not_over_a_cut_path():
    async def receive(node, told):
        first, second = node.paths
        second.cut = True
        node._receive(second, b"cut")
        node._receive(first, b"frame")
        node.stack.why = "for another"
        node._receive(first, b"no")
        now = clock_us()
        assert told == [(1, False, b"cut", CUT), (0, False, b"frame", ""),
                        (0, False, b"no", "for another")]  # fmt: skip
        assert first.counters == {"received": 2, "received bytes": 7}
        assert second.counters == {}
        assert (first.heard_at, second.heard_at) == (now, 0)
        await asyncio.sleep(0.5)
        node._receive(first, b"no")
        assert first.heard_at == now, "what is not taken says nothing of who is there"
        node.stack.why = ""
        node._receive(first, b"yes")
        assert first.heard_at == now + 500_000
        assert [one for one in node.stack.heard if one[0] != "start"] == [
            (now & (1 << 30) - 1, 0), (now + 500_000 & (1 << 30) - 1, 0),
        ]  # fmt: skip

    run(receive)


class Half(Machine):
    """Draws 0.25 and 0.75 in turn."""

    def __init__(self):
        self.next = [0.25, 0.75] * 4

    @property
    def chance(self):
        return SimpleNamespace(random=lambda: self.next.pop(0))


@pytest.mark.parametrize(("loss", "kept"), [(0.0, 4), (0.5, 2), (0.75, 2), (0.76, 0), (1.0, 0)])
def test_of_what_comes_in_over_a_loose_cable_its_share_is_lost(loss, kept):
    async def receive(node, told):
        path = node.change(0, "loose", loss)
        assert (path.cut, path.loss) == (False, loss)
        with on(Half()):
            for _ in range(4):
                node._receive(path, b"1")
        assert path.counters["received"] == kept
        assert told == [(0, False, b"", "event: loose"), *[(0, False, b"1", "")] * kept]
        assert (node.change(0, "cut").cut, path.loss) == (True, 0.0)
        assert (node.change(0, "restore").cut, path.loss) == (False, 0.0)
        assert [one[3] for one in told[-2:]] == ["event: cut", "event: restore"]

    run(receive)


@pytest.mark.parametrize("first", ["cut", "apart"])
def test_a_path_that_is_cut_stays_cut_when_who_had_left_comes_back(first):
    async def receive(node, told):
        path = node.paths[0]
        whole = {"cut": "restore", "apart": "near"}
        second = {"cut": "apart", "apart": "cut"}[first]
        for what, carries in ((first, False), (second, False), (whole[first], False),
                              (whole[second], True)):  # fmt: skip
            node.change(0, what)
            assert path.carries == node.status()["paths"][0]["up"] == carries
            node._receive(path, b"1")
        assert path.counters["received"] == 1
        assert node.change(0, "loose", 0.5).loss == 0.5
        node.change(0, "apart")
        assert node.change(0, "near").loss == 0.5  # who comes and goes mends no plug

    run(receive)


@pytest.mark.parametrize("loss", [-0.01, 1.01])
def test_a_share_is_from_0_to_1(loss):
    async def refuse(node, told):
        with pytest.raises(ValueError, match="loss must be 0 to 1"):
            node.change(0, "loose", loss)
        assert (node.paths[0].loss, told) == (0.0, [])

    run(refuse)


def test_frames_are_sealed_on_the_line_and_told_in_the_clear():
    sealer = Sealer()

    async def both_ways(node, told):
        node._transmit(0, b"abc", 0, 0)
        node._transmit(0, b"wait", 0, 0)  # until somebody is there
        assert [path.said for path in node.paths] == [[b"cba"], [b"cba"]]
        node._receive(node.paths[0], b"fed")
        node._receive(node.paths[0], b"xyz")
        node._receive(node.paths[0], b"control")
        node.stack.why = "sealed by another than it is from"
        node._receive(node.paths[0], b"oh")
        assert sealer.taken == [b"def"], "of what is not taken a copy may still come"
        assert told[4:] == [(0, False, b"def", ""), (0, False, b"xyz", "seal"),
                            (0, False, b"ho", node.stack.why)]  # fmt: skip
        assert node.status()["sealed"]
        assert node.status()["keys"] == {"use": 1}
        counters = node.counters()
        assert (counters["dropped: sealed: x"], counters["handshakes"]) == (3, 2)

    run(both_ways, sealer=sealer)
    assert sealer.done == [[0, 1], "stop"]


def test_what_a_node_says_of_its_paths():
    async def look(node, _told):
        node._receive(node.paths[0], b"frame")
        for after_s, broken in ((0.0, [False, True]), (1.0, [False, True]), (1.000_01, [True] * 2)):
            node.paths[0].heard_at = clock_us() - round(1e6 * after_s)
            status = node.status()
            assert [path["broken"] for path in status["paths"]] == broken
            names = ["plug 0", "plug 1"]
            assert status["broken"] == list(compress(names, broken))
            assert [path["heard_s"] for path in status["paths"]] == [round(after_s, 3), None]
        node.paths[0].heard_at = clock_us()
        node.paths[0].cut = True
        status = node.status()
        assert [path["up"] for path in status["paths"]] == [False, True]
        assert not status["paths"][0]["broken"], "it does not know yet"
        node.paths[0].cut, node.paths[0].up = False, False
        (one, _) = node.status()["paths"]
        assert one == {"name": "plug 0", "own": "here 0", "port": 0, "up": False, "heard_s": 0.0,
                       "broken": True, "counters": {"received": 1, "received bytes": 5},
        }  # fmt: skip
        status = node.status()
        assert (status["name"], status["up_s"], status["sealed"]) == ("n7", 1.5, False)
        assert (status["kind"], status["clock"], status["keys"]) == ("plain", clock_us(), None)
        assert status["engine"] == "python"
        node.not_in_c = ""
        assert node.status()["engine"] == "c"

    run(look)


def test_a_nodes_counters_are_those_of_all_that_it_is_made_of(tmp_path):
    state = State(tmp_path / "n7.state")

    async def look(node, _told):
        node.callers["status: turned away"] = 2
        node.outcomes["messages accepted"] = 4
        state.failed, state.trouble = 5, ""  # it was full, and has room again
        node._note_report(3, 0, 0)
        node._note_report(3, 0, 0)
        node._receive(node.paths[0], b"frame")
        assert node.counters() == {
            "frames": 1, "dropped: from a stranger": 7, "status: turned away": 2,
            "dropped by the system: not for this node, or no room": 9, "state not written": 5,
            "messages accepted": 4,
        }  # fmt: skip
        assert node.reports == {3: 2}

    run(look, Plugs(0, strangers=3, unread=4), Plugs(1, strangers=4, unread=5), state=state)


@pytest.mark.parametrize("is_again", [False, True])
def test_a_node_knows_whether_it_was_here_before_and_keeps_its_state(tmp_path, is_again):
    path = tmp_path / "n7.state"
    if is_again:
        path.write_text('{"epoch": 3}')

    async def look(node, _told):
        assert [one[2] for one in node.stack.heard] == [int(is_again)]
        assert '"epoch": 3' in path.read_text() or not is_again
        node.state.epoch = 9

    run(look, state=State(path))
    assert '"epoch": 9' in path.read_text()
