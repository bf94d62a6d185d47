"""What pages show of any simulated network: its nodes by the fields that they declare."""

from typing import Any, ClassVar

import numpy as np

from innervate.analysis.headline import Headline
from innervate.analysis.spread import spread
from innervate.analysis.summary import headline
from innervate.analysis.ways import reach
from innervate.network import Network, networks
from innervate.plot.happened import event_words
from innervate.scenario.declared.shared import own_events
from innervate.sim.cables.world import DEAD
from innervate.topology import PORTS
from innervate.topology.layout import PITCH_MM, cell_places
from innervate.web.cables import CabledView, Cables
from innervate.web.engine import Engine, Rows
from innervate.web.errors import WatchError
from innervate.web.history import History
from innervate.web.live_view import shown_fields
from innervate.web.view import Memory, View

NODES_MAX = 1_000
DELIVERED = {"id": "delivered", "label": "deliveries so far", "unit": ""}


class Declared(View):
    """Nodes whose protocol is declared, on any medium."""

    speed: ClassVar[float] = 0.1
    slow: ClassVar[float] = 0.05
    series: ClassVar[list[dict[str, Any]]]

    def __init__(self, engine: Engine, history: History) -> None:
        super().__init__(engine, history)
        network = networks()[self.plan.kind]
        self.saves = network.writes_events
        self.shown, self.own = shown_by(network)
        self.memory = Memory()
        self.own_events = own_events(self.plan)

    def note(self, rows: Rows) -> None:
        """Take in what happened since the last call."""
        since_us = self.memory.told_us
        self.tell_faults()
        for at_us, words in self.own_events:
            if since_us <= at_us < self.memory.told_us:
                self.log.say(at_us, words)

    def points(self) -> dict[str, float | None]:
        """A point of every plot, for now."""
        counts = self.engine.running.counts()
        return {"lost": float(sum(counts.lost_by.values())), "delivered": float(counts.delivered)}

    def coloured(self, states: Any) -> dict[str, list[float]]:
        """Per node, every field that they can be coloured by."""
        params = self.engine.world.params.view(np.recarray)[0]
        nodes = states.view(np.recarray)
        own = {name: [float(of(node, params)) for node in nodes]
               for name, (_unit, of) in self.own.items()}  # fmt: skip
        return {one["name"]: own.get(one["name"]) or states[one["name"]].tolist()
                for one in self.shown}  # fmt: skip

    def fields(self, flights: bool) -> dict[str, Any]:
        """The present state; when such a network has recovered nobody has said."""
        return {**super().fields(flights), "recovery": None}

    def headline(self) -> Headline:
        """Is all well, and if not, what is wrong: as in a run's summary."""
        handled = int(self.engine.world.run["handled"][0])
        goes_on = self.engine.now_us < self.plan.duration_us
        return headline(self.engine.running.counts(), handled, goes_on)

    def words(self, fault: Any) -> str:
        """What a fault does, as "node n3 switched off"."""
        return event_words(self.plan, fault)

    def event(self, fault: Any) -> dict[str, Any]:
        """The [[event]] table of a fault, without its time, as the network writes it."""
        found: dict[str, Any] = networks()[self.plan.kind].event(self.plan, fault)
        return found


class DeclaredView(Declared, CabledView):
    """Nodes and cables; who is cut off has no cables that lead to the first node that is on."""

    series: ClassVar[list[dict[str, Any]]] = [
        {"id": "lost", "label": "frames lost so far", "unit": "frames"},
        DELIVERED,
    ]

    def __init__(self, engine: Engine, history: History) -> None:
        super().__init__(engine, history)
        network = networks()[self.plan.kind]
        if not hasattr(self.plan, "graph"):
            raise WatchError(f"a {self.plan.kind} has no cables, and no view of its own")
        if self.plan.graph.cells > NODES_MAX:
            many = f"{self.plan.graph.cells:,} nodes are too many to be drawn"
            raise WatchError(f"{many}; at most {NODES_MAX:,}")
        layouts = network.frames.LAYOUTS if network.has("frames") else ()
        self.graph = self.plan.graph
        self.cables = Cables(self.plan, {kind: name for kind, name, _fields in layouts}, "data")

    def scene(self) -> dict[str, Any]:
        """Nodes, links, and the fields that nodes can be coloured by."""
        nodes = [
            {"id": i, "label": self.graph.label(i), "x": x, "y": y, "role": "node"}
            for i, (x, y) in enumerate(self._places())
        ]
        return {"nodes": nodes, "links": self.cables.scene(), "ports": 0, "fence": None,
                "series": self.series, "fields": self.shown, "recovers": False}  # fmt: skip

    def arrays(self, flights: bool) -> dict[str, Any]:
        """The state's fields for nodes and links."""
        world = self.engine.world
        cells, apart = world.cells[: self.graph.cells], int(np.count_nonzero(self._apart()))
        return {
            "node_up": self._on().astype(np.int64),
            "link_up": self.cables.up(world),
            "unconnected": apart,
            "apart": apart,
            "fields": self.coloured(cells),
            "flights": self.cables.flights(world, self.engine.now_us) if flights else [],
        }

    def _on(self) -> Any:
        """Per node, true while it is not switched off."""
        return self.engine.world.alive[: self.graph.cells] != DEAD

    def _apart(self) -> Any:
        """Per node, true if it is on and no cables lead to the first that is."""
        on, count = self._on(), self.graph.cells
        first = np.zeros(count, np.bool_)
        first[np.flatnonzero(on)[:1]] = True
        a, b = self.cables.node_of[self.cables.ends].T
        up = (self.cables.up(self.engine.world) == 1) & on[a] & on[b]
        live = np.zeros((count, count), np.bool_)
        live[a[up], b[up]] = live[b[up], a[up]] = True
        return on & ~reach(live, first)

    def _places(self) -> list[tuple[float, float]]:
        """Where nodes are drawn: where they lie, or else by who is cabled to whom."""
        if self.graph.patches or len(self.graph.positions):
            return [(x / PITCH_MM, y / PITCH_MM) for x, y in cell_places(self.graph)]
        links = [(a // PORTS, b // PORTS) for a, b in self.cables.ends.tolist()]
        return [(x, y) for x, y in spread(self.graph.cells, links).round(3).tolist()]


def shown_by(network: Network) -> tuple[list[dict[str, str]], dict[str, Any]]:
    """What nodes can be coloured by, and what of it the network has functions for; those first."""
    own = network.shows if network.has("shows") else {}
    more = [{"name": name, "unit": unit, "meaning": " ".join((of.__doc__ or "").split())}
            for name, (unit, of) in own.items()]  # fmt: skip
    return [*more, *shown_fields(network)], own
