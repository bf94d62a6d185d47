"""The kinds of scenarios: what the tables of each are, and what they must fulfil together."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from innervate.scenario import mesh_rules, radio_rules, rules
from innervate.scenario.mesh_model import MeshScenario
from innervate.scenario.model import SkinScenario
from innervate.scenario.radio_model import RadioScenario
from innervate.scenario.source import Source

Model = SkinScenario | RadioScenario | MeshScenario


class Kind(NamedTuple):
    """A kind: its model, and a check that raises ScenarioError."""

    model: type[Model]
    check: Callable[[Source, Any], None]


KINDS = {
    "skin": Kind(SkinScenario, rules.check),
    "radio": Kind(RadioScenario, radio_rules.check),
    "mesh": Kind(MeshScenario, mesh_rules.check),
}
