"""Sealers joined by wires inside a program, which lose, twist and repeat what they are told."""

import asyncio
import functools

from innervate.live.identity import enrol, signing_public
from innervate.live.keys import Sealer, ring_of
from innervate.live.links import Path
from innervate.live.state import State

KEY, OTHER = bytes(range(32)), bytes(32)
AUTHORITY = bytes([9]) * 32
SHARED = bytes([8]) * 32


class Wire(Path):
    """A path whose other ends are given; all that was ever sent on it is kept."""

    def __init__(self, name="wire", port=0, ends=("", ""), is_group=False):
        super().__init__(name, port)
        self.ends, self.is_group = ends, is_group
        self.others, self.sealer = [], None
        self.said, self.got = [], []
        self.change = lambda data: [data]

    def send(self, data):
        self.said.append(data)
        for other in self.others:
            for one in self.change(data):
                asyncio.get_running_loop().call_soon(other.hear, one)

    def hear(self, data):
        """What comes in once somebody is there; frames taken are kept with who sent them."""
        opened = self.sealer and self.sealer.open(self, data)
        if opened is not None:
            self.sealer.take(opened)
            self.got.append((opened.sender, opened.frame))

    def frame(self, data):
        sealed = self.sealer.close(self, data)
        if sealed is not None:
            self.send(sealed)

    def frames(self):
        return [frame for _sender, frame in self.got]


def join(*wires):
    for wire in wires:
        wire.others = [other for other in wires if other is not wire]


def network_sealer(number, keys=None, use=None, **more):
    keys = keys or {1: KEY}
    return Sealer(ring_of("mesh", keys, use or min(keys)), number, State(None), **more)


def own_sealer(number, serial=None, authority=AUTHORITY, state=None, kind="mesh"):
    identity = identity_of(authority, number, number + 100 if serial is None else serial)
    return Sealer(ring_of(kind, {}, 0, identity), number, state or State(None))


@functools.cache
def identity_of(authority, number, serial):
    """A node that is started anew has the file that it had."""
    return enrol(authority, number, serial, SHARED)


def public_authority():
    return signing_public(AUTHORITY)


def begin(sealer, *wires):
    for port, wire in enumerate(wires):
        wire.sealer, wire.port = sealer, port
    sealer.start(wires)
    return sealer


async def settle(seconds=0.2):
    await asyncio.sleep(seconds)


def joined(one, other, names=("wire", "wire")):
    """Two wires that these sealers have begun on."""
    wires = [Wire(name) for name in names]
    join(*wires)
    begin(one, wires[0])
    begin(other, wires[1])
    return wires


def anew(sealer, to, instead):
    """A wire to another in place of one whose node has stopped; its sealer has begun."""
    instead.sealer.stop()
    wire = Wire()
    join(to, wire)
    begin(sealer, wire)
    return wire


async def two(make=network_sealer, ends=(("", ""), ("", ""))):
    """Two nodes that have proved to each other who they are, if they can."""
    a, b = Wire("a", ends=ends[0]), Wire("b", ends=ends[1])
    join(a, b)
    begin(make(1), a)
    begin(make(2), b)
    await settle()
    return a, b
