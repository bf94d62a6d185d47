"""A station of a radio team on a board."""

from innervate.live.board import Coded, Form, Role, Watched, on_wire
from innervate.networks.radio import frames
from innervate.networks.radio.protocol import fields
from innervate.networks.radio.protocol.constants import CRR, DATA, OPEN, REPORT

CODED = Coded(
    (frames.VERSION, 4), 4,
    (
        Form({DATA: "data", OPEN: "open"}, frames.TURN, has_payload=True),
        Form({REPORT: "report"}, frames.MINISLOTS),
    ),
    frames.REASONS, max(frames.SIZES.values()), alone=(frames.CRR_BYTE, CRR, {"slots": 1}),
    payload_max="innervate.networks.radio.board:payload_max",
)  # fmt: skip


def payload_max(params: dict[str, int]) -> int:
    """Bytes of the packets in a frame at most; each has two of a CRC on the air."""
    return min(frames.PAYLOAD_MAX, params["per_turn"] * (params["packet_slots"] - 2))


ROLES = (
    Role(
        "radio", "innervate.networks.radio.protocol.practical",
        fields.STATION + fields.PRACTICAL, fields.PARAMS, fields.FRAME, fields.PACKET,
        {CRR: (("slots", 0),), **{kind: on_wire(f) for kind, f in frames.FIELDS.items()}},
        room=8, action=fields.ACTION, frames=3, timers=2, coded=CODED, driver="station",
        parameters="innervate.networks.radio.live.parameters:radio_parameters",
        watched=Watched(
            "radio", "innervate.networks.radio.sim.simulate:simulation", table="stations", node=2
        ),
    ),
)  # fmt: skip
