"""The field of a mesh: who is where, which links there are, the fence. Metres, y down."""

from typing import Any

import numpy as np

from innervate.networks.mesh.plot.map import monitor_of
from innervate.networks.mesh.plot.sheet import WIDTH, is_to_scale, laid_out
from innervate.networks.mesh.scenario.plan import ONE
from innervate.networks.mesh.scenario.profiles import GOOD_CDB
from innervate.sim.field.states import ALIVE
from innervate.web.field_view import Links

Numbers = np.ndarray[Any, np.dtype[np.int64]]


class Field:
    """The field of a plan, as pages draw it."""

    def __init__(self, plan: Any) -> None:
        self.plan = plan
        self.walks = bool(plan.walks) and is_to_scale(plan, WIDTH)  # somebody moves
        moving = {walk.node for walk in plan.walks} if self.walks else set()
        self._links = Links(plan.nodes, plan.good, moving)
        self.pairs = self._links.pairs
        true_places = is_to_scale(plan, WIDTH)
        self._to_scale = true_places
        places = plan.positions_cm if true_places else laid_out(plan)
        self._places = np.array(places, np.float64).reshape(-1, 2) * (0.01, -0.01)

    def scene(self) -> dict[str, Any]:
        """Nodes, links and fence of a scene."""
        plan = self.plan
        chance = np.array(plan.radio.prob_q15).reshape(plan.nodes, plan.nodes) / ONE
        places = self._places.round(3).tolist()
        nodes = [
            {"id": i, "label": plan.names[i], "x": x, "y": y, "role": self._role(i)}
            for i, (x, y) in enumerate(places)
        ]
        links = [
            {"id": i, "a": a, "b": b, "quality": round(float(min(chance[a, b], chance[b, a])), 3)}
            for i, (a, b) in enumerate(self.pairs)
        ]
        return {
            "nodes": nodes, "links": links, "fence": self._fence(), "metres": self._to_scale,
            **self._part(),
        }  # fmt: skip

    def _part(self) -> dict[str, str]:
        """Which of several clusters this is; nothing of a whole network."""
        of = self.plan.cluster
        if of is None:
            return {}
        sizes = of.sizes
        return {"part": f"cluster {of.number} of {len(sizes)}, {sum(sizes):,} nodes in all"}

    def _role(self, node: int) -> str:
        plan = self.plan
        if plan.robots[node]:
            return "robot"
        if plan.ranks[node] >= 0:
            return "standby" if plan.ranks[node] else "gateway"
        watched = bool(plan.walks or plan.params["points"])
        return "monitor" if watched and monitor_of(plan) == node else "node"

    def _fence(self) -> list[list[list[float]]] | None:
        table = self.plan.scenario.model.fence
        if table is None:
            return None
        return [[[x, -y] for x, y in ring] for ring in (table.polygon, *table.holes)]

    def link_up(self, world: Any) -> Numbers:
        """UP, DOWN or AWAY for every link."""
        found: Numbers = self._links.up(
            world, world.radios["state"] == ALIVE, self.plan.radio.rssi50_cdb + GOOD_CDB
        )
        return found

    def positions(self, world: Any) -> Any:
        """Where all nodes are now: (n, 2), metres, y downwards."""
        radios = world.radios
        return (np.stack([radios["x"], -radios["y"]], axis=1) / 100).round(2)
