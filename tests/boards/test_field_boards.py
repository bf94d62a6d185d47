"""A board over a field among live nodes: in C on an emulated processor, and on MicroPython."""

import asyncio
import contextlib
import re
import shutil

import pytest

from boards import __main__ as build
from boards.errors import BoardMissing
from boards.parity import nodejs
from innervate.cli import main
from innervate.firmware import library, tools
from innervate.live.in_field import FieldNode, FieldStack
from innervate.live.serial import SerialLink
from innervate.live.serial_cables import Cables
from innervate.network import networks, use
from tests.boards.test_boards_cell import board as on_micropython
from tests.firmware.test_boards_live import QUICKLY
from tests.firmware.test_boards_live import board as emulated
from tests.live.net import until
from tests.own import alone, made

__all__ = ["alone"]
pytestmark = pytest.mark.flaky(reruns=1)  # boards in real time, as in test_boards_sealed.py
TOLD = ("kind", "origin", "seq", "value")
BOARD, NOBODY, FIRST_S = 1, 9, 60.0
ASKED = """
ASK = 1
ANSWER = 2
ENDED = 3


def on_start(node, params, now, cause, out):
    'Nobody has asked.'
    node.told = 0


def on_frame(node, params, now, port, frame, out):
    'Answer with how loud it was; hand down what else comes.'
    if frame.kind == ASK:
        node.told = frame.seq
        say(node, ANSWER, 65535, frame.seq, frame.rssi + 200 + port, out)
        return
    copy = out.frame[deliver(out, frame.kind)]
    copy.kind = frame.kind
    copy.to = frame.to
    copy.origin = frame.origin
    copy.seq = frame.seq
    copy.value = frame.value
    copy.rssi = frame.rssi
    copy.made_at = frame.made_at


def on_timer(node, params, now, timer, out):
    'None is set.'


def on_input(node, params, now, kind, item, out):
    'Ask somebody.'
    say(node, ASK, item.to, item.seq, 0, out)


def on_sent(node, params, now, ok, out):
    'Our answer has ended: say so, once.'
    if node.told > 0:
        say(node, ENDED, 65535, node.told, ok, out)
        node.told = 0


def say(node, kind, to, seq, value, out):
    'Put a frame on the air.'
    frame = out.frame[send(out, 0, 0, 0)]
    frame.kind = kind
    frame.to = to
    frame.origin = node.number
    frame.seq = seq
    frame.value = value
    frame.made_at = 0
"""
FIELDS = """
STATE = (
    ("number", 0, 0, 65535, "node", "who we are"),
    ("told", 0, 0, 255, "number", "of the question; 0 none"),
)
FRAME = (
    ("kind", 0, 0, 3, "type", "1 ask, 2 answer, 3 ended"),
    ("to", 0, 0, 65535, "node", "whom it is for"),
    ("origin", 0, 0, 65535, "node", "who says it"),
    ("seq", 0, 0, 255, "number", "of a question"),
    ("value", 0, 0, 255, "raw", "how loud it was, + 200; how its end was told"),
    ("rssi", 0, -128, 127, "dBm", "how loud it came in"),
    ("made_at", 0, 0, 1073741823, "us", "when it was handed in"),
)
PARAMS = ()
GIVEN = ((1, {"to": 1}),)
"""
FIELD = '("{0}", 0, {1}, 0), '
SENT = (("to", 16), ("origin", 16), ("seq", 8), ("value", 8))
LAYOUTS = "KIND_BITS = 4\nLAYOUTS = (\n" + "".join(
    f'    ({kind}, "{name}", ('
    + "".join(FIELD.format(*one) for one in SENT)
    + ")),\n"
    for kind, name in ((1, "ask"), (2, "answer"), (3, "ended"))
) + ")\n"  # fmt: skip


def on_carrier(text):
    """The same of a protocol with no medium access below it: it is told when the air is free."""
    was = "def on_sent(node, params, now, ok, out)"
    told = "def on_carrier(node, params, now, cd, voc, out)"
    assert text.count(was) == 1
    return text.replace(was, told).replace("told, ok, out)", "told, 1 - cd, out)")


