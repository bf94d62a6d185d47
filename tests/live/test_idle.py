"""What is handed to a live node that does not run: not yet, or not any more."""

import asyncio

import pytest

from innervate.live.local import pair
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from innervate.networks.skin.live.node import CellNode, SinkNode
from innervate.networks.skin.live.parameters import skin_parameters
from innervate.networks.skin.live.stack import CellStack, SinkStack


def robot():
    stack = MeshStack(0, 0, mesh_parameters(2, {}), 5)
    stack.node.robot = 1
    return MeshNode("n0", stack, [pair("0-1")[0]])


def cell():
    return CellNode("c3", CellStack(3, skin_parameters({}), 5, [0]), [pair("3-4")[0]])


def pc():
    return SinkNode("pc", SinkStack(skin_parameters({}), 1), [pair("pc-0")[0]])


HAND_DOWN = {
    "a sample": (cell, lambda node: node.sample(proximity=3)),
    "a command": (pc, lambda node: node.send_command(7)),
    "a place": (robot, lambda node: node.locate((1, 2))),
}


@pytest.mark.parametrize("what", HAND_DOWN)
def test_what_a_node_that_does_not_run_cannot_take_says_what_to_do(what):
    make, hand_down = HAND_DOWN[what]

    async def main():
        node = make()
        with pytest.raises(ValueError, match=r"^node not started; start it first: await"):
            hand_down(node)
        async with node:
            hand_down(node)
        with pytest.raises(ValueError, match=r"^node stopped; start it first: "):
            hand_down(node)
        async with node:  # on again
            hand_down(node)

    asyncio.run(main())
