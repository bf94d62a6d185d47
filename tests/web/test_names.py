"""Whom a page's server answers, where it says that it is, and which numbers a page may send."""

import socket

import pytest

from innervate.web import serve
from innervate.web.errors import Refused, WatchError
from innervate.web.guard import TOKEN_GIVEN, Guard
from innervate.web.messages import LENGTH_MAX, Cut, Give, Seek, Touch, number, parse
from innervate.web.server import _NAME
from innervate.web.stage import WAITING_MAX, Stage


@pytest.mark.parametrize(
    ("host", "shown"),
    [("127.0.0.1", "127.0.0.1"), ("::1", "[::1]"), ("box.example", "box.example"),
     *((anywhere, socket.gethostname()) for anywhere in ("0.0.0.0", "::", ""))],
)  # fmt: skip
def test_the_address_of_a_page(host, shown):
    assert serve._address(host, 80, "secret") == f"http://{shown}:80/?token=secret"
    assert serve._address(host, 80, "a b/c&d#e").endswith(":80/?token=a%20b%2Fc%26d%23e")


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", ""])
def test_a_port_is_listened_at_or_it_is_said_why_not(host):
    with serve._bound(host, 0) as sock:
        port = sock.getsockname()[1]
        with pytest.raises(WatchError, match=rf"cannot listen at {host}:{port}: Address"):
            serve._bound(host, port)


def test_ports_that_cannot_be():
    with pytest.raises(WatchError, match=r"cannot listen at 127\.0\.0\.1:70000: .*--port"):
        serve._bound("127.0.0.1", 70_000)


@pytest.mark.parametrize(
    ("origin", "is_ours"),
    [(None, True), ("http://Box.example:80", True), ("https://box.example:80", True),
     ("http://box.example", False), ("http://evil.example:80", False), ("null", False),
     ("http://box.example:80.evil", False), ("ftp://box.example:80", False)],
)  # fmt: skip
def test_a_page_is_ours_or_there_is_none_behind_a_request(origin, is_ours):
    headers = {"host": "BOX.example:80"} | ({} if origin is None else {"origin": origin})
    assert Guard("box.example").is_own_page(headers) == is_ours


def test_tokens_are_drawn_for_each_server_unless_one_is_given(monkeypatch):
    monkeypatch.delenv(TOKEN_GIVEN, raising=False)
    one, other = Guard("a"), Guard("a")
    assert one.token != other.token
    assert len(one.token) == 24
    assert one.has_token(one.token)
    for wrong in ("", one.token[:-1], one.token + "x", other.token, "\u00e4"):
        assert not one.has_token(wrong)
    monkeypatch.setenv(TOKEN_GIVEN, "known")
    assert Guard("a").token == "known"
    assert not Guard("a").knows({})
    assert Guard("mine.example").knows({"host": "mine.example:99"})


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ('{"do": "cut", "link": 0}', Cut(0)),
        ('{"do": "cut", "link": 100000000}', Cut(100_000_000)),
        ('{"do": "cut", "link": 100000001}', None), ('{"do": "cut", "link": -1}', None),
        ('{"do": "touch", "node": 1, "value": 255}', Touch(1, 255)),
        ('{"do": "touch", "node": 1, "value": 256}', None), ('{"do": "touch", "node": 1}', None),
        ('{"do": "command", "code": 255, "value": 65535}', Give(255, 65_535)),
        ('{"do": "command", "code": 1}', Give(1, 0)), ('{"do": "command", "code": 256}', None),
        ('{"do": "command", "code": 1, "value": 65536}', None),
        ('{"do": "seek", "t_s": 1e9}', Seek(1e9)), ('{"do": "seek", "t_s": 1.1e9}', None),
        ('{"do": "seek", "t_s": -0.1}', None), ('{"do": "seek"}', None),
    ],
)  # fmt: skip
def test_numbers_that_commands_may_have(text, command):
    if command is None:
        with pytest.raises(Refused, match="not a command"):
            parse(text)
    else:
        assert parse(text) == command


def test_a_command_has_a_length():
    command = '{"do": "cut", "link": 1}'
    assert parse(command.ljust(LENGTH_MAX)) == Cut(1)
    assert LENGTH_MAX == 4096
    with pytest.raises(Refused, match="at most 4096 characters"):
        parse(command.ljust(LENGTH_MAX + 1))


@pytest.mark.parametrize(
    ("given", "count", "is_there"),
    [(0, 1, True), (4, 5, True), (5, 5, False), (0, 0, False), (-1, 5, False)],
)
def test_a_link_or_node_is_there_by_its_number(given, count, is_there):
    if is_there:
        assert number("node", given, count) == given
    else:
        with pytest.raises(Refused, match=rf"there is no node {given}; they are numbered 0 to"):
            number("node", given, count)


def test_so_many_commands_may_wait():
    stage = Stage(None, lambda snapshot: None)
    for _ in range(WAITING_MAX):
        stage.submit(Cut(1), lambda answer: None)
    with pytest.raises(Refused, match="too many commands wait"):
        stage.submit(Cut(1), lambda answer: None)


@pytest.mark.parametrize(("name", "is_one"), [
    ("index.html", True), ("a-b_c.js", True), (".hidden", False), ("", False), ("a/b", False),
    ("..", False), ("a\x00", False),
])  # fmt: skip
def test_names_of_files_that_are_served(name, is_one):
    assert bool(_NAME.fullmatch(name)) == is_one
