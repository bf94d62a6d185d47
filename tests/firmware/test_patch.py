"""A patch of emulated cells around an ordinary PC: comes up, is cut, is killed, heals."""

import asyncio
import os
import re
import shutil
import signal
from pathlib import Path

import pytest

from innervate import scenario as scenarios
from innervate.cli import main
from innervate.firmware import patch
from innervate.live import status
from tests.live.net import running, until

FIRST_S = 60.0
FOUR = {
    "kind": "skin", "name": "four", "patch": [{"columns": 2, "rows": 2}],
    "interface": [{"patch": 0, "row": 0, "column": 0}, {"patch": 0, "row": 1, "column": 1}],
    "protocol": {"beacon_hz": 10}, "data": {"rate_hz": 5},
}  # fmt: skip


@pytest.fixture(autouse=True)
def tools():
    for name in ("arm-none-eabi-gcc", "qemu-system-arm"):
        if shutil.which(name) is None:
            pytest.skip(f"{name} is not installed")


def asked(network, name):
    return status.ask_one(network.socket(name), {"do": "status"})


def parents(network):
    return [asked(network, name)["parent"] for name in network.names if name != "pc"]


def samples(network):
    return asked(network, "pc")["counters"].get("samples received", 0)


async def heals(network, *cells):
    """Every cell has a way to the PC, which counts so many behind its ports."""

    def whole():
        return None not in parents(network) and asked(network, "pc")["cells"] == list(cells)

    await until(whole, FIRST_S)


def children(pid):
    return Path(f"/proc/{pid}/task/{pid}/children").read_text().split()


def test_four_cells_of_firmware_come_up_and_heal(tmp_path):
    plan = scenarios.plan(scenarios.from_dict(FOUR))
    images = patch.images(plan, tmp_path, ["c2"])
    assert sorted(images) == ["c0", "c1", "c3"]  # c2 stays in Python, the PC is a PC

    async def go():
        async with running(plan, tmp_path / "run", "udp", None, images) as network:
            await heals(network, 2, 2)
            await network.change(network.links.index((0, 4)), "cut")
            await until(lambda: asked(network, "c0")["dist"] == 3, FIRST_S)
            await heals(network, 0, 4)
            board = children(network.processes["c1"].pid)
            assert len(board) == 1
            await network.end_node("c1", gently=False)
            await until(lambda: not Path(f"/proc/{board[0]}").exists(), FIRST_S)
            await until(lambda: asked(network, "pc")["cells"] == [0, 3], FIRST_S)
            await network.begin_node("c1")
            await heals(network, 0, 4)
            got = samples(network)
            await until(lambda: samples(network) > got + 20, FIRST_S)
            os.kill(int(children(network.processes["c1"].pid)[0]), signal.SIGKILL)
            await until(lambda: network.processes["c1"].poll() is not None, FIRST_S)
            assert network.processes["c1"].returncode == 1
            said = (tmp_path / "run/c1.log").read_text().splitlines()[-1]
            assert re.fullmatch(
                r"c1: its board is gone: \S+qemu-system-arm ended \(SIGKILL\)", said
            )
            await until(lambda: asked(network, "pc")["cells"] == [0, 3], FIRST_S)

    asyncio.run(go())


def test_what_cannot_be_brought_up_is_one_line(tmp_path, capsys, monkeypatch):
    for words, said in (
        (["mesh-field"], "among live nodes on serial lines"),
        (["setup-3", "--in-python", "c99999"], "--in-python c99999"),
    ):
        assert main(["live", "up", words[0], "--firmware", *words[1:]]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert said in line
    assert main(["live", "up", "setup-3", "--in-python", "c1"]) == 2
    assert "beside --firmware" in capsys.readouterr().err
    monkeypatch.setenv("PATH", str(tmp_path))
    plan = scenarios.plan(scenarios.from_dict(FOUR))
    with pytest.raises(Exception, match="qemu-system-arm is missing"):
        patch.images(plan, tmp_path, [])
