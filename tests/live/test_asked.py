"""What a node's process answers on its socket, request by request, and how it takes over keys."""

import asyncio
import re

import pytest

from innervate.live import main
from innervate.live.enrolment import Authority
from innervate.live.machine import Machine, on
from innervate.live.nodefile import load
from innervate.live.receipts import ACCEPTED, DELIVERED, EXPIRED, HOP_ACKED, Receipt
from tests.live.test_said import FILE, KEY

OTHER = bytes([7]) * 32


class Quiet(Machine):
    def __init__(self):
        self.said = []

    def say(self, text):
        self.said.append(text)


class Writer:
    """Keeps the lines that were answered; `full` holds them up."""

    def __init__(self):
        self.lines = []
        self.is_last = False

    async def line(self, answer):
        self.lines.append(answer)


@pytest.fixture
def process(tmp_path):
    path = tmp_path / "n3.toml"
    path.write_text(FILE.format(key=KEY.hex()))
    with on(Quiet()) as _:

        async def made():
            return main.Process(load(path))

        yield asyncio.run(made())


def answered(process, **request):
    async def ask():
        writer = Writer()
        await process._answer(request, writer)
        return writer.lines

    return asyncio.run(ask())


async def soon():
    for _ in range(5):
        await asyncio.sleep(0)


@pytest.mark.parametrize(
    ("wait", "moves", "told"),
    [
        (True, [[HOP_ACKED], [DELIVERED]], [ACCEPTED, HOP_ACKED, DELIVERED]),
        (True, [[HOP_ACKED, EXPIRED]], [ACCEPTED, EXPIRED]),
        (True, [[ACCEPTED], [EXPIRED]], [ACCEPTED, EXPIRED]), (False, [[DELIVERED]], [ACCEPTED]),
    ],
)  # fmt: skip
def test_each_change_of_a_message_is_told_once_until_its_end(process, wait, moves, told):
    async def follow():
        receipt, writer = Receipt(), Writer()
        process.node.send_request = lambda request: receipt
        task = asyncio.ensure_future(process._answer({"do": "send", "wait": wait}, writer))
        for at_once in moves:
            await soon()
            for state in at_once:
                receipt.move(state, "why" if state == EXPIRED else "")
        await asyncio.wait_for(task, 5)
        return writer.lines

    lines = asyncio.run(follow())
    assert [line["state"] for line in lines] == told
    assert lines[-1]["reason"] == ("why" if told[-1] == EXPIRED else "")


def test_a_message_that_has_its_end_at_once_is_told_once(process):
    receipt = Receipt()
    receipt.move(EXPIRED, "no route")
    process.node.send_request = lambda request: receipt
    assert answered(process, do="send") == [{"state": EXPIRED, "reason": "no route"}]
    process.node.send_request = lambda request: None
    with pytest.raises(ValueError, match="a mesh has no messages"):
        answered(process, do="send")


@pytest.mark.parametrize(
    ("what", "given", "cut", "loss"),
    [("cut", {}, True, 0.0), ("loose", {"loss": 0.25}, False, 0.25),
     ("restore", {"loss": 0.25}, False, 0.0)],
)  # fmt: skip
def test_a_path_is_cut_loosened_and_restored(process, what, given, cut, loss):
    (path,) = process.node.paths
    path.cut, path.loss = what == "restore", 0.5
    (line,) = answered(process, do=what, port=0, **given)
    assert line == {"path": path.name, "cut": cut, "loss": loss}
    assert (path.cut, path.loss) == (cut, loss)


def test_what_can_be_asked_is_said_and_a_network_may_add_to_it(process):
    with pytest.raises(ValueError, match=r"status, send, listen, .*, stop, locate$"):
        answered(process, do="dance")
    process.node.requests["dance"] = lambda request: {"danced": request["to"]}
    assert answered(process, do="dance", to="x") == [{"danced": "x"}]
    (told,) = answered(process, do="status")
    assert told["name"] == "n3"
    assert not process.ending.is_set()
    assert answered(process, do="stop") == [{"ok": True}]
    assert process.ending.is_set()
    with pytest.raises(ValueError, match="this node has no identity"):
        answered(process, do="revoke", list="00")


