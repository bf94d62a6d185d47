"""A world of two cells in a line, its bytes set by hand: the PC - cell 0 - cell 1."""

from functools import cache

from innervate.networks.skin.protocol.constants import INFINITY, PORTS
from innervate.networks.skin.verify import graphs, reduction
from innervate.networks.skin.verify import row as r
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.system import Budget, SkinModel, system_of
from innervate.verify.twin import Twin

PC = 2
NOTHING = (INFINITY, 0, 0)  # what a port or frame says that is of no use


@cache
def made(ticks, counts, faults, graph, keys):
    """A plain world of a model, and its first row."""
    none = dict.fromkeys(("loss", "cut", "heal", "false", "restart"), 0)
    budget = Budget(ticks, counts, **none | dict(faults), faults=2)
    model = SkinModel(graphs.parse(graph), budget=budget, **dict(keys))
    twin = Twin(model, system_of())
    return twin, twin.row()


class Tiny:
    """Everything is silent, no port has heard anything, nobody is anybody's parent.

    Args:
        ticks: periods of every cell.
        counts: beacons of the PC.
        faults: budgets, by name; all of them together are as many.
        keys: of the model.
    """

    def __init__(self, ticks=3, counts=2, faults=(), graph="pc-1 1-2", **keys):
        more = {"updates": "triggered", "lean": True} | keys
        given = tuple(dict(faults).items()), graph, tuple(more.items())
        self.twin, first = made(ticks, counts, *given)
        self.twin.put(first)
        self.model = self.twin.model
        self.world, self.lay = self.twin.world, self.twin.lay
        self.row = self.world.work
        for at in range(self.lay.pc_at + w.PC_BYTES):
            self.row[at] = 0
        for c in range(PC):
            self.cell(c, TICKS=ticks, SENT_DIST=r.NOTHING_SENT)
        for at in self.lay.port_at:
            if at >= 0:
                self.row[at + w.DIST] = INFINITY
        for way in range(self.lay.ways):
            r.clear(self.world, way)
        self.row[self.lay.pc_at + w.PC_COUNTS] = counts
        for link in range(len(self.lay.links)):
            self.row[self.lay.link_at + link] = 0
        self.world.found[0] = w.FINE

    def cell(self, c, **values):
        """Set bytes of a cell's head, by the names of world.py."""
        for name, value in values.items():
            self.row[self.lay.cell_at[c] + getattr(w, name)] = value
        return self

    def pc(self, **values):
        """Set bytes of the PC."""
        for name, value in values.items():
            self.row[self.lay.pc_at + getattr(w, name)] = value
        return self

    def head(self, c, name):
        """A byte of a cell's head."""
        return self.row[self.lay.cell_at[c] + getattr(w, name)]

    def end(self, c, other):
        """The end of a node at which its cable to another node is."""
        graph = self.model.graph
        ends = range(PORTS * c, PORTS * c + PORTS) if c < PC else range(PORTS * PC, len(graph.peer))
        return next(e for e in ends if graph.peer[e] >= 0 and graph.node_of(graph.peer[e]) == other)

    def port(self, c, other, *said):
        """What a cell's port to another node has heard: (dist, sq, says); set, if it is given."""
        at = self.lay.port_at[self.end(c, other)]
        if said:
            self.row[at + w.DIST], self.row[at + w.SQ], self.row[at + w.SAYS] = said
        return tuple(self.row[at + i] for i in (w.DIST, w.SQ, w.SAYS))

    def way(self, sender, receiver):
        """The direction from one node to another."""
        return self.lay.in_way[self.end(receiver, sender)]

    def queue(self, sender, receiver, *frames):
        """Frames on their way, oldest first; set, if they are given."""
        at = self.lay.queue_at[self.way(sender, receiver)]
        if frames:
            self.row[at] = len(frames)
            for i, frame in enumerate(frames):
                for k, value in enumerate(frame):
                    self.row[at + 1 + w.FRAME_BYTES * i + k] = value
        count = self.row[at]
        first = at + 1
        behind = range(first + w.FRAME_BYTES * count, at + self.lay.queue_bytes)
        assert not any(self.row[i] for i in behind), "a frame that is gone left something"
        return [tuple(self.row[first + w.FRAME_BYTES * i + k] for k in range(w.FRAME_BYTES))
                for i in range(count)]  # fmt: skip

    def cut(self, a, b):
        """Cut a cable."""
        self.row[self.lay.link_at + self.way(a, b) // 2] = 1
        return self

    def tidy(self):
        """Forget what no future depends on."""
        reduction.tidy(self.world)
        return self

    def move(self, kind, arg=0):
        """The place of a move among the model's."""
        return self.lay.moves().index((kind, arg))

    def ways(self, kind, arg=0):
        """In how many ways a move can be made."""
        return self.twin.system.variants(self.world, self.move(kind, arg))

    def step(self, kind, arg=0, variant=0):
        """Make a move."""
        assert self.twin.system.step(self.world, self.move(kind, arg), variant, 0) > 0
        return self

    def budget(self):
        """What may still happen, and all together."""
        return list(self.row[self.lay.budget_at : self.lay.budget_at + w.BUDGETS])
