"""What Wireshark has to know of the mesh's frames."""

from innervate.export.dissector import Frames, fields_of, kinds, lua, meanings
from innervate.networks.mesh import frames, payloads
from innervate.networks.mesh.meanings import MEANINGS
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol.fields import FRAME
from innervate.wire.layout import width

FLAGS = (
    (const.ACK_WANTED, "ack wanted"),
    (const.END_TO_END, "end-to-end ack"),
    (const.FLOOD, "flood"),
    (const.SOURCE_ROUTE, "source route"),
    (const.DETOURED, "detoured"),
    (const.PRIORITY, "priority"),
    (const.FIRST, "first after boot, or over a faint link"),
    (const.PARITY, "parity of the retry"),
)
PIECE = 64  # stands for what no packet's type is: data that is a piece of a message


def dissector() -> Frames:
    """Layouts by type, and how a frame is read."""
    says = meanings(FRAME) | {"more": "other packets that came from the same hop"}
    layouts = (
        f"{{ kinds = {kinds((*payloads.LAYOUTS, (PIECE, 'piece', payloads.PIECE)), MEANINGS)},\n"
        f'  others = {{[{const.ACK}] = "ack"}},\n'
        f"  common = {fields_of(frames.COMMON, says)},\n"
        f"  ack = {fields_of(frames.HOP_ACK + frames.MORE, says)} }}"
    )
    constants = {
        "VERSION": frames.VERSION,
        "ACK": const.ACK,
        "DATA": const.DATA,
        "ORDERED": const.ORDERED,
        "PIECE": PIECE,
        "PIECE_AHEAD": payloads.PIECE_AHEAD,
        "PIECE_BYTES": width(payloads.PIECE) // 8,
        "ACK_BYTES": const.ACK_BYTES,
        "PATH_MAX": const.PATH_MAX,
        "SOURCE_ROUTE": const.SOURCE_ROUTE,
        "DETOURED": const.DETOURED,
        "FLAGS": "{" + ", ".join(f'{{{bit}, "{name}"}}' for bit, name in FLAGS) + "}",
    }
    return Frames(layouts, lua(__package__), constants)