def test_who_listens_gets_what_comes_and_how_much_was_missed(process, monkeypatch):
    monkeypatch.setattr(main, "HEARD_MAX", 5)
    node = process.node

    async def listen():
        writer = Writer()
        task = asyncio.ensure_future(process._answer({"do": "listen"}, writer))
        await soon()
        for number in range(3):
            node.arrivals.put((number, b"x"))
        node.arrivals.hand_up()
        await soon()
        for number in range(4):  # each of 2 KiB of digits counts three times
            node.arrivals.put((number, bytes(1024)))
        node.arrivals.hand_up()
        await soon()
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        await soon()
        return writer.lines, node.arrivals.callbacks

    lines, left = asyncio.run(listen())
    assert lines[0] == {"listening": "n3"}
    assert [line.get("from", line) for line in lines[1:]] == [0, 1, 2, 0, {"missed": 3}]
    assert left == []


@pytest.mark.parametrize("breaks", [False, True])
def test_who_hangs_up_leaves_nothing_behind_though_nothing_comes(process, breaks):
    """Also who is gone before the first answer."""
    node = process.node

    async def listen():
        writer = Writer()
        if breaks:
            writer.line = fails
        task = asyncio.ensure_future(process._listen({"do": "listen"}, writer))
        await soon()
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        await soon()
        assert writer.is_last
        return node.arrivals.callbacks

    async def fails(_):
        raise ConnectionResetError

    assert asyncio.run(listen()) == []


@pytest.mark.parametrize(("chars", "weight"), [(0, 1), (1023, 1), (1024, 2), (2047, 2), (2048, 3)])
def test_a_message_counts_for_its_length(chars, weight):
    assert main._weight({"payload": "0" * chars}) == weight
    assert main._weight({"alarm": "x" * 5000}) == 1


def test_keys_are_taken_over_by_a_hangup_and_what_else_has_changed_is_said(process):
    path, text = process.loaded.path, process.loaded.path.read_text()

    async def hang_up(new):
        path.write_text(new)
        process.reload()
        found = process.node.sealer.status()
        process.rotation.stop()
        return found

    with on(Quiet()) as _:
        said = main.machine().said
        more = f'use = 2\ngrace_s = 5.5\nsecret.2 = "{OTHER.hex()}"'
        told = asyncio.run(hang_up(text.replace("use = 1", more)))
        assert told == {"use": 1, "accepted": [1, 2]}
        assert said == ["n3: keys reloaded: 2 seals after 5.5 s"]
        asyncio.run(hang_up(text.replace("nodes = 5", "nodes = 6\nsocket = 'x.sock'")))
        assert said[-1].endswith(
            "1 seals after 10 s; restart it for what else has changed: nodes, socket"
        )
        asyncio.run(hang_up(text.replace("number = 3", "nombre = 3")))
        assert said[-1].startswith("n3: not reloaded: ")
        asyncio.run(hang_up(text[: text.index("[keys]")] + text[text.index("[[link]]") :]))
        assert said[-1].endswith("only other keys can be taken over without restart")
        asyncio.run(hang_up(text.replace(KEY.hex(), OTHER.hex())))
        assert "keys.secret.1 is another key now" in said[-1]


@pytest.mark.parametrize(
    ("engine", "why", "sealed", "end"),
    [("python", "", True, "1 path"), ("auto", "", True, "1 path, in C"),
     ("auto", "no compiler", True, "1 path, not in C: no compiler"),
     ("python", "", False, "1 path; no key: frames can be read and forged by anybody in reach")],
)  # fmt: skip
def test_the_line_by_which_a_node_says_that_it_is_ready(process, engine, why, sealed, end):
    process.engine, process.node.not_in_c = engine, why
    if not sealed:
        process.node.sealer = None
    assert process._ready() == f"ready: mesh node 3 of 5, {end}"
    process.node.is_awake = True
    paths, no_key = re.fullmatch("([^;]*)(;.*)?", end).groups("")
    ready = f"ready: mesh node 3 of 5, {paths}, keeps processors awake{no_key}"
    assert process._ready() == ready


def test_an_identity_is_taken_over_by_a_restart_only(process, tmp_path):
    Authority(tmp_path).enrol(3)
    path, text = process.loaded.path, process.loaded.path.read_text()
    start, end = text.index("[keys]"), text.index("[[link]]")
    path.write_text(f'{text[:start]}[keys]\nidentity = "n3.identity"\n{text[end:]}')
    with on(Quiet()) as _:
        process.reload()
        said = main.machine().said
        assert said == [f"n3: not reloaded: {path}: an identity is taken over by a restart only"]
