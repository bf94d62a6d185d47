"""The mesh on live links: a node's records bound to the router's functions."""

import functools
from collections import Counter
from collections.abc import Callable, Collection
from types import SimpleNamespace
from typing import Any

from innervate.dialect import plain
from innervate.dialect.arith import MASK16
from innervate.dialect.outbox import SEND
from innervate.dialect.rng import seeded
from innervate.live.stack import filled
from innervate.networks.mesh import frames as wire
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol import fields as fields
from innervate.networks.mesh.protocol import node as mesh
from innervate.networks.mesh.protocol.duplicates import ANEW
from innervate.networks.mesh.protocol.frames import inner, is_sound
from innervate.networks.mesh.protocol.neighbours import (
    DOUBT,
    FREE,
    SUSPECT,
    is_strong,
    is_suspect,
    place_of,
)
from innervate.networks.mesh.protocol.route import alternate, planned
from innervate.networks.mesh.protocol.timeout import TICK_MAX_US
from innervate.networks.mesh.protocol.upward import is_better, is_nearer

CLASSES = (32, 64, 128, 254)
OUTBOX = 160  # more than twice the frames that a queue can hold
QUIET = 2  # gateways of which no request came for so many times what a standby waits are silent
ASKED = 256  # frames that may still be acknowledged: a slow link's acks come late
RSSI = -50  # of every frame that comes over a cable, dBm

FENCE_WORDS = ("inside", "about to cross", "outside")

LONG = len(wire.REASONS)  # what `decode` says of a frame that only a longer MTU would let through
TOO_LONG = "longer than our MTU"

Params = plain.make("Params", fields.PARAMS)


def is_avoided(node: Any, k: int) -> bool:
    """Whether the neighbour in place k did not answer, and was not heard since."""
    return bool(node.suspect[k] & (SUSPECT | DOUBT))


