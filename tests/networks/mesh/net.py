"""A mesh on lossy links, in plain Python: losses, cuts, deaths, revivals, an rssi per link."""

import copy
import math
import random

from innervate.dialect.arith import MASK30
from innervate.dialect.rng import seeded
from innervate.kernel.records import Words
from innervate.networks.mesh.protocol import node as mesh
from innervate.networks.mesh.protocol.constants import SAMPLE
from innervate.networks.mesh.protocol.neighbours import place_of
from tests.networks.mesh.bench import DECLARED, Bench, Item

LOUD = -60


class Net(Bench):
    """A Bench whose links lose frames (`loss`, of every kind), have an rssi, and can be cut.

    With `told = 1` frames leave one after the other and the node hears when they have left.
    """

    def __init__(self, count, links, loss=0.0, seed=1, rssi=None, thorough=False, **settings):
        self.chance = random.Random(seed)
        self.loss = loss
        self.loudness = rssi or {}
        self.thorough = thorough  # look at every field's range after every handler
        super().__init__(count, links, **settings)
        self.lose_by_chance()

    def cut(self, a, b):
        self.neighbours[a].discard(b)
        self.neighbours[b].discard(a)

    def join(self, a, b):
        self.neighbours[a].add(b)
        self.neighbours[b].add(a)

    def kill(self, i):
        self.dead.add(i)
        self.due = {key: at for key, at in self.due.items() if key[0] != i}

    def revive(self, i):
        """Switched on again, its memory lost."""
        self.start(i, 1)

    def rssi_of(self, i, to):
        return self.loudness.get((i, to), LOUD)

    def sample(self, i, x, y, vx=0, vy=0):
        """A robot learns where it is."""
        item = Item()
        item.x, item.y, item.vx, item.vy = x, y, vx, vy
        self.give(i, SAMPLE, item)

    def give(self, i, kind, item):
        now = self.now & MASK30
        mesh.on_input(self.nodes[i], self.gates[i], self.params, now, kind, item, self.out)
        self.drain(i)

    def queued(self):
        """Frames in queues, messages kept, per live node."""
        return {
            i: [k for k in node.q_state if k] + [k for k in node.wait_kind if k]
            for i, node in enumerate(self.nodes)
            if i not in self.dead and (any(node.q_state) or any(node.wait_kind))
        }

    def settled(self, i):
        """What must hold of the queue between handlers."""
        node = self.nodes[i]
        under_way = [k for k, state in enumerate(node.q_state) if state in (2, 3)]
        if self.params.hop_frames:
            counted = sum(node.hop_under[k] for k in range(self.params.places))
            unknown = sum(self.is_unknown(node, k) for k in under_way)
            assert counted + unknown == len(under_way), (i, node.q_state, node.hop_under)
        else:
            assert under_way == ([node.busy] if node.busy >= 0 else []), (i, node.q_state)

    def is_unknown(self, node, k):
        """True if a frame goes to nobody in the neighbour table."""
        return place_of(node, self.params, node.q_link_dst[k]) < 0

    def check(self, i):
        if self.thorough:
            super().check(i)
        self.settled(i)

    def fork(self, seed):
        """The same net once more, from here on with other chances."""
        other = copy.copy(self)
        other.nodes = [copied(node) for node in self.nodes]
        other.words = [Words(node, DECLARED) for node in other.nodes]
        other.gates = [gate and copied(gate) for gate in self.gates]
        for name in ("neighbours", "dead", "queue", "due", "out"):
            setattr(other, name, copy.deepcopy(getattr(self, name)))
        other.reports, other.delivered, other.sent = [], [], []
        other.chance = random.Random(seed)
        for i, node in enumerate(other.nodes):
            node.rng = seeded(seed * 1009 + 7919 * (i + 1))
        other.lose_by_chance()
        return other

    def lose_by_chance(self):
        self.lost = lambda frame, to: self.loss > 0 and self.chance.random() < self.loss


def copied(record):
    """A plain record once more; copy.deepcopy looks at each of its thousands of numbers."""
    other = copy.copy(record)
    for name in record.__slots__:
        value = getattr(record, name)
        if isinstance(value, list):
            setattr(other, name, value.copy())
    return other


def line(count):
    return [(i, i + 1) for i in range(count - 1)]


def ring(count):
    return [*line(count), (0, count - 1)]


def geometric(count, degree, seed):
    """Links of a random geometric graph of that mean degree, its shortest pairs; connected."""
    chance = random.Random(seed)
    while True:
        at = [(chance.random(), chance.random()) for _ in range(count)]
        pairs = [(i, j) for i in range(count) for j in range(i + 1, count)]
        pairs.sort(key=lambda p: math.dist(at[p[0]], at[p[1]]))
        links = pairs[: count * degree // 2]
        if reach(links, 0, set()) == set(range(count)):
            return links


def reach(links, start, dead):
    """Who is connected to `start` over live nodes."""
    near = {}
    for a, b in links:
        near.setdefault(a, []).append(b)
        near.setdefault(b, []).append(a)
    found, todo = {start}, [start]
    while todo:
        for b in near.get(todo.pop(), []):
            if b not in found and b not in dead:
                found.add(b)
                todo.append(b)
    return found
