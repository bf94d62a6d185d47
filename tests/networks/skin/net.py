"""A network of plain nodes on the bench, stepped by hand (see bench.py)."""

from innervate.dialect.arith import after, later
from innervate.networks.skin.protocol.constants import NONE, PORTS
from innervate.topology import free_graph
from tests.networks.skin.bench import (
    REAL,
    Box,
    clone,
    new_cell,
    out_of_range,
    params_of,
    sink_state,
)

BOOT = 0
MEMORY_LOST = 1


class Broken(AssertionError):
    """An invariant does not hold."""


class Net:
    """Cells and the PC (named "pc") on the cables `links`, like [("pc", "n1"), ("n1", "n2")].

    `now` is one clock for all (us); a tick moves it to the node's own moment if that is later.
    """

    def __init__(self, links, protocol=REAL, *, seed=1, params=None, **keys):
        self.protocol = protocol
        self.graph = free_graph([tuple(link) for link in links])
        self.params = params or params_of(protocol, max(self.graph.depths()), **keys)
        self.static = self.params.rule == protocol.skin_constants.RULE_STATIC
        self.cells = [new_cell(protocol, i, seed + 7919 * i) for i in range(self.graph.cells)]
        self.pc = sink_state(protocol, self.graph.interfaces)
        self.box = Box(protocol, max(16, self.graph.interfaces + 4))
        self.names = {self.graph.label(node): node for node in range(self.graph.nodes)}
        self.now = 0
        self.wires = {end: [] for link in self.graph.links() for end in link}  # by sender's end
        self.down = set()  # ends of cables that are cut
        self.dead = set()
        self.timers = [{} for _ in range(self.graph.nodes)]
        self.reports = []  # (node, code, a, b)
        self.delivered = []
        self.rings = 0
        self.fds = [None] * self.graph.cells
        for node in range(self.graph.nodes):
            self.start(node, BOOT)

    # Handlers.

    def start(self, node, cause=MEMORY_LOST):
        """Switch a node on; the cables keep what is on them."""
        handlers = self._handlers(node)
        handlers[0](*self._head(node), cause, self.box.out)
        if node < self.graph.cells:
            self.fds[node] = None
        self.drain(node)

    def frame(self, node, port, frame):
        """Hand a node a frame."""
        self._handlers(node)[1](*self._head(node), port, frame, self.box.out)
        self.drain(node)

    def timer(self, node, timer):
        """Let a node's timer fire."""
        self.timers[node].pop(timer, None)
        self._handlers(node)[2](*self._head(node), timer, self.box.out)
        self.drain(node)

    def sample(self, node):
        """Let a cell read its sensors."""
        item = self.box.frame_class()
        skin = self.protocol.skin
        skin.on_input(*self._head(node), self.protocol.skin_constants.SAMPLE, item, self.box.out)
        self.drain(node)

    def _handlers(self, node):
        skin, sink, static = (
            self.protocol.skin, self.protocol.skin_sink, self.protocol.skin_static
        )  # fmt: skip
        if node == self.graph.cells:
            if self.static:
                return sink.on_start, static.sink_frame, static.sink_timer
            return sink.on_start, sink.on_frame, sink.on_timer
        if self.static:
            return static.on_start, static.on_frame, static.on_timer
        return skin.on_start, skin.on_frame, skin.on_timer

    def _head(self, node):
        state = self.pc if node == self.graph.cells else self.cells[node]
        return state, self.params, self.now & ((1 << 30) - 1)

    def drain(self, node):
        """Carry out what a handler asked for."""
        kinds = self.protocol.outbox
        for kind, a, b, c, frame in self.box.take():
            if kind == kinds.SEND:
                end = self.graph.end(node, a)
                if end in self.wires and end not in self.down and not self._off(end):
                    self.wires[end].append(frame)
            elif kind == kinds.SET_TIMER:
                self.timers[node][a] = b
            elif kind == kinds.REPORT:
                self.reports.append((node, a, b, c))
                if a == self.protocol.skin_constants.REPORT_FORGET:
                    self.fds[node] = None
            else:
                self.delivered.append(frame)

    # Events. Nodes and ends are given as numbers or by name.

    def node(self, name):
        """A node's number."""
        return self.names[name] if isinstance(name, str) else name

    def end(self, here, there):
        """The end, at node `here`, of the first cable to `there`."""
        here, there = self.node(here), self.node(there)
        for end in self.graph.ends_of(here):
            if self.graph.peer[end] >= 0 and self.graph.node_of(self.graph.peer[end]) == there:
                return end
        raise KeyError(f"no cable from {self.graph.label(here)} to {self.graph.label(there)}")

    def tick(self, name):
        """A node's period is over."""
        node = self.node(name)
        if node in self.dead:
            return
        at = self.timers[node].get(self.protocol.skin_constants.TICK, self.now)
        if after(at, self.now & ((1 << 30) - 1)):
            self.now += (at - self.now) & ((1 << 30) - 1)
        self.timer(node, self.protocol.skin_constants.TICK)

    def soon(self, name):
        """The send-soon timer of a node fires, if it is set."""
        node = self.node(name)
        if node not in self.dead and self.protocol.skin_constants.SOON in self.timers[node]:
            self.timer(node, self.protocol.skin_constants.SOON)

    def deliver(self, end):
        """The oldest frame sent from `end` arrives; True if there was one."""
        if not self.wires[end]:
            return False
        frame = self.wires[end].pop(0)
        peer = self.graph.peer[end]
        node = self.graph.node_of(peer)
        if node not in self.dead:
            self.frame(node, self.graph.port_of(peer), frame)
        return True

    def deliver_all(self):
        """Everything under way arrives, and what that sets off."""
        while any([self.deliver(end) for end in self.wires]):
            pass

    def lose(self, end):
        """The oldest frame sent from `end` is lost; True if there was one."""
        return bool(self.wires[end]) and self.wires[end].pop(0) is not None

    def cut(self, end):
        """Cut a cable; what is on it is lost."""
        for side in (end, self.graph.peer[end]):
            self.down.add(side)
            self.wires[side].clear()

    def restore(self, end):
        """Mend a cable."""
        self.down -= {end, self.graph.peer[end]}

    def detect(self, end):
        """The cell at `end` misses one more beacon there, and with it finds the port broken."""
        cell, port = self.cells[self.graph.node_of(end)], self.graph.port_of(end)
        cell.heard[port] = 0
        cell.pf[port] = self.protocol.skin_constants.ONE - 1

    def kill(self, node):
        """A node goes dark; what is on its cables is lost."""
        self.dead.add(node)
        self.timers[node].clear()
        for end in self.graph.ends_of(node):
            if end in self.wires:
                self.wires[end].clear()
                self.wires[self.graph.peer[end]].clear()

    def revive(self, node):
        """A dead node is switched on again."""
        self.dead.discard(node)
        self.start(node, MEMORY_LOST)

    def turn(self, order=None):
        """Every node ticks once, in this order, and is heard before the next one ticks."""
        for node in order or range(self.graph.nodes):
            self.tick(node)
            self.deliver_all()

    def period(self, order=None):
        """Every node ticks once, in this order, then everything under way arrives."""
        for node in order or range(self.graph.nodes):
            self.tick(node)
        self.deliver_all()

    def _off(self, end):
        nodes = {self.graph.node_of(end), self.graph.node_of(self.graph.peer[end])}
        return bool(nodes & self.dead)

    # What can be seen.

    def parent(self, name):
        """The name of a cell's parent, or None."""
        cell = self.node(name)
        port = self.cells[cell].parent
        if port == NONE or self.graph.peer[PORTS * cell + port] < 0:
            return None
        return self.graph.label(self.graph.node_of(self.graph.peer[PORTS * cell + port]))

    def distance(self, name):
        """D of a cell."""
        return self.protocol.skin.distance(self.cells[self.node(name)])

    def hop(self, cell):
        """The node a cell's data goes to over a live cable, or NONE."""
        port = self.cells[cell].parent
        end = PORTS * cell + port
        if port == NONE or self.graph.peer[end] < 0 or end in self.down or self._off(end):
            return NONE
        return self.graph.node_of(self.graph.peer[end])

    def ring(self):
        """The names of the cells of a closed ring of parents over live cables, or []."""
        done = set()
        for start in range(self.graph.cells):
            path, node = [], start
            while node not in (NONE, self.graph.sink) and node not in done:
                if node in path:
                    return [self.graph.label(member) for member in path[path.index(node) :]]
                path.append(node)
                node = self.hop(node)
            done.update(path)
        return []

    def check(self):
        """Raise Broken unless all invariants of [skin 6] hold that the rule promises."""
        fields = self.protocol.skin_fields
        for cell, state in enumerate(self.cells):
            if wrong := out_of_range(state, fields.CELL):
                raise Broken(f"{self.graph.label(cell)}: {wrong}")
        if wrong := out_of_range(self.pc.own[0], fields.SINK):
            raise Broken(f"pc: {wrong}")
        if self.params.rule < self.protocol.skin_constants.RULE_PAPER and (ring := self.ring()):
            raise Broken("closed loop " + " -> ".join([*ring, ring[0]]))
        if self.params.rule == self.protocol.skin_constants.RULE_FEASIBLE:
            for cell in range(self.graph.cells):
                self._check_fd(cell)

    def _check_fd(self, cell):
        """fd never gets worse but when it is forgotten, and is worse than the parent's."""
        state, before = self.cells[cell], self.fds[cell]
        if before is not None and nearer(before, state):
            raise Broken(f"fd of {self.graph.label(cell)} got worse: "
                         f"{fd_words(before)} to {fd_words(state)}")  # fmt: skip
        self.fds[cell] = clone(state)
        hop = self.hop(cell)
        if hop in (NONE, self.graph.sink) or not is_in_force(self.cells[hop]):
            return
        if not nearer(self.cells[hop], state):
            raise Broken(
                f"fd of {self.graph.label(cell)} {fd_words(state)} is not worse than "
                f"{fd_words(self.cells[hop])} of its parent {self.graph.label(hop)}"
            )


def is_in_force(parent):
    """A parent that forgot its feasible distance may stand until it has a route again."""
    return parent.fd_known or parent.parent != NONE


def nearer(a, b):
    """True if the feasible distance of `a` is strictly nearer than that of `b`."""
    if not a.fd_known or not b.fd_known:
        return bool(a.fd_known)
    return bool(later(a.fd_sq, b.fd_sq)) or (a.fd_sq == b.fd_sq and a.fd_dist < b.fd_dist)


def fd_words(cell):
    """A feasible distance, to be read."""
    return f"({cell.fd_sq}, {cell.fd_dist})" if cell.fd_known else "(none)"
