"""Scenario files: TOML to a validated model, and on to the plan of a run."""

from typing import Any

from innervate.scenario.bundled import bundled
from innervate.scenario.check import check, describe
from innervate.scenario.emit import dump
from innervate.scenario.errors import ScenarioError
from innervate.scenario.load import Scenario, from_dict, load, loads
from innervate.scenario.plan import (
    CUT,
    KILL,
    LOOSE,
    LOSE,
    RESTART,
    RESTORE,
    REVIVE,
    Fault,
    Plan,
    plan,
)
from innervate.scenario.templates import template
from innervate.scenario.touch import Touch

__all__ = [
    "CUT",
    "KILL",
    "LOOSE",
    "LOSE",
    "RESTART",
    "RESTORE",
    "REVIVE",
    "Fault",
    "Plan",
    "Scenario",
    "ScenarioError",
    "Touch",
    "bundled",
    "check",
    "describe",
    "dump",
    "from_dict",
    "json_schema",
    "load",
    "loads",
    "plan",
    "template",
]


def json_schema() -> dict[str, Any]:
    """The JSON Schema of scenario files, for editors."""
    import msgspec

    from innervate.scenario.model import SkinScenario

    return msgspec.json.schema(SkinScenario)
