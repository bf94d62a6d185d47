"""What Wireshark has to know of the radio's frames."""

from innervate.export.dissector import Frames, kinds, lua, meanings
from innervate.networks.radio import frames
from innervate.networks.radio.protocol.constants import CRR, REPORT
from innervate.networks.radio.protocol.fields import FRAME


def dissector() -> Frames:
    """Layouts by type, and how a frame is read."""
    made = kinds(frames.LAYOUTS, meanings(FRAME))
    return Frames(
        f'{{ kinds = {made}, others = {{[{CRR}] = "CR-R or pulse"}} }}',
        lua(__package__),
        {"VERSION": frames.VERSION, "CARRIER": frames.CRR_BYTE, "REPORT": REPORT},
    )
