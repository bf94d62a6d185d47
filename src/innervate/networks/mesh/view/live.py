"""A running mesh on the page: who hears whom, who reaches the gateway."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from innervate.analysis.headline import Headline
from innervate.analysis.ways import NOWHERE
from innervate.networks.mesh.analysis.headline import headline
from innervate.networks.mesh.analysis.reach import Choices, Ways, ways
from innervate.web.live_map import Link, Map, Place, Status
from innervate.web.live_scene import Drawn
from innervate.web.live_state import State
from innervate.web.live_view import LiveView


class MeshMap(Map):
    """Nodes and who of them hears whom."""

    def key(self, what: Link | Place) -> tuple[Any, ...]:
        """Two nodes hear each other, or not; the paths of a link come and go."""
        return what[:2]

    def find_links(self, told: Mapping[int, Status]) -> list[Link]:
        """Neighbours that hear each other, at least one way."""
        places = self.numbered(told)
        ports: dict[tuple[Place, Place], tuple[int, ...]] = {}
        for i, one in told.items():
            for near in one["neighbours"]:
                if near["node"] in places:
                    ports[Place(i, -1), places[near["node"]]] = tuple(near["ports"])
        pairs = {(min(pair), max(pair)) for pair in ports if pair[0] != pair[1]}
        return [Link(a, b, ports.get((a, b), ()), ports.get((b, a), ())) for a, b in pairs]


class MeshState(State):
    """Which nodes reach their gateway."""

    def look(self) -> tuple[int, int, int]:
        """Find everybody's way anew: (how many have none, of these are astray, could have one)."""
        self.ways = self._find_ways()
        self.hop, self.depth = self.ways.hop, self.ways.depth
        without = self.ways.without & (self.node_up == 1)
        found = without, self.ways.astray, self.ways.served
        none, astray, could = (int(np.count_nonzero(who)) for who in found)
        return none, astray, could

    def judge(self) -> Headline:
        """The headline by the ways that `look` found; who is off is called silent."""
        return headline(self.ways, absent="silent")

    def _find_ways(self) -> Ways:
        """Who reaches its gateway, by what the nodes say of each other."""
        places, count = self.map.places, len(self.map.places)
        numbered = self.map.numbered(self.told).items()
        place_of: dict[Any, int] = {name: self.map.number[at] for name, at in numbered}
        on = np.array([place.node in self.told for place in places], np.bool_)
        said = [self.told.get(place.node, {}) for place in places]
        onward = [
            [place_of[who] for who in one.get("onward", ()) if who in place_of] for one in said
        ]
        wide = max(1, *map(len, onward))
        near = np.zeros((count, count), np.bool_)
        for at, one in enumerate(said):
            to = [place_of.get(other["node"], at) for other in one.get("neighbours", ())]
            near[at, to] = True
        known = Choices(
            gateway=np.array([place_of.get(one.get("gateway"), NOWHERE) for one in said]),
            named=np.array([row + [NOWHERE] * (wide - len(row)) for row in onward]),
            neighbours=near,
            goes_back=all(one.get("gives_back", True) for one in said),
        )
        leads = np.array([one.get("role") == "gateway" for one in said], np.bool_)
        return ways(known, self.live(), on, ~on, leads)

    def more(self) -> dict[str, Any]:
        """Ways, and who has none though links could give one."""
        return {
            "parent": self.hop,
            "depth": self.depth,
            "way": self.ways.lacks,
            "apart": int(self.ways.cut_off.sum()),
        }


class MeshLiveView(LiveView):
    """What the page shows of nodes of a mesh that are processes."""

    map = MeshMap
    state = MeshState

    def drawn(self, plan: Any) -> Drawn:
        """Nodes where the scenario has them, and the fence."""
        from innervate.networks.mesh.view.scene import Field

        scene = Field(plan).scene()
        names = [f"n{i}" for i in range(plan.nodes)]
        return Drawn(
            name=plan.scenario.name,
            places={
                name: (one["x"], one["y"]) for name, one in zip(names, scene["nodes"], strict=True)
            },
            labels={name: own for name, own in zip(names, plan.names, strict=True) if name != own},
            fence=scene["fence"],
            metres=bool(scene["metres"]),
        )
