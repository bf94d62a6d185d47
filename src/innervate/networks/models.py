"""Scenarios of the bundled networks as they are built in code, by the names that users know.

They are the models that files are read into, so that there is one list of keys. Nothing is loaded
from here but by who asks for one of these names.
"""

from innervate.networks.mesh.scenario.model import MeshScenario as Mesh
from innervate.networks.radio.scenario.model import RadioScenario as Radio
from innervate.networks.skin.scenario.model import SkinScenario as Skin

__all__ = ["Skin", "Radio", "Mesh"]  # noqa: RUF022 - as networks are told of
