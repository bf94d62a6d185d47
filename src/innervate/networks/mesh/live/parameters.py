"""Parameters of the router on live links: the profile "ip" [mesh 5]; whole numbers."""

from typing import Any

from innervate.live.errors import LiveError
from innervate.live.parameters import check_parameters
from innervate.networks.mesh.live.stack import CLASSES
from innervate.networks.mesh.protocol.constants import LIST, MONITOR, SEARCH, TABLES
from innervate.networks.mesh.protocol.fields import PARAMS, POINTS, row_bytes
from innervate.networks.mesh.rings import mistake, opened, table

IP: dict[str, int] = {
    "mtu": 127, "mode": TABLES, "discovery": LIST, "failover": SEARCH, "recent": 0,
    "avoid_origin": 0, "on_demand": 0,
    "retry": 1, "reliable": 1, "activation": 0, "told": 0, "hop_acks": 1, "flood_us": 625,
    "transmissions": 3, "ack_us": 5000, "ack_adapt": 1,
    "hop_frames": 16, "gather": 1, "queue": 48, "kept": 32,
    "suspect_us": 2_000_000, "min_rssi": -93, "faint": -92, "poor": -94,
    "jitter_us": 5000, "copies": 2, "listen_us": 50_000, "spread_us": 50_000,
    "collect_us": 200_000, "tick_us": 250_000,
    "period": 8, "period_max": 8, "dead": 20, "dead_step": 4, "guard_us": 0, "standby": 0,
    "jobs": 4, "job_us": 100_000, "job_tries": 3, "e2e_us": 30_000, "e2e_adapt": 1, "e2e_tries": 8,
    "asks": 0, "forget": 240, "monitor": MONITOR, "watch": 0, "lost": 3, "flood": 1, "instances": 3,
    "clear_margin": 20, "predict_ms": 500, "unit_cm": 1, "points": 0, "fence": 0,
}  # fmt: skip
EXTENT_MAX = 23_000  # units: squares of distances stay below 2^29
# They follow from the node's file.
OURS = ("nodes", "width", "row", "told", "points", "px", "py", "after")


def fence_parameters(found: list[list[tuple[int, int]]], where: str = "") -> dict[str, Any]:
    """The corners of a fence as the router has them: the polygon, then its holes.

    Raises:
        LiveError: too many corners, one out of reach, or no area inside; the message begins with
            `where`.
    """
    rings = [opened(ring) for ring in found]
    count = sum(len(ring) for ring in rings)
    if count > POINTS:
        raise LiveError(f"{where}: the fence has {count} corners, more than {POINTS}")
    names = ["fence.polygon", *(f"fence.holes.{i}" for i in range(len(rings) - 1))]
    for name, ring in zip(names, rings, strict=True):
        for x, y in ring:
            if not (0 <= x <= EXTENT_MAX and 0 <= y <= EXTENT_MAX):
                raise LiveError(
                    f"{where}: {name}: corner [{x}, {y}] must be 0 to {EXTENT_MAX} units both "
                    "ways; raise protocol.unit_cm, or move the origin"
                )
    if wrong := mistake(rings, names):
        raise LiveError(f"{where}: {wrong[1]}")
    return table(rings, POINTS)


def mesh_parameters(nodes: int, changes: dict[str, int], where: str = "") -> dict[str, Any]:
    """The router's parameters for a network of so many nodes, with what is to be different.

    That is as `check_parameters` allows it. Memory is no matter here: all others may be
    neighbours, unlike in the class of a board.
    """
    check_parameters(changes, (field for field in PARAMS if field[0] not in OURS), where)
    width = next(size for size in CLASSES if nodes <= size)
    corners = {name: [0] * POINTS for name in ("px", "py", "after")}
    own = {"nodes": nodes, "width": width, "row": row_bytes(width), "places": width}
    made = {**IP, **corners, **own, **changes}
    if "faint" not in changes:
        made["faint"] = min(made["min_rssi"] + 1, 127) if made["discovery"] == LIST else -128
    return made
