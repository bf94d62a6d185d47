"""A mesh for the explorer: its states, and what can happen next.

A frame and its hop ack are one event: an ack comes a turnaround after the frame's end, before
anything else of these two nodes. A state is one number for each node (local.py), how long its
last event is past (timed only), what may still fail, and what was delivered.

Untimed, a node's own timers fire in their order, but nothing is said of two nodes' clocks: frames
go out and timers fire at any moment. Timed, all clocks run alike, frames take no time, and what
waits to go out goes out first, from the lowest node; then only faults are a choice.
"""

import struct
from itertools import combinations
from typing import NamedTuple

from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol.queue import UNACKED
from innervate.networks.mesh.verify import local as local
from innervate.networks.mesh.verify.local import NEVER, NONE
from innervate.networks.mesh.verify.model import MeshModel
from innervate.topology.placement import neighbours
from innervate.verify.values import with_one

# Kinds of moves.
OFFER, OUTSIDE, AIR, FIRE, DIE, REVIVE, SWITCH_ON = range(7)

DEAD = -1
EVENTS_MAX = 5_000  # of a first round, and of a message's calm future; some hundred are enough


class Move(NamedTuple):
    """An event: what, at which node, and how."""

    kind: int  # OFFER, OUTSIDE, AIR, FIRE, DIE, REVIVE or, before all, SWITCH_ON
    node: int  # who
    frame: int = NONE  # AIR: the frame's number; FIRE: the timer; OFFER: which of the model's
    missed: tuple[int, ...] = ()  # AIR: nodes that did not receive it although they could
    deaf: int = 0  # AIR: 1 = its hop ack was lost
    script: tuple[int, ...] = ()  # what draws gave


class Net(NamedTuple):
    """A state of a mesh: all numbers."""

    nodes: tuple[int, ...]  # each node's state; DEAD
    lags: tuple[int, ...]  # us since its last event; all 0 untimed
    left: tuple[int, int, int, int]  # deaths, revivals, frames and acks that may still be lost
    ticks: tuple[int, ...]  # beats that each node may still have
    offered: int  # how many of the model's messages, and of its alarm, were offered
    got: int  # which set of deliveries (see Nets.sets)


class Part(NamedTuple):
    """A state in the making."""

    nodes: tuple[int, ...]
    lags: tuple[int, ...]
    got: int
    acks: tuple[int, ...]
    script: tuple[int, ...]
    broken: int


Successor = tuple[Move, Net, int]


