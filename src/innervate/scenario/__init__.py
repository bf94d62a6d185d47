"""Scenario files: TOML to a validated model, and on to the plan of a run."""

from typing import Any

from innervate.networks.mesh.scenario import planning as mesh_planning
from innervate.networks.mesh.scenario.plan import MeshFault, MeshPlan
from innervate.networks.radio.scenario import planning as radio_planning
from innervate.networks.radio.scenario.plan import RadioFault, RadioPlan
from innervate.networks.skin.scenario.plan import Fault, Plan
from innervate.networks.skin.scenario.plan import plan as skin_planning
from innervate.networks.skin.scenario.touch import Touch
from innervate.scenario.actions.cables import CUT, KILL, LOOSE, LOSE, RESTART, RESTORE, REVIVE
from innervate.scenario.bundled import bundled
from innervate.scenario.check import check, describe, summary
from innervate.scenario.emit import dump, inline
from innervate.scenario.errors import ScenarioError
from innervate.scenario.load import Scenario, from_dict, load, loads, read
from innervate.scenario.templates import measured as measured_template
from innervate.scenario.templates import template

__all__ = [
    "CUT",
    "KILL",
    "LOOSE",
    "LOSE",
    "RESTART",
    "RESTORE",
    "REVIVE",
    "Fault",
    "MeshFault",
    "MeshPlan",
    "Plan",
    "RadioFault",
    "RadioPlan",
    "Scenario",
    "ScenarioError",
    "Touch",
    "bundled",
    "check",
    "describe",
    "dump",
    "from_dict",
    "inline",
    "json_schema",
    "load",
    "loads",
    "measured_template",
    "plan",
    "read",
    "summary",
    "template",
]


def plan(scenario: Scenario) -> Any:
    """The plan of a run, a Plan, RadioPlan or MeshPlan: same scenario and seed, same plan.

    Raises:
        ScenarioError: it cannot be run as written.
    """
    if scenario.kind == "radio":
        return radio_planning.plan(scenario)
    if scenario.kind == "mesh":
        return mesh_planning.plan(scenario)
    return skin_planning(scenario)


def json_schema() -> dict[str, Any]:
    """The JSON Schema of scenario files, for editors."""
    import msgspec

    from innervate.scenario.kinds import KINDS

    models = [kind.model for kind in KINDS.values()]
    schemas, parts = msgspec.json.schema_components(models)
    return {"anyOf": list(schemas), "$defs": parts}
