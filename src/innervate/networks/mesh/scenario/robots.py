"""The robots of a mesh: those of its cluster, which wander within the fence if nothing else is."""

from innervate.networks.mesh.scenario.fence import rings_cm
from innervate.networks.mesh.scenario.model import MeshScenario
from innervate.networks.mesh.scenario.nodes import Nodes
from innervate.scenario import robots
from innervate.topology.placement import Point


def walks(
    model: MeshScenario, nodes: Nodes, points: list[Point], duration_us: int
) -> list[robots.Walk]:
    """The walk of every robot, one that stands still too; points in cm, empty if nobody knows.

    Raises:
        ScenarioError: a robot without a position, or one that changes its way too often.
    """
    here = [(i, robot) for i, robot in enumerate(model.robot) if nodes.is_here(robot.node)]
    around = points or (rings_cm(model.fence)[0] if model.fence is not None else [])
    return robots.walks(here, nodes, robots.Ground(points, around, model.seed, duration_us))
