"""A node of a mesh on a board, and the access protocol below it."""

from innervate.live.board import Role, Watched, on_wire
from innervate.networks.mesh import frames, payloads
from innervate.networks.mesh.protocol import csma_fields, fields
from innervate.networks.mesh.protocol.constants import ACK

NODES = 32  # the smallest capacity class
COUNTED = {"path": "path_len", "body": "length"}
PACKET = (*on_wire(frames.COMMON), *COUNTED.items())
RUN = Watched("mesh", "innervate.networks.mesh.sim.simulate:simulation", node=3)

ROLES = (
    Role(
        "csma", "innervate.networks.mesh.protocol.csma",
        csma_fields.STATION, csma_fields.PARAMS, (), csma_fields.ITEM, {},
        room=4, in_ram=True, watched=RUN._replace(table="macs"),
    ),
    Role(
        "mesh", "innervate.networks.mesh.protocol.node",
        fields.node(NODES), fields.PARAMS, fields.FRAME, fields.ITEM,
        {ACK: on_wire(frames.HOP_ACK), **dict.fromkeys(payloads.FIELDS, PACKET)},
        room=32, counted=COUNTED, has_gate=True, watched=RUN._replace(table="nodes"),
    ),
)  # fmt: skip
