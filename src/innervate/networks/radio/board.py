"""A station of a radio team on a board."""

from innervate.live.board import Role, Watched, on_wire
from innervate.networks.radio import frames
from innervate.networks.radio.protocol import fields
from innervate.networks.radio.protocol.constants import CRR

ROLES = (
    Role(
        "radio", "innervate.networks.radio.protocol.practical",
        fields.STATION + fields.PRACTICAL, fields.PARAMS, fields.FRAME, fields.PACKET,
        {CRR: (("slots", 0),), **{kind: on_wire(f) for kind, f in frames.FIELDS.items()}},
        action=fields.ACTION, timers=2,
        parameters="innervate.networks.radio.live.parameters:radio_parameters",
        watched=Watched(
            "radio", "innervate.networks.radio.sim.simulate:simulation", table="stations", node=2
        ),
    ),
)  # fmt: skip
