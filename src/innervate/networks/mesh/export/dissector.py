"""What Wireshark has to know of the mesh's frames."""

from __future__ import annotations

from innervate.export.dissector import Frames, fields_of, kinds, lua, meanings
from innervate.networks.mesh import frames, payloads
from innervate.networks.mesh.meanings import MEANINGS
from innervate.networks.mesh.protocol import constants as words
from innervate.networks.mesh.protocol.fields import FRAME

FLAGS = (
    (words.ACK_WANTED, "ack wanted"),
    (words.END_TO_END, "end-to-end ack"),
    (words.FLOOD, "flood"),
    (words.SOURCE_ROUTE, "source route"),
    (words.DETOURED, "detoured"),
    (words.PRIORITY, "priority"),
    (words.FIRST, "first after boot"),
    (words.PARITY, "parity of the retry"),
)


def dissector() -> Frames:
    """Layouts by type, and how a frame is read."""
    says = meanings(FRAME)
    layouts = (
        f"{{ kinds = {kinds(payloads.LAYOUTS, MEANINGS)},\n"
        f'  others = {{[{words.ACK}] = "ack"}},\n'
        f"  common = {fields_of(frames.COMMON, says)},\n"
        f"  ack = {fields_of(frames.HOP_ACK, says)} }}"
    )
    constants = {
        "VERSION": frames.VERSION,
        "ACK": words.ACK,
        "ACK_BYTES": words.ACK_BYTES,
        "PATH_MAX": words.PATH_MAX,
        "SOURCE_ROUTE": words.SOURCE_ROUTE,
        "DETOURED": words.DETOURED,
        "FLAGS": "{" + ", ".join(f'{{{bit}, "{name}"}}' for bit, name in FLAGS) + "}",
    }
    return Frames(layouts, lua(__package__), constants)
