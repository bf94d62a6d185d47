"""A skin that is settled stays so: a route may be right by a distance that is out of date."""

from innervate.networks.skin.verify import calm as skin_calm
from innervate.networks.skin.verify import check as skin_check
from innervate.networks.skin.verify import graphs
from innervate.networks.skin.verify import system as skin_system
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.system import Budget, SkinModel
from innervate.verify.twin import Twin

X, Y, Q, C, PC = range(5)  # X and Y at the PC; X joined with Y, Q and C, and C with Q


class Played:
    """A skin whose events are chosen one by one; what is on its way to a node arrives first."""

    def __init__(self):
        graph = graphs.parse("pc-1 pc-2 1-2 1-3 1-4 3-4")
        budget = Budget(cut=2, heal=1, faults=3)
        made = SkinModel(graph, keep=True, symmetric=False, merge=False, budget=budget)
        self.twin = Twin(made, skin_system.system_of())
        self.nodes = [[graph.node_of(end) for end in ends] for ends in self.twin.lay.links]

    def do(self, kind, arg):
        """An event."""
        move = self.twin.moves.index((kind, arg))
        assert self.twin.system.step(self.twin.world, move, 0, 0) > 0

    def cable(self, kind, *nodes):
        """A cable is cut or mended."""
        self.do(kind, next(i for i, ends in enumerate(self.nodes) if sorted(ends) == sorted(nodes)))

    def tick(self, node):
        """A node hears all there is and ticks."""
        world = self.twin.world
        for way, end in enumerate(self.twin.lay.way_end):
            while self.twin.model.graph.node_of(end) == node and world.work[world.queue_at[way]]:
                self.do(w.DELIVER, way)
        self.do(*((w.PC_TICK, 0) if node == PC else (w.TICK, node)))

    def is_settled(self):
        """What a fair schedule asks for after a round."""
        return bool(skin_check.is_settled(self.twin.world))


def test_a_route_by_a_distance_out_of_date_is_not_settled():
    played = Played()
    played.cable(w.CUT_LINK, X, C)
    for node in (PC, X, Y, Q, PC, Y):
        played.tick(node)
    played.cable(w.HEAL_LINK, X, C)
    played.cable(w.CUT_LINK, X, PC)
    world, system = played.twin.world, played.twin.system
    skin_calm.forget_budgets(world)
    world.at[w.FAIR] = 1
    assert system.settle(world)
    settled = []
    for order in ((PC, Y, Q, C, X), (PC, Y, X, C, Q), (PC, Y, X, Q, C), (X, C, Q, Y, PC)):
        for node in order:
            assert system.turn(world, node)
        settled.append(played.is_settled())
    assert settled == [False, False, True, True]
