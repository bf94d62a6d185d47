"""A cell of the skin on a board."""

from innervate.live.board import Emulated, Program, Role, Watched, on_wire
from innervate.networks.skin import frames
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.protocol.constants import BEACON, TIMERS

# A frame as it is sent.
FRAME = tuple(field for field in fields.FRAME if field[0] not in fields.NOTED)

ROLES = (
    Role(
        "skin", "innervate.networks.skin.protocol.cell", fields.CELL, fields.PARAMS, FRAME, FRAME,
        {kind: on_wire(layout) for kind, layout in frames.FIELDS.items()},
        room=12, in_ram=True, noted=fields.NOTED, action=fields.ACTION, frames=4, timers=TIMERS,
        watched=Watched(
            "skin",
            "innervate.networks.skin.sim.simulate:simulation",
            "innervate.networks.skin.sim.stack:on_frame",
            node=4,
        ),
        # Commands of the PC do not fit beside the rest.
        emulated=Emulated(("hand_down", "accept_command"), BEACON),
        program=Program(
            "main",
            ("outbox", "driver", "cell"),
            (
                "networks/skin/protocol/constants", "networks/skin/frames",
                "wire/bits", "wire/crc", "wire/layout", "wire/cobs",
            ),
        ),
        parameters="innervate.networks.skin.live.parameters:skin_parameters",
        usual=({"role": "cell"},),
    ),
)  # fmt: skip
