"""What runs on a board: the protocols, their records, and what of a frame is on the wire."""

from __future__ import annotations

from typing import Any, NamedTuple

from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh.protocol import constants as mesh_const
from innervate.networks.mesh.protocol import csma_fields
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.radio import frames as radio
from innervate.networks.radio.protocol import fields as radio_fields
from innervate.networks.radio.protocol.constants import CRR
from innervate.networks.skin import frames as skin
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.wire.layout import SPARE

MESH_CLASS = 32  # nodes: the smallest capacity class
COUNTED = {"path": "path_len", "body": "length"}  # mesh: how much of an array is used

Declaration = tuple[tuple[str, Any, int, int, str, str], ...]
Kinds = dict[int, tuple[tuple[str, Any], ...]]


class Role(NamedTuple):
    """A node's protocol.

    Attributes:
        entry: the module with the five functions.
        state, params, frame, item: declarations of its records; `item` is what its user hands
            down. CSMA looks into no frame.
        kinds: what a frame of each kind has on the wire: (field, how many: 0 one, a number, or
            the field that says).
        room: actions that its outbox must hold.
        in_ram: 16 KiB hold its code, too.
    """

    entry: str
    state: Declaration
    params: Declaration
    frame: Declaration
    item: Declaration
    kinds: Kinds
    room: int
    in_ram: bool


def _wire(fields: Any) -> tuple[tuple[str, Any], ...]:
    return tuple((name, many) for name, many, _bits, _signed in fields if name != SPARE)


def _mesh_kinds() -> Kinds:
    packet = (*_wire(mesh.COMMON), *COUNTED.items())
    return {mesh_const.ACK: _wire(mesh.HOP_ACK), **dict.fromkeys(mesh.FIELDS, packet)}


# A frame as it is sent.
SKIN_FRAME = tuple(field for field in skin_fields.FRAME if field[0] not in skin_fields.NOTED)

ROLES = {
    "skin": Role(
        "innervate.networks.skin.protocol.cell",
        skin_fields.CELL, skin_fields.PARAMS, SKIN_FRAME, SKIN_FRAME,
        {kind: _wire(fields) for kind, fields in skin.FIELDS.items()}, 12, True,
    ),
    "csma": Role(
        "innervate.networks.mesh.protocol.csma",
        csma_fields.STATION, csma_fields.PARAMS, (), csma_fields.ITEM,
        {}, 4, True,
    ),
    "radio": Role(
        "innervate.networks.radio.protocol.practical",
        radio_fields.STATION + radio_fields.PRACTICAL, radio_fields.PARAMS,
        radio_fields.FRAME, radio_fields.PACKET,
        {CRR: (("slots", 0),), **{kind: _wire(f) for kind, f in radio.FIELDS.items()}}, 16, False,
    ),
    "mesh": Role(
        "innervate.networks.mesh.protocol.node",
        mesh_fields.node(MESH_CLASS), mesh_fields.PARAMS, mesh_fields.FRAME,
        mesh_fields.ITEM, _mesh_kinds(), 32, False,
    ),
}  # fmt: skip
