import asyncio
import binascii
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.networks.skin.live.parameters import SKIN
from innervate.networks.skin.live.words import command_text, touch_text
from tests.live.net import Skin, until

# Detection takes k periods, then the news runs; a busy machine may double that.
FRAMES = st.binary(min_size=7, max_size=18).map(
    lambda body: body + binascii.crc_hqx(body, 0xFFFF).to_bytes(2, "big")
)  # with a good CRC, and anything in it
BEACON_S = SKIN["beacon_us"] / 1e6


def test_every_cell_is_heard_and_the_load_is_told():
    async def main():
        async with Skin(4, 5, [(1, 2), (18, 3)]) as skin:
            await until(skin.fresh())
            await until(lambda: sum(skin.pc.status()["cells"]) == 20)

    asyncio.run(main())


@pytest.mark.parametrize("fault", ["interface", "cable", "cell"])
def test_the_skin_mends_itself(fault):
    async def main():
        async with Skin(4, 5, [(1, 2), (18, 3)]) as skin:
            await until(skin.fresh())
            gone = ()
            if fault == "cell":
                gone = (6,)
                await skin.cells[6].stop()
            else:
                cable = ("pc", 0) if fault == "interface" else (5, 6)
                for path in skin.cables[cable]:
                    path.cut = True
            return await until(skin.fresh(but=gone))

    assert asyncio.run(main()) < 3.0


def test_the_pc_starts_again_and_everybody_comes_back():
    async def main():
        async with Skin(3, 3, [(0, 0)]) as skin:
            await until(skin.fresh())
            for path in skin.cables["pc", 0]:
                path.cut = True
            await until(lambda: all(cell.status()["parent"] is None for cell in skin.cells))
            await skin.pc.stop()
            for path in skin.cables["pc", 0]:
                path.cut = False
            await skin.pc.start()
            await until(skin.fresh())

    asyncio.run(main())


def test_a_cell_tells_what_its_sensors_say():
    began_us = time.time_ns() // 1000

    async def main():
        async with Skin(2, 1, [(0, 0)], rate_hz=0.0) as skin:
            touches = skin.pc.receive_touch()
            await until(lambda: skin.cells[1].status()["parent"] is not None)
            skin.cells[1].sample(7, (1, 2, 65_535), -3, (-512, 0, 511))
            async with asyncio.timeout(5):
                touch = await anext(touches)
            with pytest.raises(ValueError, match="accel must be 3 numbers"):
                skin.cells[1].sample(accel=(0, 0, 512))
            await touches.aclose()
            return touch

    touch = asyncio.run(main())
    assert touch[:-1] == (1, 0, 1, 0, 7, (1, 2, 65_535), -3, (-512, 0, 511))
    assert began_us < touch.time_us < time.time_ns() // 1000
    assert "seq 0, 1 hop, interface 0, proximity 7, force 1 2 65535 mN, 18.5 degC" in (
        touch_text(touch._asdict())
    )


def test_status_names_the_broken_port():
    async def main():
        async with Skin(2, 2, [(0, 0)]) as skin:
            await until(skin.fresh())
            for path in skin.cables[0, 1]:
                path.cut = True
            began = time.monotonic()
            await until(lambda: skin.cells[0].status()["ports"][1]["broken"])
            assert skin.cells[0].status()["broken"] == ["local 0-1"]
            return time.monotonic() - began

    assert asyncio.run(main()) >= 3 * BEACON_S  # not before beacons were missed


@settings(max_examples=300, deadline=None, database=None)
@given(st.lists(st.one_of(st.binary(max_size=24), FRAMES), max_size=20), st.booleans())
def test_whatever_comes_in_is_taken_or_counted_and_never_raises(frames, pc):
    async def main():
        skin = Skin(2, 1, [(0, 0)], rate_hz=0.0)
        node = skin.pc if pc else skin.cells[0]
        await node.start()
        for data in frames:
            node._receive(node.paths[0], data)
        counters = node.counters()
        await node.stop()
        dropped = sum(n for what, n in counters.items() if what.startswith("dropped"))
        assert dropped + counters["frames"] == len(frames)

    asyncio.run(main())


def test_a_command_of_the_pc_comes_to_its_cell_once_or_to_all():
    heard = {}

    async def main():
        async with Skin(3, 2, [(0, 0), (5, 1)]) as skin:
            for number, cell in enumerate(skin.cells):
                heard[number] = []
                cell.receive_commands(heard[number].append)
            await until(skin.fresh())
            await until(lambda: sum(skin.pc.stack.node.size) == 6)
            first = skin.pc.send_command(7, 500, cell=4)
            await until(lambda: heard[4])
            second = skin.pc.send_command(8)
            await until(lambda: all(heard.values()) and len(heard[4]) == 2)
            for wrong in ({"code": 256}, {"code": 1, "value": -1}, {"code": 1, "cell": 65_535}):
                with pytest.raises(ValueError, match="must be"):
                    skin.pc.send_command(**wrong)
            return first, second, skin.cells[4].counters(), skin.pc.counters()

    first, second, at_cell, at_pc = asyncio.run(main())
    assert first.ports == second.ports == 2
    assert (first.checked, second.checked) == (False, True)  # whose file says no `nodes`; to all
    assert second.number == first.number + 1
    alone, everybody = heard[4]
    assert (alone.number, alone.code, alone.value, alone.to_all) == (first.number, 7, 500, False)
    assert "for this cell: code 7, value 500" in command_text(alone._asdict())
    assert (everybody.code, everybody.to_all) == (8, True)
    assert all(len(told) == 1 for cell, told in heard.items() if cell != 4)
    assert at_cell["commands received"] == at_pc["commands sent"] == 2


def test_behind_a_broken_cable_the_pc_serves_nobody():
    async def main():
        async with Skin(2, 1, [(0, 0)]) as skin:
            await until(lambda: skin.pc.status()["cells"] == [2])
            for path in skin.cables["pc", 0]:
                path.cut = True
            await until(lambda: skin.pc.status()["paths"][0]["broken"])
            return skin.pc.status()["cells"], skin.pc.send_command(1).ports

    assert asyncio.run(main()) == ([0], 0)


def test_a_command_that_nobody_hands_down_is_said():
    async def main():
        async with Skin(1, 1, [(0, 0)]) as skin:
            for path in skin.cables["pc", 0]:
                path.cut = True
            return skin.pc.send_command(1)

    assert asyncio.run(main()).ports == 0
