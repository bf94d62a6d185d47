"""A network of any kind that declares its protocol: how the states of its nodes follow each other.

Nodes know only their own time, so that a state holds timers and moments relative to it: fields in
"us" of the full range of clocks. It passes when a timer fires, and not between; what other nodes do
meanwhile is left open.
"""

from collections.abc import Iterator
from operator import itemgetter
from types import ModuleType
from typing import Any

from innervate.dialect import plain
from innervate.dialect.access import ALL
from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER, URGENT
from innervate.topology import PORTS, Graph
from innervate.verify.draws import Draws
from innervate.verify.frames import TIMED, Frames
from innervate.verify.readings import Readings
from innervate.verify.states import After, Budget, Move, Node, State, Step, happen, sent
from innervate.verify.telling import ERRORS, first_broken, where
from innervate.verify.values import ahead, moved, put, values, with_one

OUTBOX = 16
COLD, MEMORY_LOST = 0, 1
NEVER = 1 << 62  # us
SWITCHED_ON = "switched on"
OF_RECEIVER = {"made_at", "rssi"}  # fields of a frame that each receiver may have its own of


def next_timer(timer: tuple[int, int]) -> tuple[int, int]:
    """By what timers come: when they are due, then their number."""
    return timer[1], timer[0]


class Net:
    """Makes the states of a graph's nodes follow each other.

    Args:
        protocol, fields: parts of a network.
        graph: its nodes and cables.
        params: of the protocol; others are the value in range nearest 0.
    """

    def __init__(
        self, protocol: ModuleType, fields: ModuleType, graph: Graph, params: dict[str, int]
    ) -> None:
        self.do, self.fields, self.graph = protocol, fields, graph
        self.on_air = hasattr(protocol, "on_carrier")
        self.has_carrier = self.on_air
        self.is_told = hasattr(protocol, "on_sent")  # when its frames have left
        self.is_slotted = False  # on a channel: frames last so many slots
        self.is_addressed = False  # a frame's field `to` says who is given it
        self.own: dict[str, Any] = {}  # what must hold of a node, by what it says
        self.of_all: dict[str, Any] = {}  # and of all nodes together
        self.params = plain.make("Params", fields.PARAMS, array=plain.Row)()
        for name, value in params.items():
            setattr(self.params, name, value)
        self.draws = Draws()
        self.node = self.draws.node(plain.make("Node", fields.STATE))()
        frame = plain.make("Frame", fields.FRAME)
        self.out = plain.Outbox(frame, getattr(protocol, "OUTBOX", OUTBOX))
        self.frame = frame()
        self.frames = Frames(fields.FRAME)
        for one in self.out.frame:
            self.frames.blank(one)
        self.all = [plain.make("Node", fields.STATE)() for _ in range(graph.cells)]
        self.given = getattr(fields, "GIVEN", ())
        self.clocks = {name for name, _, _, high, unit, _ in fields.STATE
                       if unit == "us" and high == MASK30 and name != TIMED}  # fmt: skip
        self.readings: Readings | None = None  # where calls are looked at by it
        self.past: dict[tuple[str, int], int] = {}  # us that a handler set a timer in the past
        self.moving = set[Node]()  # due at once, and known to go on (see standing.py)

    def begins(self, budget: Budget) -> Iterator[Step]:
        """All ways in which the network can begin, by what its nodes draw."""
        return self.draws.outcomes(self.begin, budget)

    def begin(self, budget: Budget) -> Step:
        """All nodes are switched on, one after the other."""
        blank = plain.make("Node", self.fields.STATE)
        nodes = []
        for number in range(self.graph.cells):
            node = blank()
            for name, value in (("number", number), ("rng", 1 + number), ("choice", -1)):
                if hasattr(node, name):
                    setattr(node, name, value)
            nodes.append(Node(values(node, self.fields.STATE), ()))
        state = State(
            tuple(nodes), ((),) * len(self.graph.peer), (budget.loss, budget.restart, budget.input)
        )
        for number in range(self.graph.cells):
            state, broken = self.call(state, number, 0, self.do.on_start, COLD)
            if broken:
                return Step(f"{self.graph.label(number)} is {SWITCHED_ON}", state, broken)
        return Step(f"All nodes are {SWITCHED_ON}", state, "")

    def steps(self, state: State) -> Iterator[Step]:
        """All that can happen next, with all that it can draw."""
        for move in self.moves(state):
            yield from self.draws.outcomes(happen, move)

    def moves(self, state: State) -> Iterator[Move]:
        """All that can happen next, not yet done."""
        label, end_label = self.graph.label, self.graph.label_end
        loss, restart, given = state.left
        for end, frames in enumerate(state.ways):
            if frames:
                yield Move(self.words_of_arrival(end), self.arrive, (state, end))
                if loss:
                    rest = with_one(state.ways, end, frames[1:])
                    gone = state._replace(ways=rest, left=(loss - 1, restart, given))
                    what = f"A frame from {end_label(end)} is lost"
                    if self.on_air:
                        what = f"{self.receiver(end)} does not hear a frame of {self.sender(end)}"
                    yield Move(what, self.missed, (gone, end))
        for number, node in enumerate(state.nodes):
            who = label(number)
            yield from self.due(state, number)
            if node.airing:
                yield Move(f"A frame of {who} has ended", self.fall_silent, (state, number))
            if node.down:
                yield Move(f"A frame of {who} goes out", self.leave, (state, number, 1))
                if loss:
                    busy = state._replace(left=(loss - 1, restart, given))
                    what = f"A frame of {who} finds the channel busy and is given up"
                    yield Move(what, self.leave, (busy, number, 0))
            if restart:
                lost = state._replace(left=(loss, restart - 1, given))
                yield Move(f"{who} loses its memory", self.forget, (lost, number))
            if given:
                fewer = state._replace(left=(loss, restart, given - 1))
                for kind, item in self.given:
                    what = f"{who} is given {kind}{self.told_of(kind, item)} by its user"
                    yield Move(what, self.give, (fewer, number, kind, item))

    def words_of_arrival(self, end: int) -> str:
        """That the oldest frame from an end comes in."""
        if self.on_air:
            return f"{self.receiver(end)} hears a frame of {self.sender(end)}"
        return f"{self.receiver(end)} gets a frame from {self.graph.label_end(end)}"

    def receiver(self, end: int) -> str:
        """Who is at the other side of an end."""
        return self.graph.label(self.graph.node_of(self.graph.peer[end]))

    def sender(self, end: int) -> str:
        """The node that an end belongs to, by name."""
        return self.graph.label(self.graph.node_of(end))

    def told_of(self, kind: int, item: dict[str, Any]) -> str:
        """What an item holds, where users have others of its kind."""
        if sum(one == kind for one, _ in self.given) < 2:
            return ""
        held = ", ".join(f"{name} {value}" for name, value in item.items())
        return f" ({held or 'empty'})"

    def forget(self, state: State, number: int) -> After:
        """A node loses its memory, and begins again."""
        blank = Node(state.nodes[number].values, ())
        lost = state._replace(nodes=with_one(state.nodes, number, blank))
        return self.call(lost, number, 0, self.do.on_start, MEMORY_LOST)

    def arrive(self, state: State, end: int) -> After:
        """The oldest frame from an end comes to the other."""
        first, *rest = state.ways[end]
        peer = self.graph.peer[end]
        number, port = self.graph.node_of(peer), self.graph.port_of(peer)
        put(self.frame, self.fields.FRAME, first)
        gone = state._replace(ways=with_one(state.ways, end, tuple(rest)))
        if self.on_air:
            return self.heard(gone, number)
        return self.call(gone, number, 0, self.do.on_frame, port, self.frame)

    def heard(self, state: State, number: int) -> After:
        """A frame on the air: a carrier alone, the frame, silence."""
        frame = values(self.frame, self.fields.FRAME, OF_RECEIVER)
        after, broken = state, ""
        if self.has_carrier:
            after, broken = self.call(state, number, 0, self.do.on_carrier, 1, 1)
        put(self.frame, self.fields.FRAME, frame)
        is_ours = not self.is_addressed or self.frame.to in (number, ALL)
        if not broken and is_ours:
            after, broken = self.call(after, number, 0, self.do.on_frame, 0, self.frame)
            if values(self.frame, self.fields.FRAME, OF_RECEIVER) != frame:
                broken = broken or "a receiver changed the frame that the others are handed, too"
        if not broken and self.has_carrier:
            after, broken = self.call(after, number, 0, self.do.on_carrier, 0, 0)
        return after, broken

    def fall_silent(self, state: State, number: int) -> After:
        """A frame of a node's own has ended, and it is told."""
        node = state.nodes[number]
        over = node._replace(airing=node.airing - 1)
        ended = state._replace(nodes=with_one(state.nodes, number, over))
        return self.call(ended, number, 0, self.do.on_carrier, 0, 0)

    def missed(self, state: State, end: int) -> After:
        """A frame is lost; on the air its receiver hears that there was something."""
        if not self.has_carrier:
            return state, ""
        number = self.graph.node_of(self.graph.peer[end])
        after, broken = self.call(state, number, 0, self.do.on_carrier, 1, 0)
        if not broken:
            after, broken = self.call(after, number, 0, self.do.on_carrier, 0, 0)
        return after, broken

    def ends_of(self, number: int, port: int) -> list[int]:
        """Where what a node sends goes: to all who hear it, once to each, or out of a port."""
        ends = self.graph.ends_of(number) if self.on_air else [self.graph.end(number, port)]
        ends = [end for end in ends if self.graph.peer[end] >= 0]
        if self.on_air:  # two cables between two nodes are one way on the air
            ends = list({self.receiver(end): end for end in reversed(ends)}.values())[::-1]
        return ends

    def give(self, state: State, number: int, kind: int, item: dict[str, Any]) -> After:
        """A node's user hands something down."""
        blank = plain.make("Frame", self.fields.FRAME)()
        put(self.frame, self.fields.FRAME, values(blank, self.fields.FRAME))
        for name, value in item.items():
            setattr(self.frame, name, list(value) if isinstance(value, list | tuple) else value)
        return self.call(state, number, 0, self.do.on_input, kind, self.frame)

    def due(self, state: State, number: int) -> Iterator[Move]:
        """What a node's own time brings next: a timer, or that a delayed frame leaves."""
        node = state.nodes[number]
        timer = min((wait for _, wait in node.timers), default=NEVER)
        late = node.late[0][0] if node.late else NEVER
        who = self.graph.label(number)
        if timer <= late and node.timers:
            first = min(node.timers, key=next_timer)[0]
            yield Move(f"Timer {first} of {who} fires", self.fire, (state, number))
        if late <= timer and node.late:
            yield Move(f"A delayed frame of {who} leaves", self.depart, (state, number))

    def depart(self, state: State, number: int) -> After:
        """A frame that was sent with a delay leaves; so far its node's time passes."""
        node = state.nodes[number]
        (wait, port, frame), *rest = node.late
        put(self.node, self.fields.STATE, node.values)
        after = self.kept(state, number, max(wait, 0), node._replace(late=tuple(rest)))
        return sent(after, self.ends_of(number, port), frame), ""

    def fire(self, state: State, number: int) -> After:
        """The next timer of a node fires; so far its time passes."""
        node = state.nodes[number]
        timer, wait = min(node.timers, key=next_timer)
        rest = tuple(one for one in node.timers if one[0] != timer)
        waiting = state._replace(nodes=with_one(state.nodes, number, node._replace(timers=rest)))
        return self.call(waiting, number, max(wait, 0), self.do.on_timer, timer)

    def leave(self, state: State, number: int, ok: int) -> After:
        """A frame that a node handed down goes out, or the channel stayed busy; it is told."""
        first, *rest = state.nodes[number].down
        node = state.nodes[number]._replace(down=tuple(rest))
        gone = state._replace(nodes=with_one(state.nodes, number, node))
        if ok:
            node = node._replace(airing=node.airing + self.has_carrier)
            gone = state._replace(nodes=with_one(state.nodes, number, node))
            gone = sent(gone, self.ends_of(number, 0), first)
        return self.call(gone, number, 0, self.do.on_sent, ok)

    def call(self, state: State, number: int, now: int, handler: Any, *what: Any) -> After:
        """The state after a handler of a node at its time `now`, and what it broke."""
        node, out = state.nodes[number], self.out
        if self.readings is not None:
            self.readings.look(node.values, self.graph.label(number), handler, now, *what)
        put(self.node, self.fields.STATE, node.values)
        if wrong := self.handle(self.graph.label(number), handler, now, *what):
            return state, f"a handler cannot go on: {wrong}"
        broken = self.broken(now)
        timers, down, late = dict(node.timers), list(node.down), list(node.late)
        airing = node.airing
        for act, frame in zip(out.action[: out.count[0]], out.frame, strict=False):
            broken = self.frames.wrong(frame, act.kind, handler.__name__, broken)
            if act.kind == SET_TIMER:
                timers[act.a] = ahead(act.b)
                if ahead(act.b - now) < 0:
                    setter = handler.__name__, act.a
                    self.past[setter] = max(self.past.get(setter, 0), -ahead(act.b - now))
                broken = broken or ("" if 0 <= act.a < self.do.TIMERS else "there is no such timer")
            elif act.kind == SEND:
                if not 0 <= act.a < PORTS:
                    broken = broken or "a frame is sent on a port that no node has"
                    continue
                if self.is_slotted and frame.slots < 1:
                    broken = broken or "a frame of no slots is sent"
                one = values(frame, self.fields.FRAME, {"made_at"})
                if self.is_told and not act.c & URGENT:
                    down.append(one)
                    continue
                ends = self.ends_of(number, act.a)
                if act.b > 0 and ends and not self.on_air:
                    late.append((now + act.b, act.a, one))
                    continue
                state, airing = sent(state, ends, one), airing + self.has_carrier
            elif act.kind not in (DELIVER, REPORT):
                broken = broken or "the outbox holds what is no action"
        asked = Node((), tuple(timers.items()), tuple(down), tuple(late), airing)
        return self.kept(state, number, now, asked), broken

    def handle(self, who: str, handler: Any, now: int, *what: Any) -> str:
        """Let a handler work on the node and the outbox; why it cannot go on, "" if it can."""
        out = self.out
        for one in out.frame[: out.count[0]]:
            self.frames.blank(one)
        out.count[0] = out.overflow[0] = 0
        self.draws.call(who)
        try:
            handler(self.node, self.params, now, *what, out)
        except ERRORS as error:
            return where(error)
        finally:
            self.draws.call("")
        return ""

    def kept(self, state: State, number: int, now: int, asked: Node) -> State:
        """The state with a node as it is now, its moments relative to its time."""
        for name in self.clocks:
            setattr(self.node, name, moved(getattr(self.node, name), -now))
        waits = tuple(sorted((timer, at - now) for timer, at in asked.timers))
        late = sorted(((at - now, port, one) for at, port, one in asked.late), key=itemgetter(0))
        left = asked._replace(values=values(self.node, self.fields.STATE), timers=waits)
        node = left._replace(late=tuple(late))
        return state._replace(nodes=with_one(state.nodes, number, node))

    def broken_of_all(self, state: State) -> str:
        """What is broken of all nodes together."""
        for node, at in zip(self.all, state.nodes, strict=True):
            put(node, self.fields.STATE, at.values)
        return first_broken(self.of_all, self.all, len(self.all), self.params)

    def broken(self, now: int) -> str:
        """What the last handler broke."""
        if self.out.overflow[0]:
            return "an outbox overflowed"
        for name, length, low, high, *_ in self.fields.STATE:
            value = getattr(self.node, name)
            if length:
                fits = all(low <= one <= high for one in value)
            else:
                fits = low <= value <= high
            if not fits:
                return f"{name} is out of its declared range"
        return first_broken(self.own, self.node, self.params, now)
