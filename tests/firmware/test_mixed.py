"""One patch of cells in Python, in MicroPython and in C: to each other they are cells."""

import asyncio

from innervate.live.serial import SerialLink
from innervate.networks.skin.live.node import CellNode, SinkNode
from innervate.networks.skin.live.parameters import skin_parameters
from innervate.networks.skin.live.stack import CellStack, SinkStack
from tests.boards.test_boards_cell import PARAMS, files, folder_of
from tests.boards.test_boards_cell import board as micropython
from tests.firmware.test_boards_live import BAUD, FIRST_S, board, image, needed, serial
from tests.live.net import until

IN_MICROPYTHON, IN_C, IN_PYTHON = 7, 1, 9
__all__ = ["files", "needed"]


def test_cells_in_three_languages_make_one_patch(tmp_path, files):
    """PC - MicroPython - C - Python - PC: a cable is cut, and the way of all turns round."""
    made = image(tmp_path, "skin", "small", PARAMS)
    near = folder_of(tmp_path / "near", files, IN_MICROPYTHON, ((0, {}), (1, {}), None, None))

    async def go(cables):
        ends = cables.devices
        last = CellStack(IN_PYTHON, skin_parameters(PARAMS), 5, [0, 1])
        cell = CellNode("c", last, [SerialLink(ends[5], BAUD, 0), SerialLink(ends[6], BAUD, 1)])
        cell.rate_hz = 10
        pc = SinkNode("pc", SinkStack(skin_parameters(PARAMS), 2),
                      [SerialLink(ends[0], BAUD, 0), SerialLink(ends[7], BAUD, 1)])  # fmt: skip
        heard = {IN_MICROPYTHON: [], IN_PYTHON: []}
        pc.receive_touch(lambda touch: heard[touch.cell].append(touch))
        with micropython(near, *ends[1:3]), board(made, ends[3:5]):
            async with pc, cell:
                await until(
                    lambda: None not in pc.status()["cells"] and all(pc.status()["cells"]), FIRST_S
                )
                cables.cut = {3}  # the Python cell's own way: it has to go by the other two
                await until(lambda: pc.status()["cells"][0] == 3, FIRST_S)
                count = len(heard[IN_PYTHON])
                await until(lambda: len(heard[IN_PYTHON]) > count + 5, FIRST_S)
                assert heard[IN_PYTHON][-1].hops == 2  # by C, by MicroPython
                cables.cut = {0}  # and the MicroPython cell's
                await until(lambda: pc.status()["cells"][1] == 3, FIRST_S)
                count = len(heard[IN_MICROPYTHON])
                await until(lambda: len(heard[IN_MICROPYTHON]) > count + 5, FIRST_S)
                assert heard[IN_MICROPYTHON][-1].hops == 2  # by C, by Python

    with serial(4) as cables:
        asyncio.run(go(cables))