class Nets:
    """The states of a model, and what follows them."""

    def __init__(self, model: MeshModel, locals_: local.Locals | None = None) -> None:
        self.model = model
        self.locals = locals_ or local.Locals(model)
        self.n = model.nodes
        self.neighbours = [sorted(nodes) for nodes in neighbours(self.n, model.links)]
        self.sets: list[frozenset[tuple[int, int, int, int]]] = [frozenset()]
        self.set_numbers = {self.sets[0]: 0}
        self.form = struct.Struct(f"{3 * self.n + 6}i")

    # Keeping states.

    def pack(self, net: Net) -> bytes:
        """A state as bytes of fixed length, to be looked up."""
        return self.form.pack(*net.nodes, *net.lags, *net.left, *net.ticks, net.offered, net.got)

    def unpack(self, row: bytes) -> Net:
        """The state that `pack` made these bytes of."""
        n, w = self.n, self.form.unpack(row)
        left = (w[2 * n], w[2 * n + 1], w[2 * n + 2], w[2 * n + 3])
        return Net(w[:n], w[n : 2 * n], left, w[2 * n + 4 : 3 * n + 4], w[-2], w[-1])

    # The start.

    def calm_beats(self) -> int:
        """Timed: so many beats after the last fault there is one gateway, which all follow.

        Whoever waits for another waits `dead` beats and a step for every standby before it; then
        a round goes out, at once or after a period.
        """
        params, standbys = self.locals.params, len(self.model.standby)
        return int(params.dead + standbys * params.dead_step + params.period + 2)

    def present(self, net: Net) -> tuple[int, ...]:
        """Every node's state as of now."""
        passed = (local.PASS,)
        return tuple(
            self.locals.call(number, passed, lag)[0].state if number != DEAD else DEAD
            for number, lag in zip(net.nodes, net.lags, strict=True)
        )

    # What can happen.

    def successors(self, net: Net) -> list[Successor]:
        """Everything that can happen next, in any order of the nodes."""
        found: list[Successor] = []
        if self.model.beats:
            return self.faults(net) + self.timed(net)
        found += self.offers(net)
        for node, number in enumerate(net.nodes):
            if number == DEAD:
                continue
            if self.locals.states[number].handed != NONE:
                found += self.air(net, node)
            for timer in self.next_timers(net, node):
                found += self.fire(net, node, timer)
        return found + self.faults(net)

    def timed(self, net: Net) -> list[Successor]:
        """What happens next when all clocks run alike: one event, in every way it can end."""
        wait, node, timer = self.soonest(net)
        if node == NONE or (timer == const.TICK and not net.ticks[node]):
            return []
        return self.air(net, node) if timer == NONE else self.fire(net, node, timer, wait)

    def steady(self, net: Net) -> Successor | None:
        """What happens next if nothing fails, all clocks alike; None at the end of all beats."""
        found = self.timed(net._replace(left=(0, 0, 0, 0)))
        return found[0] if found else None

    def soonest(self, net: Net) -> tuple[int, int, int]:
        """(us from now, node, timer) of the next event; timer NONE: a frame goes out."""
        best = (1 << 40, NONE, NONE)
        for node, number in enumerate(net.nodes):
            if number == DEAD:
                continue
            state = self.locals.states[number]
            if state.handed != NONE:
                return 0, node, NONE
            for timer, due in enumerate(state.timers):
                if due != NEVER and (due - net.lags[node], node, timer) < best:
                    best = (max(0, due - net.lags[node]), node, timer)
        return best

    def next_timers(self, net: Net, node: int) -> list[int]:
        """Untimed: timers of a node any of which can be first; beats beyond the budget are late."""
        timers = self.locals.states[net.nodes[node]].timers
        some = [t for t, due in enumerate(timers) if due != NEVER]
        if not net.ticks[node] and const.TICK in some:
            some.remove(const.TICK)
        first = min((timers[t] for t in some), default=NEVER)
        return [t for t in some if timers[t] == first]

    def offers(self, net: Net) -> list[Successor]:
        """The next message, or the alarm, is handed to its node."""
        at, model = net.offered, self.model
        if at < len(model.offers):
            node, dest = model.offers[at]
            event: tuple[int, ...] = (local.MESSAGE, dest, at)
            kind = OFFER
        elif at == len(model.offers) and model.robot >= 0:
            node, event, kind = model.robot, (local.SAMPLE,), OUTSIDE
        else:
            return []
        later = net._replace(offered=at + 1)
        if net.nodes[node] == DEAD:
            return [(Move(kind, node, at), later, 0)]
        parts = self._apply([self._part(net)], node, event)
        return [self._done(later, Move(kind, node, at), part) for part in parts]

    def fire(self, net: Net, node: int, timer: int, wait: int = 0) -> list[Successor]:
        """A node's timer fires; `wait` us later on all clocks, where these run alike."""
        due = self.locals.states[net.nodes[node]].timers[timer]
        if self.model.beats or wait:
            alive = zip(net.lags, net.nodes, strict=True)
            net = net._replace(lags=tuple(lag + wait if i != DEAD else 0 for lag, i in alive))
        later = net
        if timer == const.TICK:
            ticks = list(net.ticks)
            ticks[node] -= 1
            later = net._replace(ticks=tuple(ticks))
        parts = self._apply([self._part(net)], node, (local.TIMER, timer), max(due, net.lags[node]))
        return [self._done(later, Move(FIRE, node, timer), part) for part in parts]

    def air(self, net: Net, node: int) -> list[Successor]:
        """A frame goes out: who receives it, and does its sender hear the ack?"""
        number = self.locals.states[net.nodes[node]].handed
        to = self.locals.packets[number].link_dst
        heard_by = [v for v in self.neighbours[node] if net.nodes[v] != DEAD]
        deaths, revivals, frames, acks = net.left
        found: list[Successor] = []
        if to == const.ALL:
            for count in range(min(frames, len(heard_by)) + 1):
                later = net._replace(left=(deaths, revivals, frames - count, acks))
                for missed in combinations(heard_by, count):
                    found += self._exchange(later, node, heard_by, missed)
            return found
        found += self._exchange(net, node, heard_by)
        if to in heard_by and frames:
            later = net._replace(left=(deaths, revivals, frames - 1, acks))
            found += self._exchange(later, node, heard_by, (to,))
        if to in heard_by and acks and self.locals.packets[number].flags & const.ACK_WANTED:
            later = net._replace(left=(deaths, revivals, frames, acks - 1))
            found += self._exchange(later, node, heard_by, deaf=1)
        return found

    def _exchange(
        self, net: Net, node: int, heard_by: list[int], missed: tuple[int, ...] = (), deaf: int = 0
    ) -> list[Successor]:
        """Receivers in order, then the sender is told that it has left, then the ack is heard."""
        number = self.locals.states[net.nodes[node]].handed
        packet = self.locals.packets[number]
        event = (local.FRAME, number)
        parts = [self._part(net)]
        is_for_all = packet.link_dst == const.ALL or self.model.overhear
        for v in heard_by if is_for_all else [packet.link_dst]:
            if v not in missed and v in heard_by:
                parts = self._apply(parts, v, event)
        if packet.link_dst == const.ALL:
            parts = [part._replace(acks=()) for part in parts]
        done: list[Successor] = []
        for part in parts:
            acks = part.acks
            if deaf and not acks:
                continue  # there was none to lose
            told = self._apply([part._replace(acks=())], node, (local.SENT,))
            for ack in () if deaf else acks:
                told = self._hear_ack(net, told, packet.link_dst, ack)
            move = Move(AIR, node, number, missed, deaf)
            done += [self._done(net, move, one) for one in told]
        return done

    def _hear_ack(self, net: Net, parts: list[Part], sender: int, ack: int) -> list[Part]:
        to = self.locals.packets[ack].link_dst
        for v in self.neighbours[sender]:
            if net.nodes[v] != DEAD and (v == to or self.model.overhear):
                parts = self._apply(parts, v, (local.FRAME, ack))
        return [
            part._replace(broken=part.broken or local.BROKEN_ACKED)
            if net.nodes[to] != DEAD and self._waits(part.nodes[to], ack)
            else part
            for part in parts
        ]

    def _waits(self, number: int, ack: int) -> bool:
        """True if a node waits for this ack, which it has just heard, still."""
        field, packet = self.locals.field, self.locals.packets[ack]
        i = field(number, "busy")
        names = ("q_state", "q_link_dst", "q_origin", "q_seq")
        waiting = (UNACKED, packet.link_src, packet.origin, packet.seq)
        return i >= 0 and tuple(field(number, name)[i] for name in names) == waiting

    def faults(self, net: Net) -> list[Successor]:
        """A node dies; one that is dead is switched on, its memory lost.

        Timed, that happens before a beat, a death also before a frame goes out.
        """
        deaths, revivals, frames, acks = net.left
        found: list[Successor] = []
        if self.model.beats:
            if min(net.ticks) < self.calm_beats():
                return []
            timer = self.soonest(net)[2]
            deaths = deaths if timer in (NONE, const.TICK) else 0
            revivals = revivals if timer == const.TICK else 0
        for node, number in enumerate(net.nodes):
            if number != DEAD and deaths:
                got = frozenset(row for row in self.sets[net.got] if row[0] != node)
                after = net._replace(
                    nodes=with_one(net.nodes, node, DEAD),
                    lags=with_one(net.lags, node, 0),
                    left=(net.left[0] - 1, net.left[1], frames, acks),
                    got=self._set_of(got),
                )
                found.append((Move(DIE, node), after, 0))
            if number == DEAD and revivals:
                fresh = self.locals.start(node, 1 + self.model.budget.revivals - revivals)
                after = net._replace(
                    nodes=with_one(net.nodes, node, fresh.state),
                    left=(net.left[0], net.left[1] - 1, frames, acks),
                )
                found.append((Move(REVIVE, node), after, fresh.broken))
        return found

    # Calls.

    def _part(self, net: Net) -> Part:
        return Part(net.nodes, net.lags, net.got, (), (), 0)

    def _apply(
        self, parts: list[Part], node: int, event: tuple[int, ...], elapsed: int = NONE
    ) -> list[Part]:
        """An event at a node, on every state in the making; draws make more of them."""
        found = []
        for part in parts:
            since = part.lags[node] if elapsed == NONE else elapsed
            for out in self.locals.call(part.nodes[node], event, since):
                got, broken = part.got, part.broken or out.broken
                for packet in out.delivered:
                    got, twice = self._deliver(got, node, packet)
                    broken = broken or twice
                nodes, lags = part.nodes, part.lags
                if out.state != nodes[node]:
                    nodes = with_one(nodes, node, out.state)
                if lags[node]:
                    lags = with_one(lags, node, 0)
                acks, script = part.acks + out.acks, part.script + out.script
                found.append(Part(nodes, lags, got, acks, script, broken))
        return found

    def _done(self, net: Net, move: Move, part: Part) -> Successor:
        after = net._replace(nodes=part.nodes, lags=part.lags, got=part.got)
        return move._replace(script=part.script), after, part.broken

    def _deliver(self, got: int, node: int, number: int) -> tuple[int, int]:
        """Note a delivery; broken if the packet came before, or more of them than were offered."""
        packet = self.locals.packets[number]
        if packet.origin == node:
            return got, 0
        row = (node, packet.origin, packet.seq, packet.kind)
        rows = self.sets[got]
        if row in rows:
            return got, local.BROKEN_TWICE
        came = sum(other[:2] == row[:2] and other[3] == const.DATA for other in rows | {row})
        broken = packet.kind == const.DATA and came > self.model.offers.count((packet.origin, node))
        return self._set_of(rows | {row}), local.BROKEN_TWICE if broken else 0

    def _set_of(self, rows: frozenset[tuple[int, int, int, int]]) -> int:
        number = self.set_numbers.get(rows)
        if number is None:
            number = self.set_numbers[rows] = len(self.sets)
            self.sets.append(rows)
        return number
