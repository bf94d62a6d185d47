"""Cables of a network that is brought up: who is joined to whom, and by which UDP ports."""

from __future__ import annotations

import contextlib
import socket
from typing import Any

PORTS = 4  # of a cell


def skin_cables(
    graph: Any,
) -> tuple[list[tuple[int, int]], list[tuple[int, int]], dict[int, int]]:
    """Cables of a skin: pairs of nodes, the port at either end; and the cable of every end."""
    links: list[tuple[int, int]] = []
    ends: list[tuple[int, int]] = []
    cable_of: dict[int, int] = {}
    sockets = PORTS * graph.cells
    for end, other in enumerate(graph.peer):
        if end < other:
            here = (end // PORTS, end % PORTS)
            there = (other // PORTS, other % PORTS)
            if other >= sockets:
                there = (graph.cells, other - sockets)
            cable_of[end] = cable_of[other] = len(links)
            links.append((here[0], there[0]))
            ends.append((here[1], there[1]))
    return links, ends, cable_of


def udp(own: str, other: str) -> dict[str, Any]:
    """The link table of a cable over UDP."""
    return {"kind": "udp", "bind": own, "peers": [other]}


def free_ports(count: int) -> list[int]:
    """UDP ports on loopback that nobody uses now."""
    found, socks = [], []
    with contextlib.ExitStack() as stack:
        for _ in range(count):
            sock = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            sock.bind(("127.0.0.1", 0))
            socks.append(sock)
            found.append(sock.getsockname()[1])
    return found
