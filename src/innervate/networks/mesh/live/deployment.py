"""Node files of a mesh's plan, and its robots on their way."""

from collections.abc import Coroutine
from typing import Any

from innervate.live.deployment import Pairs, Stage, Table
from innervate.live.in_field import FieldDeployment
from innervate.networks.mesh.live import walks
from innervate.networks.mesh.rings import of_table

# They follow from the file itself, stand in its [fence], or are of live links and no simulation.
NOT_IN_FILES = ("nodes", "width", "row", "told", "places", "points", "px", "py", "after",
                "ack_adapt", "hop_frames", "gather", "queue", "kept")  # fmt: skip


class MeshDeployment(FieldDeployment):
    """The nodes of a mesh; a cable for every good link."""

    no_serial = "--pty joins the cells of a skin; mesh nodes take --netns or UDP"
    no_link = "no cable joins {a} and {b}; name a good link"

    def layout(self) -> tuple[list[str], Pairs]:
        """Nodes by number; links that are good at the start, whoever moves."""
        return [f"n{i}" for i in range(self.plan.nodes)], list(self.plan.good)

    def file(self, number: int, cables: list[int]) -> tuple[Table, dict[str, Table]]:
        """The head of a node's file, and its tables."""
        plan, rank = self.plan, self.plan.ranks[number]
        head: Table = {"nodes": plan.nodes}
        head["role"] = "node" if rank < 0 else "gateway" if rank == 0 else "standby"
        if rank > 0:
            head["rank"] = rank
        if plan.robots[number]:
            head["robot"] = True
        tables = {"protocol": {k: v for k, v in plan.params.items() if k not in NOT_IN_FILES}}
        rings = [[list(corner) for corner in ring] for ring in of_table(plan.params)]
        if rings:
            tables["fence"] = {"polygon": rings[0], "holes": rings[1:]}
        return head, tables

    def others(self, stage: Stage) -> list[Coroutine[Any, Any, None]]:
        """Robots say where they are; that has no end."""
        plan = self.plan
        return [walks.walk(plan, walk, stage.socket(self.names[walk.node])) for walk in plan.walks]
