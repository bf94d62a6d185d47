"""Whether a reduced search leaves nothing out: every state of the whole one has to be covered."""

from dataclasses import replace
from functools import cached_property
from itertools import product

import numpy as np

from innervate.networks.skin.protocol.constants import INFINITY
from innervate.networks.skin.verify import calm as skin_calm
from innervate.networks.skin.verify import check as skin_check
from innervate.networks.skin.verify import retrace
from innervate.networks.skin.verify import row as skin_row
from innervate.networks.skin.verify import system as skin_system
from innervate.networks.skin.verify import world as w
from innervate.verify import explore
from innervate.verify.twin import Twin


class Cover:
    """The reduced search of a model, beside the whole one; with `any_ticks` the reduced one lets
    cells tick as often as it takes.
    """

    def __init__(self, model, plain=False, any_ticks=False):
        self.lean = model.changed(lean=True, capacity=model.layout().capacity)
        if any_ticks:
            self.lean = self.lean.changed(budget=replace(model.budget, ticks=skin_system.ANY))
        self.whole_result = explore.explore(model, plain=plain)
        self.lean_result = explore.explore(self.lean, plain=plain)
        self.lay = self.lean.layout()
        self.twin = Twin(self.lean, skin_system.system_of())
        body = self.lay.body()
        self.same = [i for i, mask in enumerate(body) if mask]
        self.more = [i for i, mask in enumerate(body) if not mask]
        self.played = {}
        self.kept = self.rows(self.lean_result)
        self.wanted = {self.tidied(row) for row in self.rows(self.whole_result)}

    def rows(self, result):
        """The states of a search as bytes."""
        data, width = bytes(memoryview(result.rows).cast("B")), self.lay.width
        return [data[at : at + width] for at in range(0, len(data), width)]

    def tidied(self, row):
        """A state as the reduced search would keep it."""
        return retrace.reduced(self.twin, row)

    def later(self, row, order):
        """What follows a state when nothing fails any more: two rounds of ticks in this order.

        States, and the periods that cells which cables connect to the PC had no route for.
        """
        self.twin.put(row)
        skin_calm.forget_budgets(self.twin.world)
        calm = self.twin.row(), tuple(order)
        if calm not in self.played:
            self.played[calm] = set(self.played_out(*calm))
        return self.played[calm]

    def played_out(self, row, order):
        """What follows a calm state, for each way in which draws can turn out."""
        world, system = self.twin.world, self.twin.system
        world.at[w.FAIR] = 1
        skin_calm.draw_first(world)
        is_open = True
        while is_open:
            self.twin.put(row)
            assert system.settle(world)
            for node in 2 * order:
                assert system.turn(world, node)
            skin_check.measure_depths(world)
            holds = [
                world.work[at + w.HOLD] if world.depth[c] < INFINITY else 0
                for c, at in enumerate(self.lay.cell_at)
            ]
            yield self.tidied(self.twin.row()), *holds
            is_open = skin_calm.draw_otherwise(world)
        world.at[w.FAIR] = 0

    def is_followed(self, order):
        """Whether both searches lead to the same in two rounds, but for periods without a route:
        the reduced one knows them to within those that there may have been before.
        """
        most = self.lay.settings()[w.HELD] - 1
        follows = set()
        for row in self.kept:
            for state, *holds in self.later(row, order):
                for more in product(*(range(1 + most * (hold > 0)) for hold in holds)):
                    follows.add((state, *map(sum, zip(holds, more, strict=True))))
        return all(self.later(row, order) <= follows for row in self.rows(self.whole_result))

    def may(self, row):
        """How much may still happen in a state."""
        return bytes(row[i] for i in self.more)

    def missing(self):
        """Tidied states of the whole search that nothing in the reduced one covers.

        A kept state covers one if it allows as much of everything and, held to what that one
        allows, is the same.
        """
        known = set(self.kept)
        wanted = {}
        for row in self.wanted - known:
            wanted.setdefault(self.may(row), set()).add(row)
        return [row for may, rows in wanted.items() for row in rows - self.held_to(may)]

    def held_to(self, may):
        """The kept states that allow at least this much, allowing just this much."""
        least = np.frombuffer(may, np.uint8)
        allowing = self.mirrored[(self.mirrored[:, self.more] >= least).all(axis=1)]
        allowing[:, self.more] = least
        return {self.tidied(image) for image in {row.tobytes() for row in allowing}}

    @cached_property
    def mirrored(self):
        """The kept states and their mirror images, a row of bytes each."""
        images = np.array(self.lay.images()).reshape(-1, self.lay.width)
        kept = np.frombuffer(b"".join(self.kept), np.uint8).reshape(-1, self.lay.width)
        return kept[:, images].reshape(-1, self.lay.width)

    def is_faithful(self):
        """Whether both searches see the same; the reduced one more where the whole one, with
        more in flight, had no room.
        """
        whole, lean = self.seen(self.wanted), self.seen(map(self.tidied, self.kept))
        return whole == lean if self.whole_result.tally.left_out == 0 else whole <= lean

    def seen(self, rows):
        """Parents, feasible distances and cables of all states and their mirror images."""
        images, width = self.lay.images(), self.lay.width
        picked = [[images[g + i] for i in self._looked_at()] for g in range(0, len(images), width)]
        parts = [(i, mask) for i, mask in self._masks().items()]
        return {
            tuple(row[place] & mask for place, (_, mask) in zip(places, parts, strict=True))
            for row in rows
            for places in picked
        }

    def _looked_at(self):
        return list(self._masks())

    def _masks(self):
        lay, found = self.lay, {}
        feasible = 255 if self.lean.rule == "feasible" else 0
        for at in lay.cell_at:
            found |= {at + w.FLAGS: feasible & skin_row.FD_KNOWN}
            found |= {at + w.FD_SQ: feasible, at + w.FD_DIST: feasible}
        found |= {at + w.SAYS: skin_row.IS_PARENT for at in lay.port_at if at >= 0}
        return found | {at: 255 for at in range(lay.link_at, lay.budget_at)}
