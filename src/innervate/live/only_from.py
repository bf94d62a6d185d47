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

from innervate.live.addresses import Address, family_of

SO_ATTACH_FILTER, SO_DETACH_FILTER = 26, 27
SO_ATTACH_REUSEPORT_CBPF = 51
SO_MEMINFO = 55
DROPS = 8  # its place among SO_MEMINFO's nine numbers
NETWORK = 0x1_0000_0000 - 0x100000  # where the IP header is found; offset 0 is the UDP header
SOURCES = {socket.AF_INET: (NETWORK + 12, 20), socket.AF_INET6: (NETWORK + 8, 40)}  # and its bytes
FIRST, INDEX, COUNTER = 8, 9, 13  # of a datagram: its first byte, what a sealed frame says next
LOAD_WORD, LOAD_HALF, LOAD_BYTE = 0x20, 0x28, 0x30
JUMP_EQUAL, JUMP_FROM, JUMP_ABOVE, RETURN = 0x15, 0x35, 0x25, 0x06
WHOLE = 0xFFFF_FFFF
STEPS_MAX, STEP_BYTES = 4096, 8  # of a filter
JUMP = 255  # at most so far

Step = tuple[int, int, int, int]
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


def _from(peer: Address, port_at: int) -> list[tuple[int, int, int]]:
    """What a datagram of an address has where: how it is loaded, from where, its value."""
    family = family_of(peer[0])
    host, at = socket.inet_pton(family, peer[0]), SOURCES[family][0]
    words = [(LOAD_WORD, at + k, int.from_bytes(host[k : k + 4])) for k in range(0, len(host), 4)]
    return [*words, (LOAD_HALF, port_at, peer[1])]


def _if_from(peer: Address, port_at: int, inside: list[Step]) -> list[Step]:
    """Instructions for datagrams of an address, past which others go."""
    steps, looked_at = [], _from(peer, port_at)
    for left, (load, at, value) in zip(range(len(looked_at))[::-1], looked_at, strict=True):
        steps += [(load, 0, 0, at), (JUMP_EQUAL, 0, 2 * left + len(inside), value)]
    return [*steps, *inside]


def of_peer(peer: Address, doors: Doors | None = None) -> bytes:
    """Instructions that look at datagrams of an address, and leave others to what follows."""
    inside = [TAKE] if doors is None else doors.steps()
    if len(inside) > JUMP - 2 * (len(_from(peer, 0)) - 1):
        inside = [TAKE]
    return packed(_if_from(peer, 0, inside))


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


def share(first: socket.socket, others: Sequence[socket.socket]) -> None:
    """Have several sockets share an address; `keep_apart` says which datagrams come to which.

    The first is bound, and was before anybody could share its address with it; the others are not.

    Raises:
        OSError: the system cannot.
    """
    for sock in (first, *others):
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    for sock in others:
        sock.bind(first.getsockname())


def keep_apart(socks: Sequence[socket.socket], peers: Iterable[Address]) -> None:
    """Each peer's datagrams come to one of the sockets, in turn; an OSError if that cannot be."""
    steps: list[Step] = []
    for i, peer in enumerate(peers):
        port_at = NETWORK + SOURCES[family_of(peer[0])][1]
        steps += _if_from(peer, port_at, [(RETURN, 0, 0, i % len(socks))])
    attach(socks[0], SO_ATTACH_REUSEPORT_CBPF, packed([*steps, TAKE]))


def unread(sock: socket.socket) -> int:
    """How many datagrams the system dropped: not for this node, and those that found no room."""
    try:
        numbers = sock.getsockopt(socket.SOL_SOCKET, SO_MEMINFO, 4 * (DROPS + 1))
    except OSError:
        return 0
    return int(struct.unpack(f"={DROPS + 1}I", numbers)[DROPS]) if len(numbers) > 4 * DROPS else 0
