"""Frames of a running node as they leave and come in, for captures: over its status socket.

They are told in the clear, opened where they are sealed: only the node's own user can ask.
"""

from typing import Any

from innervate.live.node import LiveNode
from innervate.live.pending import Pending
from innervate.live.status import Writer

PENDING_MAX = 20_000  # frames that wait for a slow reader
BATCH = 200  # frames in a line


async def serve(node: LiveNode, writer: Writer) -> None:
    """Tell all frames of a node from now on, until the connection ends.

    The first line says whose they are and which paths there are; each that follows holds
    "frames", lists of what a Tap is given with the bytes in hexadecimal, and "missed", how many
    were left out because nobody read fast enough.
    """
    pending: Pending[tuple[int, int, bool, str, str]] = Pending(PENDING_MAX)

    def take(at_ns: int, port: int, out: bool, data: bytes, why: str) -> None:
        pending.put((at_ns, port, out, data.hex(), why))

    writer.is_last = True
    node.taps.append(take)
    try:
        await writer.line(about(node))
        while True:
            told, lost = await pending.take()
            told.sort()  # a frame is told once it was handled, those that it caused before it
            for i in range(0, len(told), BATCH):
                await writer.line({"frames": told[i : i + BATCH], "missed": lost})
                lost = 0
    finally:
        node.taps.remove(take)


def about(node: LiveNode) -> dict[str, Any]:
    """Who a node is, and its paths: (number, port of the protocol, address here, and there)."""
    told = node.stack.status(0)
    # A cell's ports are its sockets, of which only some have a path.
    ports = getattr(node.stack, "port_of_path", range(len(node.paths)))
    paths = [(path.port, ports[path.port], *path.ends) for path in node.paths]
    return {
        "capturing": node.name,
        "kind": told["kind"],
        "role": told["role"],
        "number": told.get("number", -1),
        "sealed": node.sealer is not None,
        "paths": paths or [(0, 0, "", "")],
    }
