"""A node of the ring on MicroPython: played a plain run, and as a folder on real serial ports."""

import asyncio
import contextlib
import re

import pytest

from boards import __main__ as build
from boards.errors import BoardMissing
from boards.parity import __main__ as parity
from boards.parity import nodejs, record
from boards.roles import roles
from innervate.live.declared import DeclaredNode, DeclaredStack
from innervate.live.serial import SerialLink
from innervate.live.serial_cables import Cables
from innervate.network import networks
from tests.boards.test_boards_cell import board as started
from tests.live.net import until

LOADED = 'kind = "tokenring"\nloads = true\n' + "".join(
    f'[[event]]\nat_s = {at}\naction = "{action}"\nnode = 1\n'
    for action, at in (("cut", 0.1), ("restore", 0.15), ("kill", 0.2), ("revive", 0.25),
                       ("restart", 0.3))
)  # fmt: skip


@pytest.fixture(autouse=True)
def micropython(known):
    try:
        nodejs.home()
    except BoardMissing as missing:
        pytest.skip(str(missing))


def test_micropython_does_call_by_call_what_a_plain_run_did(tmp_path):
    file = tmp_path / "loaded.toml"
    file.write_text(LOADED)
    role = roles()["tokenring"]
    told = record.record(role, file)
    assert {row[0] for row in told.calls} == {0, 1, 2, 3}  # started, frames, timers, inputs
    assert len(told.marks) > 100
    played = nodejs.play(told)
    assert played.marks == told.marks
    assert record.compiled_mark(role, file) == (told.marks[-1][0], told.fingerprint)


def test_the_command_knows_it(capsys):
    assert parity.main(["tokenring"]) == 0
    said = capsys.readouterr().out
    assert "tokenring: as it is by itself, node 1" in said
    assert "calls, each the same" in said
    assert "all the same" in said


def test_a_mistake_in_it_is_noticed(monkeypatch):
    told, joined = record.record(roles()["tokenring"]), build.join.joined

    def wrong(entry, noted):
        return joined(entry, noted=noted).replace("node.passed + 1", "node.passed + 2")

    monkeypatch.setattr(build.join, "joined", wrong)
    assert nodejs.play(told).marks != told.marks


@contextlib.contextmanager
def board(folder, number, *devices):
    """A board whose folder was made by `python -m boards`, its ports W and E on serial ports."""
    assert build.main(["tokenring", str(folder), "hold_us=2000", "lost_us=300000"]) == 0
    main = (folder / "main.py").read_text().replace("NUMBER = 1", f"NUMBER = {number}")
    uarts = "UARTS = ((0, {}), (1, {}), None, None)\n"
    (folder / "main.py").write_text(re.sub(r"UARTS = \(\n.*?\n\)\n", uarts, main, flags=re.DOTALL))
    (folder / "machine.py").write_bytes((nodejs.HERE / "machine.py").read_bytes())
    with started(folder, *devices) as process:
        yield process


def test_a_board_and_a_live_node_pass_the_token_over_serial_cables(tmp_path):
    async def main():
        cables, heard = Cables(2), []
        cables.start()
        west, east = (SerialLink(cables.devices[i], 1_000_000) for i in (2, 0))
        params = {"hold_us": 2000, "lost_us": 300_000}
        stack = DeclaredStack(networks()["tokenring"], 0, params, 1, [0, 1])
        maker = DeclaredNode("n0", stack, [west, east])
        maker.receive(heard.append)
        with board(tmp_path / "board", 1, cables.devices[1], cables.devices[3]):
            await maker.start()
            await until(lambda: maker.stack.node.lap > 20)
            maker.give(1, {"load": [3, 4]})
            await until(lambda: heard and heard[-1]["lap"] > 25)
            cables.cut = {0}
            await asyncio.sleep(0.2)
            at = len(heard)
            cables.cut = set()
            await until(lambda: len(heard) > at + 5)  # the loss was mended
        await maker.stop()
        cables.stop()

    asyncio.run(main())