@pytest.fixture(params=["csma", ""], ids=["above csma", "on the air"])
def asked(request, alone, monkeypatch):
    """A network whose nodes ask each other how loud they are."""
    own = made(alone / "asked", "field", request.param)
    head = (own.folder / "protocol.py").read_text().partition("\nNEWS = ")[0]
    head = head.replace("from innervate.dialect.access import ALL\n", "")
    body = ASKED if request.param else on_carrier(ASKED)
    text = f"{head}\nTIMERS = 1\nOUTBOX = 4{body}"
    used = {"MASK30": "& MASK30", "set_timer": "set_timer(", "draw": "draw("}
    for name, word in used.items():
        assert word not in body
        text = re.sub(rf"from \S+ import {name}\n", "", text)
        text = re.sub(rf", {name}\b", "", text)
    (own.folder / "protocol.py").write_text(text)
    (own.folder / "frames.py").write_text(LAYOUTS)
    (own.folder / "fields.py").write_text(FIELDS)
    (own.folder / "test_asked.py").unlink()
    (own.folder / "invariants.py").write_text('"""Nothing."""\n')
    monkeypatch.setenv("INNERVATE_NETWORKS", str(own.folder))
    networks.cache_clear()
    yield own
    networks.cache_clear()


@contextlib.contextmanager
def in_c(folder, device):
    """The C that `innervate firmware` writes, on a Cortex-M3 in QEMU."""
    for name in ("arm-none-eabi-gcc", "qemu-system-arm"):
        if shutil.which(name) is None:
            pytest.skip(f"{name} is not installed")
    lib = folder.parent / "lib"
    library.write(library.made_of(str(folder), []), lib)
    options = (*QUICKLY, f"-DNUMBER={BOARD}", "-DSEED=4711", "-DASKED_PORTS_MAX=1")
    with emulated(tools.image(lib, "asked", folder.parent, "small", options), [device]) as process:
        yield process


@contextlib.contextmanager
def in_python(folder, device):
    """The folder that `python -m boards` writes, on MicroPython under Node.js."""
    try:
        nodejs.home()
    except BoardMissing as missing:
        pytest.skip(str(missing))
    where = folder.parent / "board"
    assert build.main(["asked", str(where)]) == 0
    text = (where / "main.py").read_text()
    text = re.sub(r"UARTS = \(\n.*?\n\)\n", "UARTS = ((0, {}), None)\n", text, flags=re.DOTALL)
    (where / "main.py").write_text(text.replace("NUMBER = 1", f"NUMBER = {BOARD}"))
    (where / "machine.py").write_bytes((nodejs.HERE / "machine.py").read_bytes())
    with on_micropython(where, device) as process:
        yield process


@pytest.mark.parametrize("begun", [in_c, in_python])
def test_a_board_answers_who_asks_it_and_says_when_its_answer_has_ended(begun, asked):
    assert main(["check-protocol", str(asked.folder), "--no-tests"]) == 0

    async def go(cables):
        heard = []
        stack = FieldStack(use(asked.folder), 0, {}, 1, [0])
        pc = FieldNode("pc", stack, [SerialLink(cables.devices[0], 1_000_000)])
        pc.receive(lambda frame: heard.append(tuple(frame[key] for key in TOLD)))
        with begun(asked.folder, cables.devices[1]):
            async with pc:
                await until(lambda: pc.give(1, {"to": BOARD, "seq": 1}) or heard, FIRST_S)
                pc.give(1, {"to": NOBODY, "seq": 2})
                pc.give(1, {"to": 65535, "seq": 3})
                await until(lambda: heard[-1][0] == 3 and heard[-1][2] == 3)
        return heard

    cables = Cables(1)
    cables.start()
    try:
        found = asyncio.run(go(cables))
    finally:
        cables.stop()
    assert [one for one in found if one[2] > 1] == [(2, BOARD, 3, 150), (3, BOARD, 3, 1)]
