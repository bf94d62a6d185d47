"""The kinds of scenarios: what the tables of each are, and what they must fulfil together."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from innervate.networks.mesh.scenario import rules as mesh_rules
from innervate.networks.mesh.scenario.model import MeshScenario
from innervate.networks.radio.scenario import rules as radio_rules
from innervate.networks.radio.scenario.model import RadioScenario
from innervate.networks.skin.scenario import rules
from innervate.networks.skin.scenario.model import SkinScenario
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
