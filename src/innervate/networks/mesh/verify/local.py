"""What single nodes do, by the protocol's own five functions: every call is made once and kept.

A node's state is a number; its record is brought to life only for a call that was not made before.
A state has, besides the record, when its timers fire and the frame that it has handed down.
"""

from types import ModuleType
from typing import Any, NamedTuple

from innervate.dialect import plain
from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, SEND, SET_TIMER, URGENT
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.protocol import node as mesh
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify import shape as mesh_shape
from innervate.networks.mesh.verify.shape import NOW
from innervate.verify.draws import branches
from innervate.verify.values import values

NONE = -1
NEVER = -1
RSSI = -60  # dBm: of every frame that is heard; far above any threshold
OUTBOX = 40
GRAIN_US = 50_000  # untimed: shorter waits are over as soon as they begin
TIMERS = range(const.TIMERS)
COLLECTING = 1

# What a call breaks.
BROKEN_TWICE, BROKEN_ROUND, BROKEN_RANGE, BROKEN_OUTBOX, BROKEN_HELD = range(1, 6)
BROKEN_UNHEARD, BROKEN_ENDLESS, BROKEN_GATEWAYS, BROKEN_CRASH, BROKEN_ACKED = range(6, 11)
BROKEN_DEPOSED, BROKEN_FIRST = 11, 12

# Events of a node: (what, ...).
FRAME, SENT, TIMER, MESSAGE, SAMPLE, START, PASS = range(7)


class Packet(NamedTuple):
    """A frame as a value."""

    kind: int
    flags: int
    link_src: int
    link_dst: int
    origin: int
    dest: int
    seq: int
    table_ver: int
    ttl: int
    rssi: int
    path: bytes
    body: bytes


class Outcome(NamedTuple):
    """What a call of a handler leaves."""

    state: int  # the node's next one
    acks: tuple[int, ...]  # numbers of frames that went out at once
    delivered: tuple[int, ...]  # frames handed to the node's user
    broken: int  # what must not be, 0 nothing
    script: tuple[int, ...]  # what its draws gave


class State(NamedTuple):
    """A node's state: its records, its timers (us from now, -1 never), the frame handed down."""

    node: tuple[Any, ...]
    gate: tuple[Any, ...] | None
    timers: tuple[int, ...]
    handed: int


class Call(NamedTuple):
    """What a node is called with, how long after its last event, and what its draws give."""

    event: tuple[int, ...]
    elapsed: int  # us
    script: tuple[int, ...]

    @property
    def now(self) -> int:
        """The time of its clock then, us."""
        return NOW + self.elapsed


