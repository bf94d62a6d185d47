"""Asking running nodes: answers in pieces, too many, too late, or of nobody; by a clock of ours."""

import socket
from contextlib import closing, contextmanager, suppress
from types import SimpleNamespace

import pytest

from innervate.live.status import FULL
from innervate.web import live_poll
from innervate.web.live_poll import AGAIN_S, LINE_MAX, Poller, _Line


class Node:
    """The socket of a node; it takes calls and answers when it is told to."""

    def __init__(self, path):
        self.path = path
        self.server = socket.socket(socket.AF_UNIX)
        self.server.bind(str(path))
        self.server.listen()
        self.call = None

    def take(self):
        """The lines that were asked since the last time, by a new caller if there is one."""
        self.server.setblocking(False)
        with suppress(BlockingIOError):
            while True:
                self.call, _ = self.server.accept()
        try:
            return self.call.recv(100_000, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return b""

    def close(self):
        self.server.close()
        if self.call is not None:
            self.call.close()


@pytest.fixture
def node(tmp_path):
    with closing(Node(tmp_path / "n")) as made:
        yield made


@pytest.fixture
def clock(monkeypatch):
    made = SimpleNamespace(now=100.0)
    made.monotonic = lambda: made.now
    monkeypatch.setattr(live_poll, "time", made)
    return made


def test_an_answer_may_come_in_pieces_and_more_than_one_at_once(node):
    line = _Line(node.path)
    assert line.send({"do": "status"})
    assert node.take() == b'{"do": "status"}\n'
    node.call.sendall(b'{"a": ')
    assert line.take() is None
    node.call.sendall(b'1}\n{"b": 2}\n{"c"')
    assert line.take() == {"a": 1}
    node.call.sendall(b": 3}\n")
    assert line.take() == {"b": 2}
    line.drop()
    assert line.send({})
    assert node.take() == b"{}\n"
    node.call.sendall(b'{"d": 4}\n')
    assert line.take() == {"d": 4}, "what was left of the call before is not taken for it"
    line.drop()


@pytest.mark.parametrize(("said", "error"), [
    (b"[1]\n", ValueError), (b"rubbish\n", ValueError), (b"\xff\n", ValueError), (None, OSError),
])  # fmt: skip
def test_what_is_no_answer(node, said, error):
    line = _Line(node.path)
    line.send({})
    node.take()
    if said is None:
        node.call.close()
    else:
        node.call.sendall(said)
    with pytest.raises(error):
        line.take()
    line.drop()


@pytest.mark.parametrize(("length", "is_taken"), [(LINE_MAX, True), (LINE_MAX + 1, False)])
def test_an_answer_without_an_end_is_given_up(node, length, is_taken):
    line = _Line(node.path)
    line.send({})
    node.take()
    line.read = b"x" * length
    node.call.sendall(b"x")
    if is_taken:
        assert line.take() is None
    else:
        with pytest.raises(OSError, match=r"^$"):
            line.take()
    line.drop()


def test_a_node_that_is_not_there_is_left_alone_for_a_while(node, clock):
    line = _Line(node.path)
    assert line.send({})
    line.drop(gone=True)
    assert line.is_gone
    for later_s, is_asked in ((0.0, False), (AGAIN_S - 0.01, False), (AGAIN_S, True)):
        clock.now = 100.0 + later_s
        assert line.send({}) == is_asked
    line.drop()  # it was only slow
    assert not line.is_gone
    assert line.send({})
    line.drop()
    node.close()
    assert not line.send({})
    assert line.is_gone


@contextmanager
def answering(**said):
    """A selector under which nodes answer as soon as somebody waits for them."""
    real = live_poll.selectors.DefaultSelector

    class Selector(real):
        def select(self, timeout=None):
            for node, what in said.values():
                if node.take():
                    node.call.close() if what is None else node.call.sendall(what)
            return super().select(min(timeout, 0.05))

    live_poll.selectors.DefaultSelector = Selector
    try:
        yield
    finally:
        live_poll.selectors.DefaultSelector = real


def test_who_answers_in_time_who_is_slow_and_who_is_gone(tmp_path):
    with closing(Node(tmp_path / "a")) as a, closing(Node(tmp_path / "b")) as b:
        poller = Poller([a.path, b.path, tmp_path / "c"])
        with answering(a=(a, b'{"a": 1}\n'), b=(b, b"")):
            assert poller.ask({0: {}, 1: {}, 2: {}}, 0.1) == {0: {"a": 1}}
        assert [poller.is_gone(i) for i in range(3)] == [False, False, True]
        b.call.close()
        late = poller._lines[1]
        assert (late.sock, late.read) == (None, b""), "an answer that comes now is to nothing asked"
        with answering(a=(a, b'{"a": 2}\n'), b=(b, b'{"b": 2}\n')):
            assert poller.ask({0: {}, 1: {}}, 1.0) == {0: {"a": 2}, 1: {"b": 2}}
        a.call.close()
        with answering(b=(b, b'{"b": 3}\n')):
            assert poller.ask({0: {}, 1: {}}, 1.0) == {1: {"b": 3}}
        assert [poller.is_gone(i) for i in range(3)] == [True, False, True]
        poller._lines[0].not_before = 0.0
        with answering(a=(a, b'{"a": 4}\n')):
            assert poller.ask({0: {}}, 1.0) == {0: {"a": 4}}
        assert not poller.is_gone(0)
        with answering(a=(a, None)):  # it ends when it is asked
            assert poller.ask({0: {}}, 1.0) == {}
        assert poller.is_gone(0)
        poller.close()
        assert [one.sock for one in poller._lines] == [None] * 3


def test_who_turns_us_away_has_told_nothing_and_is_not_gone(tmp_path):
    """A node that hung for a minute finds more callers than it lets in: us, all the while."""
    with closing(Node(tmp_path / "a")) as a, closing(Node(tmp_path / "b")) as b:
        poller = Poller([a.path, b.path])
        with answering(a=(a, FULL), b=(b, b'{"b": 1}\n')):
            assert poller.ask_all({}) == {1: {"b": 1}}
        assert not poller.is_gone(0)
        with answering(a=(a, b'{"a": 1}\n'), b=(b, b'{"b": 2}\n')):
            assert poller.ask_all({}) == {0: {"a": 1}, 1: {"b": 2}}
        poller.close()
