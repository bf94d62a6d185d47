"""A node of the ring as C: nothing but its folder is named."""

import asyncio
import shutil
from itertools import islice
from pathlib import Path

import pytest

from boards.firmware import __main__ as parity
from boards.roles import roles
from innervate import scenario as scenarios
from innervate.cli import main
from innervate.firmware import patch
from innervate.firmware.library import role_of
from innervate.live import status
from innervate.live.up import Processes
from innervate.network import networks
from tests.live.net import until

FIRST_S = 60.0
RING = {"kind": "tokenring", "nodes": 3, "hold_us": 20_000, "lost_us": 400_000}


def test_its_c_does_call_by_call_what_its_python_does():
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    replayed, drawn = parity.compare(roles()["tokenring"], 4000, 1, sanitized=True)
    assert replayed >= 2000
    assert replayed + drawn == 4000


def test_its_folder_is_enough(tmp_path, monkeypatch, capsys):
    monkeypatch.delenv("INNERVATE_NETWORKS")
    networks.cache_clear()
    folder = str(Path(__file__).parent)
    assert main(["firmware", folder, "hold_us=2000", "--out", str(tmp_path)]) == 0
    assert "2000, /* hold_us */" in (tmp_path / "tokenring.c").read_text()
    assert "tokenring.c" in capsys.readouterr().out
    _, role = role_of(folder)
    assert role.name == "tokenring"
    assert main(["firmware", folder, "hold=2", "--out", str(tmp_path)]) == 2
    assert "hold is unknown" in capsys.readouterr().err


def test_three_emulated_boards_hand_the_token_round(tmp_path):
    for tool in ("arm-none-eabi-gcc", "qemu-system-arm"):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed")
    plan = scenarios.plan(scenarios.from_dict(RING))

    async def go():
        images = patch.images(plan, tmp_path, [])
        assert sorted(images) == ["n0", "n1", "n2"]
        network = Processes(plan, tmp_path / "run", "pty", None, images)
        await network.up()

        def laps():
            told = (status.ask_one(network.socket(n), {"do": "status"}) for n in network.names)
            return min(one["fields"]["lap"] for one in told)

        try:
            await until(lambda: laps() > 10, FIRST_S)
            request = {"do": "input", "kind": 1, "item": {"load": [3, 200]}}
            assert status.ask_one(network.socket("n1"), request) == {"ok": True}
            heard = status.ask(network.socket("n2"), {"do": "listen"})
            assert (
                next(one for one in islice(heard, 200) if one.get("load") == [3, 200])["lap"] > 10
            )
            heard.close()
            await network.end_node("n1", gently=False)
            at = laps_of(network, "n2")
            await network.begin_node("n1")
            await until(lambda: laps_of(network, "n2") > at + 5, FIRST_S)  # the loss was mended
        finally:
            await network.down()

    asyncio.run(go())


def laps_of(network, name):
    return status.ask_one(network.socket(name), {"do": "status"})["fields"]["lap"]
