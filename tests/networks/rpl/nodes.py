"""Nodes of RPL by themselves, and what they hear."""

from innervate.dialect.access import ALL
from innervate.network import networks
from innervate.networks.rpl.protocol import constants as c
from innervate.networks.rpl.protocol import kinds, sizes, timers
from tests.networks.one import One

RPL = networks()["rpl"]
LOUD = -60  # of a link of ETX 1
ROOT = 0
STEP = 128
VERSION = 240


def node(number=5, **params):
    return One(RPL, number, **params)


def dio(src, rank, **more):
    """A DIO of a neighbour, as keywords of `hear`."""
    usual = {
        "kind": kinds.DIO,
        "to": ALL,
        "src": src,
        "rank": rank,
        "version": VERSION,
        "dtsn": 240,
    }
    return usual | {"rssi": LOUD} | more


def attached(number=5, parent=1, rank=256, **params):
    """A node with a parent of that rank; what it sent till then is forgotten."""
    one = node(number, **params)
    one.hear(**dio(parent, rank))
    settle(one)
    one.sent.clear()
    one.reports.clear()
    return one


def settle(one):
    """Whatever it has to send goes out, and is acknowledged."""
    for _ in range(20):
        under = one.node.under
        if under == c.IDLE:
            return
        one.told()
        if under in (c.A_DAO, c.A_PACKET):
            ack(one)


def ack(one, src=None):
    """Who the frame under way is for acknowledges it."""
    return one.hear(kind=kinds.ACK, to=one.node.number, src=one.node.to if src is None else src,
                    dsn=one.node.dsn)  # fmt: skip


def fail(one):
    """The frame under way is not acknowledged, however often it is sent."""
    for _ in range(one.params.transmissions):
        one.told()
        one.fire(timers.ACK_WAIT)


def data(src, dest, number=1, **more):
    """A packet that a neighbour hands on, as keywords of `hear`."""
    usual = {"kind": kinds.DATA, "src": src, "dsn": number, "origin": 9, "dest": dest, "hops": 16}
    return usual | {"rssi": LOUD} | more


def dao(src, *targets, path=241, life=180, number=1):
    """A DAO of a child in storing mode."""
    many = [*targets, *[c.NOBODY] * sizes.TARGETS][: sizes.TARGETS]
    return {"kind": kinds.DAO, "src": src, "dsn": number, "targets": many, "rssi": LOUD,
            "paths": [path] * sizes.TARGETS, "life": life}  # fmt: skip


def parent_of(one):
    return one.node.nbr[one.node.parent] if one.node.parent >= 0 else None


def told_to_parent(one):
    """DAOs that go out now: (target, Path Sequence, life) of each that is named."""
    one.sent.clear()
    if one.node.dao_armed:
        one.fire(timers.DAO_DELAY)
    settle(one)
    return [(target, path, frame.life) for frame in one.sent if frame.kind == kinds.DAO
            for target, path in zip(frame.targets, frame.paths, strict=True)
            if target != c.NOBODY]  # fmt: skip


def ticks(one, count):
    for _ in range(count):
        one.fire(timers.TICK)


def storing(**params):
    """A node in storing mode whose parent knows of it."""
    one = attached(**params)
    told_to_parent(one)
    one.sent.clear()
    return one


def of(frames, kind):
    return [frame for frame in frames if frame.kind == kind]


def packets(one):
    return [f for f in one.sent if kinds.DATA <= f.kind < kinds.DATA + 3]