class MeshStack:
    """One node of a mesh; a robot moves, has a fence and tells where it is.

    Its `rank` is 0 for a gateway, 1.. for a standby, -1 for others; `params` are named as
    `mesh_fields.PARAMS`, and no two nodes may have the same `seed`.
    """

    timers = const.TIMERS
    reasons: tuple[str, ...] = (*wire.REASONS, TOO_LONG)

    def __init__(
        self, number: int, rank: int, params: dict[str, Any], seed: int, robot: bool = False
    ) -> None:
        self.params = filled(Params(), params)
        width = self.params.width
        # Every node sends in every round: three without a word are no accident.
        self.silent_us = 3 * self.params.period_max * self.params.tick_us + self.params.tick_us
        # Packets are tried for less than half of `forget`: so many times that late they are known.
        self.late_us = self.params.forget * min(self.params.tick_us, TICK_MAX_US) >> 2
        mtu = self.params.mtu
        most = self.params.places
        sizes = self.params.queue, self.params.kept, mtu, most
        self.node = plain.make("Node", fields.node(width, *sizes))()
        self.gate = plain.make("Gate", fields.gate(width, most))() if rank >= 0 else None
        self.node.number, self.node.rank, self.node.robot = number, rank, int(robot)
        self.node.rng, self.node.choice = seeded(seed), -1
        frame = plain.make("Frame", fields.frame(mtu))
        self.out, self.inbox = plain.Outbox(frame, OUTBOX), frame()
        self.item = plain.make("Item", fields.item(mtu))
        self.do: Any = mesh
        self.coder: Any = SimpleNamespace(
            encode=lambda frame: wire.encode(frame, self.params.mtu),
            decode=lambda data, frame: wire.decode(data, frame, self.params.mtu),
        )
        self.epoch = 0  # newest one that was followed before a restart
        self.first = -1  # our packets' numbers go on from here after a restart; -1 = anywhere
        self.places: dict[int, list[int]] = {}  # neighbour: ports, the newest first
        self.asked: Counter[int] = Counter()  # neighbour: frames that it should acknowledge
        self.acked: Counter[int] = Counter()
        # Who was asked to acknowledge which packet (origin, number): how often it has not.
        self._unanswered: dict[tuple[int, int, int], int] = {}
        # Is asked if data with this payload is another than came under its number.
        self.is_another: Callable[[Any, bytes], bool] = lambda *_: False

    def on_start(self, now: int, cause: int) -> None:
        """Switch on; after a restart with the epoch that was followed before.

        A gateway's requests are heeded only if their epoch, or their round, is newer than before.
        """
        self.do.on_start(self.node, self.gate, self.params, now, cause, self.out)
        if self.first >= 0:
            self.node.seq = self.first
        if cause != 0 and self.epoch:
            self.node.known, self.node.epoch = 1, self.epoch

    def objection(self, sender: int | None) -> str:
        """Why the frame in the inbox cannot be what it says: see Stack."""
        frame = self.inbox
        if frame.link_src >= self.params.nodes:
            return "from no node of ours"
        if frame.link_src == self.node.number:
            return "our own"
        if sender is not None and frame.link_src != sender:
            return "sealed by another than it is from"
        if not is_sound(self.params, frame):
            return "unsound"
        what = (frame.link_src, frame.origin, frame.seq)
        is_ack = frame.kind == const.ACK and frame.link_dst == self.node.number
        return "ack of nothing" if is_ack and what not in self._unanswered else ""

    def on_frame(self, now: int, port: int) -> None:
        """The frame in the inbox was received, and there is no objection to it."""
        self._place(self.inbox.link_src, port)
        self._heed_new_life(self.inbox)
        if self.inbox.kind != const.ACK:  # acks tell how loud the frame was that they are for
            self.inbox.rssi = RSSI
        elif self.inbox.link_dst == self.node.number:
            for origin, seq in wire.acked(self.inbox):
                self._note_answer((self.inbox.link_src, origin, seq))
        self.do.on_frame(self.node, self.gate, self.params, now, 0, self.inbox, self.out)

    def _heed_new_life(self, frame: Any) -> None:
        """Begin the window of an origin anew that has begun anew in it, having lost its numbers.

        The router would take what it says for what it said, and acknowledge it unheard.
        """
        node, origin = self.node, frame.origin
        if frame.kind == const.DATA and frame.dest in (node.number, const.ALL):
            behind = (node.newest[origin] - frame.seq) & MASK16
            if behind < ANEW and self.is_another(frame, self._said(frame)):
                node.idle[origin] = 0

    def _said(self, frame: Any) -> bytes:
        """The payload without what forwarding has put around it."""
        body = bytes(frame.body[: frame.length])
        if self.params.mode == const.TABLES:
            return body
        body = body[inner(frame) :]
        return body[: -1 - body[-1]] if frame.flags & const.DETOURED and body else body

    def _note_answer(self, what: tuple[int, int, int]) -> None:
        if self._unanswered.get(what):
            self._unanswered[what] -= 1
            self.acked[what[0]] += 1

    def _note_question(self, what: tuple[int, int, int]) -> None:
        self.asked[what[0]] += 1
        self._unanswered[what] = self._unanswered.pop(what, 0) + 1  # the newest last
        if len(self._unanswered) > ASKED:
            del self._unanswered[next(iter(self._unanswered))]

    def _place(self, who: int, port: int) -> None:
        known = self.places.setdefault(who, [port])
        if known[0] != port:
            if port in known:
                known.remove(port)
            known.insert(0, port)

    def on_timer(self, now: int, timer: int) -> None:
        """A timer of the router fires at `now`, us."""
        self.do.on_timer(self.node, self.gate, self.params, now, timer, self.out)

    def on_input(self, now: int, kind: int, item: Any) -> None:
        """A message to send, or where a robot is."""
        self.do.on_input(self.node, self.gate, self.params, now, kind, item, self.out)

    def encode(self, frame: Any) -> bytes:
        """The bytes of a frame."""
        data: bytes = self.coder.encode(frame)
        return data

    def decode(self, data: bytes) -> int:
        """Read bytes into the inbox; 0, or why not."""
        mtu = self.params.mtu
        if len(data) > mtu and wire.reason_of(data, const.MTU_MAX) == wire.OK:
            return LONG
        reason: int = self.coder.decode(data, self.inbox)
        return reason

    def behind(self, count: int) -> Collection[int]:
        """Acks leave behind frames to others; what goes the same way would hold them up.

        On a serial line of 115,200 baud that would be longer than the neighbour waits for them.
        """
        acks, ways = {}, set()
        for i in range(count):
            if self.out.action[i].kind == SEND:
                frame = self.out.frame[i]
                if frame.kind == const.ACK:
                    acks[i] = frame.link_dst
                else:
                    ways.add(frame.link_dst)
        if len(acks) + len(ways) < 2 or const.ALL in ways:
            return ()
        return [i for i, way in acks.items() if way not in ways]

    def ports_of(self, port: int, frame: Any, attempt: int) -> list[int] | None:
        """Where a frame leaves: on the path its receiver was heard on last; None = on all.

        Tried again, it leaves wherever its receiver was ever heard.
        """
        if frame.link_dst == const.ALL:
            return None
        if frame.flags & const.ACK_WANTED:
            self._note_question((frame.link_dst, frame.origin, frame.seq))
        known = self.places.get(frame.link_dst)
        if known is None:
            return None
        return known if attempt else known[:1]

    def status(self, now: int) -> dict[str, Any]:
        """Neighbours with the share of frames they acknowledged, routes, whom we follow."""
        node, params = self.node, self.params
        neighbours = []
        for k in range(params.places):
            who = node.neighbour[k]
            if who != FREE:
                asked = self.asked[who]
                neighbours.append(
                    {
                        "node": who,
                        "quality": round(min(1.0, self.acked[who] / asked), 4) if asked else None,
                        "suspect": is_avoided(node, k),
                        "ports": self.places.get(who, []),
                    }
                )
        base = node.bank * params.width
        routes = {
            str(dest): [node.next[base + dest], node.alt[base + dest]]
            for dest in range(params.nodes)
            if node.next[base + dest] != FREE and dest != node.number
        }
        return {
            "kind": "mesh",
            "number": node.number,
            **self._robot_status(),
            "role": "gateway" if node.leading else "standby" if node.rank >= 0 else "node",
            "gateway": node.gateway if node.known and node.gateway != const.ALL else None,
            "gateway_silent": bool(node.quiet > QUIET * params.dead and not node.leading),
            "epoch": node.epoch,
            "round": node.round,
            "table": node.version,
            "neighbours": neighbours,
            "routes": routes,
            "onward": self._onward(),
            "gives_back": params.mode != const.TABLE_FREE and params.failover == const.SEARCH,
            "queue": sum(state != 0 for state in node.q_state),
            "round_trip_ms": round(node.round_trip / 1000, 3),
        }

    def _onward(self) -> list[int]:
        """Whom a message for the gateway goes to, and to whom next if that one is silent."""
        node, params = self.node, self.params
        dest = node.gateway
        if not node.known or dest in (
            const.ALL,
            node.number,
        ):  # started again, the epoch is all we know
            return []
        strong = is_strong(node, params, place_of(node, params, dest))
        tables = params.mode == const.TABLES
        up = [k for k in range(params.places) if is_nearer(node, k, node.depth)]
        order = functools.cmp_to_key(lambda a, b: -1 if is_better(node, params, a, b) else 1)
        found = [
            dest if strong else FREE,
            planned(node, params, dest) if tables else FREE,
            alternate(node, params, dest)
            if tables and params.failover >= const.ALTERNATE
            else FREE,
            *(node.neighbour[k] for k in sorted(up, key=order)),
        ]
        answering = [who for who in found if who != FREE and not is_suspect(node, params, who)]
        return list(dict.fromkeys(answering))

    def _robot_status(self) -> dict[str, Any]:
        """Where a robot is, from the fence's origin; nothing of other nodes."""
        node, unit_cm = self.node, self.params.unit_cm
        if not node.robot:
            return {}
        place = [node.x * unit_cm, node.y * unit_cm] if node.placed else None
        return {"robot": {"at_cm": place, "fence": FENCE_WORDS[node.outside]}}
