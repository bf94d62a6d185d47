"""The system drops strangers' datagrams before they take room from neighbours' (Linux).

A socket's buffer holds some 300 datagrams: 3 ms of a flood, and what comes then from neighbours is
lost with the rest. A filter on the socket (classic BPF, no privilege needed) lets them alone in.
"""

from __future__ import annotations

import ctypes
import socket
import struct
import sys
from collections.abc import Iterable
from contextlib import suppress

SO_ATTACH_FILTER = 26
SO_MEMINFO = 55
DROPS = 8  # its place among SO_MEMINFO's nine numbers
NETWORK = 0x1_0000_0000 - 0x100000  # where the IP header is found; offset 0 is the UDP header
SOURCE = NETWORK + 12
LOAD_WORD, LOAD_HALF, JUMP_EQUAL, RETURN = 0x20, 0x28, 0x15, 0x06
WHOLE = 0xFFFF_FFFF


def program(peers: Iterable[tuple[str, int]]) -> bytes:
    """Instructions that take whole datagrams of these addresses, and nothing else."""
    steps: list[tuple[int, int, int, int]] = []
    for host, port in peers:
        steps += [
            (LOAD_WORD, 0, 0, SOURCE),
            (JUMP_EQUAL, 0, 3, int.from_bytes(socket.inet_aton(host), "big")),
            (LOAD_HALF, 0, 0, 0),
            (JUMP_EQUAL, 0, 1, port),
            (RETURN, 0, 0, WHOLE),
        ]
    return b"".join(struct.pack("=HBBI", *step) for step in (*steps, (RETURN, 0, 0, 0)))


def only_from(sock: socket.socket, peers: Iterable[tuple[str, int]]) -> None:
    """Let in what these addresses send; a system that cannot leaves it to whoever reads."""
    if sys.platform != "linux":
        return
    code = ctypes.create_string_buffer(program(peers))
    steps = (len(code) - 1) // 8
    with suppress(OSError):
        sock.setsockopt(
            socket.SOL_SOCKET, SO_ATTACH_FILTER, struct.pack("HP", steps, ctypes.addressof(code))
        )


def unread(sock: socket.socket) -> int:
    """How many datagrams the system dropped: strangers', and those that found no room."""
    try:
        numbers = sock.getsockopt(socket.SOL_SOCKET, SO_MEMINFO, 4 * (DROPS + 1))
    except OSError:
        return 0
    return int(struct.unpack(f"={DROPS + 1}I", numbers)[DROPS]) if len(numbers) > 4 * DROPS else 0
