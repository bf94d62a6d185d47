"""The system drops what is not for a node before it takes room from what is (Linux).

A socket's buffer holds some 300 datagrams: 3 ms of a flood, and what comes then from neighbours is
lost with the rest. A filter on the socket (classic BPF, no privilege needed) lets in what bears a
neighbour's address and, where frames are sealed, an index that this node drew for its sessions.
"""

import ctypes
import errno
import socket
import struct
import sys
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import NamedTuple

SO_ATTACH_FILTER, SO_DETACH_FILTER = 26, 27
SO_ATTACH_REUSEPORT_CBPF = 51
SO_MEMINFO = 55
DROPS = 8  # its place among SO_MEMINFO's nine numbers
NETWORK = 0x1_0000_0000 - 0x100000  # where the IP header is found; offset 0 is the UDP header
SOURCE = NETWORK + 12
SOURCE_PORT = NETWORK + 20
FIRST, INDEX, COUNTER = 8, 9, 13  # of a datagram: its first byte, what a sealed frame says next
LOAD_WORD, LOAD_HALF, LOAD_BYTE = 0x20, 0x28, 0x30
JUMP_EQUAL, JUMP_FROM, JUMP_ABOVE, RETURN = 0x15, 0x35, 0x25, 0x06
WHOLE = 0xFFFF_FFFF
STEPS_MAX, STEP_BYTES = 4096, 8  # of a filter
JUMP = 255  # at most so far

Step = tuple[int, int, int, int]
Peer = tuple[str, int]
Ranges = Sequence[tuple[int, int]]
TAKE: Step = (RETURN, 0, 0, WHOLE)
DROP: Step = (RETURN, 0, 0, 0)


class Doors(NamedTuple):
    """What is let in of sealed frames on one path.

    Attributes:
        anybody: what is taken from anybody, by its first byte: ranges, both ends included.
        known: by index (of a group: sender and epoch) the least counter that can be new.
    """

    anybody: Ranges
    known: Mapping[int, int]

    def steps(self) -> list[Step]:
        """Instructions that take or drop a datagram."""
        steps: list[Step] = [(LOAD_BYTE, 0, 0, FIRST)]
        for low, high in self.anybody:
            steps += [(JUMP_FROM, 0, 2, low), (JUMP_ABOVE, 1, 0, high), TAKE]
        steps.append((LOAD_WORD, 0, 0, INDEX))
        for index, least in self.known.items():
            if least:
                steps += [(JUMP_EQUAL, 0, 4, index), (LOAD_WORD, 0, 0, COUNTER),
                          (JUMP_FROM, 0, 1, least), TAKE, DROP]  # fmt: skip
            else:
                steps += [(JUMP_EQUAL, 0, 1, index), TAKE]
        return [*steps, DROP]


def of_peer(peer: Peer, doors: Doors | None = None) -> bytes:
    """Instructions that look at datagrams of an address, and leave others to what follows."""
    inside = [TAKE] if doors is None else doors.steps()
    if len(inside) > JUMP - 2:
        inside = [TAKE]
    host, past = int.from_bytes(socket.inet_aton(peer[0]), "big"), len(inside)
    return packed([(LOAD_WORD, 0, 0, SOURCE), (JUMP_EQUAL, 0, past + 2, host),
                   (LOAD_HALF, 0, 0, 0), (JUMP_EQUAL, 0, past, peer[1]), *inside])  # fmt: skip


def packed(steps: Iterable[Step]) -> bytes:
    """Instructions as the system reads them."""
    return b"".join(struct.pack("=HBBI", *step) for step in steps)


def only_from(sock: socket.socket, *programs: bytes) -> None:
    """Let in what the first program takes that the system has room for; else whatever comes."""
    if sys.platform != "linux":
        return
    for steps in programs:
        with suppress(OSError):
            attach(sock, SO_ATTACH_FILTER, steps + packed([DROP]))
            return
    with suppress(OSError):
        sock.setsockopt(socket.SOL_SOCKET, SO_DETACH_FILTER, 0)


def attach(sock: socket.socket, option: int, steps: bytes) -> None:
    """Give a program to a socket; OSError if the system does not take it."""
    if len(steps) > STEPS_MAX * STEP_BYTES:
        raise OSError(errno.EINVAL, "too many instructions")
    held = ctypes.create_string_buffer(steps, len(steps))
    filled = struct.pack("HP", len(steps) // STEP_BYTES, ctypes.addressof(held))
    sock.setsockopt(socket.SOL_SOCKET, option, filled)


def share(first: socket.socket, others: Sequence[socket.socket], peers: Iterable[Peer]) -> None:
    """Have several sockets take turns at one address, so that each peer's datagrams come to one.

    The first is bound, and was before anybody could share its address with it; the others are not.

    Raises:
        OSError: the system cannot.
    """
    for sock in (first, *others):
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    for sock in others:
        sock.bind(first.getsockname())
    steps: list[Step] = []
    for i, (host, port) in enumerate(peers):
        steps += [(LOAD_WORD, 0, 0, SOURCE),
                  (JUMP_EQUAL, 0, 3, int.from_bytes(socket.inet_aton(host), "big")),
                  (LOAD_HALF, 0, 0, SOURCE_PORT), (JUMP_EQUAL, 0, 1, port),
                  (RETURN, 0, 0, i % (1 + len(others)))]  # fmt: skip
    attach(first, SO_ATTACH_REUSEPORT_CBPF, packed([*steps, TAKE]))


def unread(sock: socket.socket) -> int:
    """How many datagrams the system dropped: not for this node, and those that found no room."""
    try:
        numbers = sock.getsockopt(socket.SOL_SOCKET, SO_MEMINFO, 4 * (DROPS + 1))
    except OSError:
        return 0
    return int(struct.unpack(f"={DROPS + 1}I", numbers)[DROPS]) if len(numbers) > 4 * DROPS else 0