class Locals:
    """All node states of a network found so far, and what calls make of them."""

    def __init__(self, model: mesh_model.MeshModel, entry: ModuleType = mesh, neat: bool = True):
        self.model, self.entry, self.neat = model, entry, neat
        self.boots = 0
        node, gate = mesh_fields.node(model.nodes), mesh_fields.gate(model.nodes)
        self.blank_node = mesh_shape.drawing(plain.make("Node", node), self._who)
        self.blank_gate = plain.make("Gate", gate)
        self.frame_class = plain.make("Frame", mesh_fields.FRAME)
        self.node, self.gate = self.blank_node(), self.blank_gate()
        self.item = plain.make("Item", mesh_fields.ITEM)()
        self.shape = mesh_shape.Shape(node, mesh_shape.TIMES + mesh_shape.AGES, 1)
        self.gate_shape = mesh_shape.Shape(gate, mesh_shape.GATE_TIMES, 1)
        self.params = plain.make("Params", mesh_fields.PARAMS)()
        for name, value in mesh_model.parameters(model).items():
            setattr(self.params, name, value)
        self.ranks = mesh_model.ranks(model)
        self.out = plain.Outbox(self.frame_class, OUTBOX)
        self.states: list[State] = []
        self.numbers: dict[State, int] = {}
        self.packets: list[Packet] = []
        self.packet_numbers: dict[Packet, int] = {}
        self.frames: list[Any] = []
        self.memo: dict[tuple[int, tuple[int, ...], int], tuple[Outcome, ...]] = {}
        self.calls = 0
        self.wide = set[int]()  # draws out of many since the exploration began: out of how many

    def begin(self) -> None:
        """Here the exploration begins; what was called before is not what it does."""
        self.memo.clear()
        self.wide.clear()

    def coarsen(self) -> None:
        """From here on a node's clock goes in steps of GRAIN_US."""
        self.shape.grain = self.gate_shape.grain = GRAIN_US

    # States and frames by number.

    def number_of(self, state: State) -> int:
        """The number of a state."""
        found = self.numbers.get(state)
        if found is None:
            found = self.numbers[state] = len(self.states)
            self.states.append(state)
        return found

    def packet_of(self, frame: Any) -> int:
        """The number of a frame."""
        packet = Packet(
            frame.kind, frame.flags, frame.link_src, frame.link_dst, frame.origin, frame.dest,
            frame.seq, frame.table_ver, frame.ttl, frame.rssi if frame.kind == const.ACK else RSSI,
            bytes(frame.path[: frame.path_len]), bytes(frame.body[: frame.length]),
        )  # fmt: skip
        found = self.packet_numbers.get(packet)
        if found is None:
            found = self.packet_numbers[packet] = len(self.packets)
            self.packets.append(packet)
            self.frames.append(self._frame(packet))
        return found

    def _frame(self, packet: Packet) -> Any:
        frame = self.frame_class()
        for name in Packet._fields[:-2]:
            setattr(frame, name, getattr(packet, name))
        frame.path_len, frame.length = len(packet.path), len(packet.body)
        frame.path[: frame.path_len] = packet.path
        frame.body[: frame.length] = packet.body
        return frame

    def field(self, number: int, name: str) -> Any:
        """A field of a node's record."""
        return self.states[number].node[self.shape.place[name]]

    # Calls.

    def start(self, who: int, boots: int) -> Outcome:
        """What switching a node on leaves; `boots` = how often it was before."""
        record, nodes = self.blank_node(), self.model.nodes
        record.number, record.rank = who, self.ranks[who]
        record.robot = int(who == self.model.robot)
        record.rng, record.neighbour = 1, [const.ALL] * nodes
        gate = None
        if self.ranks[who] >= 0:
            gate = values(self.blank_gate(), mesh_fields.gate(nodes))
        timers = (NEVER,) * const.TIMERS
        blank = State(values(record, mesh_fields.node(nodes)), gate, timers, NONE)
        return self.call(self.number_of(blank), (START, int(boots > 0), boots), 0)[0]

    def call(self, number: int, event: tuple[int, ...], elapsed: int) -> tuple[Outcome, ...]:
        """Everything an event `elapsed` us after a node's last one can make of it."""
        key = (number, event, elapsed)
        found = self.memo.get(key)
        if found is None:
            found = self.memo[key] = tuple(self._outcomes(number, event, elapsed))
        return found

    def _outcomes(self, number: int, event: tuple[int, ...], elapsed: int) -> list[Outcome]:
        """One outcome for every combination of the draws that are enumerated."""
        outcomes: list[Outcome] = []
        todo: list[tuple[int, ...]] = [()]
        while todo:
            script = todo.pop()
            outcomes.append(self._make(self.states[number], Call(event, elapsed, script)))
            todo += branches(script, self.node.drawn)
        return outcomes

    def _make(self, before: State, call: Call) -> Outcome:
        """Bring a state to life, make a call, and keep what it leaves."""
        node, event = self.node, call.event
        self.calls += 1
        self.shape.put(node, before.node)
        gate = None
        if before.gate is not None:
            gate = self.gate
            self.gate_shape.put(gate, before.gate)
        node.script, node.drawn = call.script, []
        self.boots = event[2] if event[0] == START else 0
        self.out.count[0] = 0
        self.out.overflow[0] = 0
        crashed = False
        try:
            self._handle(node, gate, call.now, event)
        except (IndexError, ValueError, ZeroDivisionError):
            crashed = True  # a mutant; what the others leave is in range
        return self._leave(before, call, gate, crashed)

    def _handle(self, node: Any, gate: Any, now: int, event: tuple[int, ...]) -> None:
        entry, params, out, what = self.entry, self.params, self.out, event[0]
        if what == FRAME:
            entry.on_frame(node, gate, params, now, 0, self.frames[event[1]], out)
        elif what == TIMER:
            entry.on_timer(node, gate, params, now, event[1], out)
        elif what == SENT:
            self.item.ok = 1
            entry.on_input(node, gate, params, now, const.SENT, self.item, out)
        elif what == MESSAGE:
            item = self.item
            item.dest, item.flags, item.handle = event[1], const.END_TO_END, event[2]
            item.length, item.body[0] = 1, event[2]
            entry.on_input(node, gate, params, now, const.MESSAGE, item, out)
        elif what == SAMPLE:
            self.item.x, self.item.y, self.item.vx, self.item.vy = -100, 500, -50, 0
            entry.on_input(node, gate, params, now, const.SAMPLE, self.item, out)
        elif what == START:
            entry.on_start(node, gate, params, now, event[1], out)

    def _leave(self, before: State, call: Call, gate: Any, crashed: bool) -> Outcome:
        """What a call has left in the records and the outbox."""
        node, out, now, event = self.node, self.out, call.now, call.event
        timers = [max(0, due - call.elapsed) if due >= 0 else NEVER for due in before.timers]
        if event[0] == TIMER:
            timers[event[1]] = NEVER
        handed = NONE if event[0] in (SENT, START) else before.handed
        acks, delivered = [], []
        broken = BROKEN_CRASH if crashed else BROKEN_OUTBOX if out.overflow[0] else 0
        for k in range(out.count[0]):
            act = out.action[k]
            if act.kind == SEND and act.c & URGENT:
                acks.append(self.packet_of(out.frame[k]))
            elif act.kind == SEND:
                broken = broken or (BROKEN_HELD if handed != NONE else 0)
                handed = self.packet_of(out.frame[k])
                broken = broken or goes_round(self.packets[handed])
            elif act.kind == SET_TIMER:
                timers[act.a] = mesh_shape.ahead(act.b, now & MASK30, self.shape.grain)
            elif act.kind == DELIVER:
                delivered.append(self.packet_of(out.frame[k]))
        number = self.number_of(before)
        if not crashed:
            try:
                number = self._keep(node, gate, now, timers, handed)
            except mesh_shape.OutOfRange:
                broken = broken or BROKEN_RANGE
        return Outcome(number, tuple(acks), tuple(delivered), broken, call.script)

    def _keep(self, node: Any, gate: Any, now: int, timers: list[int], handed: int) -> int:
        """The number of what the records are now."""
        self._drop_idle(node, gate, timers)
        if self.neat:
            mesh_shape.tidy(node, self.model.nodes, self.params.e2e_adapt, now)
        value = self.shape.take(node, now)
        kept = None if gate is None else self.gate_shape.take(gate, now)
        return self.number_of(State(value, kept, tuple(timers), handed))

    def _drop_idle(self, node: Any, gate: Any, timers: list[int]) -> None:
        """Timers that find nothing to do: setting replaces, never cancels."""
        states = node.q_state
        if node.busy != -1 or 1 not in states:
            timers[const.TX] = NEVER  # whatever ends the frame under way looks again
        if node.busy == -1 or states[node.busy] != 3:
            timers[const.ACK_WAIT] = NEVER
        if not any(node.wait_kind):
            timers[const.RETRY] = NEVER
        if not node.due and not (node.leading and gate is not None and gate.step == COLLECTING):
            timers[const.ROUND] = NEVER
        if not node.leading and (node.rank < 0 or not self.params.guard_us):
            timers[const.JOBS] = NEVER

    def _who(self, number: int, count: int) -> int:
        """What a draw out of many gives: another value for every node, and after every start."""
        self.wide.add(count)
        share = count * (number + 1) // (self.model.nodes + 2)
        return (share + 7919 * self.boots) % count


def goes_round(packet: Packet) -> int:
    """Broken if a packet's path has two hops that are the same.

    Whoever says a request again puts its own number into the path once for each hop of its depth.
    """
    hops = list(zip(packet.path, packet.path[1:], strict=False))
    if packet.kind == const.REQUEST:
        hops = [(a, b) for a, b in hops if a != b]
    return BROKEN_ROUND if len(set(hops)) < len(hops) else 0
