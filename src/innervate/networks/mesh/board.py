"""A node of a mesh on a board, and the access protocol below it."""

from functools import partial
from typing import Any

from innervate.live.board import Coded, Declaration, Form, Role, Watched, on_wire, only
from innervate.live.errors import LiveError
from innervate.live.parameters import check_parameters
from innervate.networks.mesh import frames, payloads
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import CLASSES
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol import csma_fields, fields
from innervate.wire.layout import REST

# Acks to as many as are gathered; a whole queue, and what is handed up.
FRAME_BYTES = fields.GATHERED * 38 + (fields.QUEUE + 2) * 152
NODES = 32  # the smallest capacity class
COUNTED = {"path": "path_len", "body": "length"}
PACKET = (*on_wire(frames.COMMON), *COUNTED.items())
BODY_OF = ("body", REST, 8, 0)
CODED = Coded(
    (frames.VERSION, 2), 6,
    (
        Form({const.ACK: "ack"}, (*frames.HOP_ACK, BODY_OF), {"body": (const.BODY, "length")},
             "length", const.ACK_MORE_BYTES, same={"dest": "link_dst"}),
        Form(payloads.NAMES, (*frames.COMMON, ("path", "path_len", 8, 0), BODY_OF),
             {"path": (const.PATH_MAX, "path"), "body": (const.BODY, "length")}, "length",
             payloads=payloads.FIELDS),
    ),
    frames.REASONS, const.MTU, const.SOURCE_ROUTE, const.DETOURED,
)  # fmt: skip
RUN = Watched("mesh", "innervate.networks.mesh.sim.simulate:simulation", node=3)
HERE = "innervate.networks.mesh.board"
# Of IEEE 802.15.4 at 250 kbit/s: 20 symbols.
WAITS = {"backoff_us": 320, "exponent_min": 3, "exponent_max": 6, "busy_max": 8}


def csma_parameters(changes: dict[str, int], where: str = "") -> dict[str, int]:
    """A station's parameters, with what is to be different, as `check_parameters` allows it."""
    check_parameters(changes, csma_fields.PARAMS, where)
    return {**WAITS, **changes}


def node_parameters(nodes: int, changes: dict[str, int], where: str = "") -> dict[str, Any]:
    """A node's parameters, with what is to be different; `nodes` is how many its arrays hold.

    Raises:
        LiveError: no such parameter, out of its range, or more nodes than fit.
    """
    small = {"queue": fields.QUEUE, "kept": fields.WAITING, "hop_frames": 4}
    wanted = {**small, **changes}
    count = wanted.pop("nodes", nodes)
    if not 1 <= count <= nodes:
        raise LiveError(f"{where}: {count} nodes do not fit into a class of {nodes}")
    if count <= wanted.get("monitor", const.MONITOR) < const.MONITOR:
        raise LiveError(f"{where}: monitor={wanted['monitor']} is none of {count} nodes")
    for name in ("queue", "kept"):
        if wanted[name] > small[name]:
            raise LiveError(
                f"{where}: {name}={wanted[name]} does not fit into {small[name]} places"
            )
    if wanted.get("mtu", const.MTU) > const.MTU:
        raise LiveError(f"{where}: mtu={wanted['mtu']} is more than a board's {const.MTU} bytes")
    own = {"width": nodes, "row": fields.row_bytes(nodes), "places": fields.places(nodes)}
    return {**mesh_parameters(count, wanted, where), **own}


small_parameters, middle_parameters, wide_parameters, large_parameters = (
    partial(node_parameters, size) for size in CLASSES
)
OF_CLASS = dict(zip(CLASSES, ("small", "middle", "wide", "large"), strict=True))
USUAL = tuple(
    {"nodes": size, "protocol": {"mtu": mtu}}
    for size in CLASSES
    for mtu in (const.MTU, const.MTU_MAX)
)

CSMA = Role(
    "csma", "innervate.networks.mesh.protocol.csma",
    csma_fields.STATION, csma_fields.PARAMS, (), csma_fields.ITEM, {},
    room=4, in_ram=True, driver="", action=csma_fields.ACTION, timers=1,
    watched=RUN._replace(table="macs"),
    parameters=f"{HERE}:csma_parameters",
)  # fmt: skip


def _state(size: int, queue: int, kept: int, mtu: int, most: int) -> Declaration:
    """What a node of this capacity class keeps, with room for so many frames and messages."""
    rooms = {"q_room": fields.room(mtu), "wait_room": fields.wait_room(mtu)}
    declared = fields.node(size, queue, kept, mtu, most)
    return only(declared, {"places": queue, "kept": kept, **rooms})


def _params(size: int, queue: int, kept: int, most: int) -> Declaration:
    """What all nodes of this class have in common: how much each has room for."""
    sizes = {"width": size, "row": fields.row_bytes(size), "places": most or fields.places(size)}
    return only(fields.PARAMS, {**sizes, "queue": queue, "kept": kept})


def node(nodes: int) -> Role:
    """A node of a network of up to so many: of the smallest capacity class that holds them.

    Raises:
        LiveError: there is none.
    """
    size = next((size for size in CLASSES if nodes <= size), 0)
    if nodes < 1 or not size:
        raise LiveError(f"{nodes} nodes: a node's arrays hold 1 to {CLASSES[-1]}")
    return Role(
        "mesh", "innervate.networks.mesh.protocol.node",
        _state(size, fields.QUEUE, fields.WAITING, const.MTU, 0),
        _params(size, fields.QUEUE, fields.WAITING, 0), fields.FRAME, fields.ITEM,
        {const.ACK: on_wire(frames.HOP_ACK), **dict.fromkeys(payloads.FIELDS, PACKET)},
        room=32, counted=COUNTED, gate=fields.gate(size), action=fields.ACTION, timers=const.TIMERS,
        nodes=size, sized=f"{HERE}:node", parameters=f"{HERE}:{OF_CLASS[size]}_parameters",
        made_in=("recent", "on_demand"),
        watched=RUN._replace(table="nodes"), coded=CODED, frame_bytes=FRAME_BYTES,
        hooks="innervate.networks.mesh:board_links", live=f"{HERE}:live_node", usual=USUAL,
    )  # fmt: skip


def live_node(params: Any) -> Role:
    """A node with the queue, the frames and the neighbours that a live one has."""
    size, mtu, most = params.width, params.mtu, params.places
    room, ack, packet = fields.room(mtu), CODED.forms[0], CODED.forms[1]
    body = {"body": (room, "length")}
    forms = (ack._replace(most=body), packet._replace(most={**packet.most, **body}))
    return node(size)._replace(
        state=_state(size, params.queue, params.kept, mtu, most),
        params=_params(size, params.queue, params.kept, most),
        gate=fields.gate(size, most), frame=fields.frame(mtu), item=fields.item(mtu),
        coded=CODED._replace(forms=forms, size_max=mtu),
    )  # fmt: skip


ROLES = (CSMA, node(NODES))
