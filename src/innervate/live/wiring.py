"""Cables of a network that is brought up: UDP on loopback."""

from __future__ import annotations

import contextlib
import socket
from typing import Any


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
