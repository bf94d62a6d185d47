"""Parameters of the protocols on live links: the profile "ip" [mesh 5]; whole numbers."""

from __future__ import annotations

from typing import Any

from innervate.live.errors import LiveError
from innervate.live.mesh import CLASSES
from innervate.protocol import skin_fields
from innervate.protocol.mesh_fields import NEIGHBOURS, PARAMS, POINTS, words
from innervate.protocol.mesh_words import LIST, MONITOR, SEARCH, TABLES
from innervate.protocol.skin_words import RULE_FEASIBLE, WAVE

IP: dict[str, int] = {
    "mtu": 127, "mode": TABLES, "discovery": LIST, "failover": SEARCH, "avoid_origin": 0,
    "retry": 1, "reliable": 1, "activation": 0, "told": 0, "transmissions": 3, "ack_us": 5000,
    "suspect_us": 2_000_000, "min_rssi": -93, "jitter_us": 5000, "copies": 2,
    "listen_us": 50_000, "spread_us": 50_000, "collect_us": 200_000, "tick_us": 250_000,
    "period": 8, "period_max": 8, "dead": 20, "dead_step": 4, "standby": 0, "jobs": 4,
    "job_us": 100_000, "job_tries": 3, "e2e_us": 30_000, "e2e_adapt": 1, "e2e_tries": 5,
    "forget": 120, "monitor": MONITOR, "watch": 0, "lost": 3, "flood": 1, "instances": 3,
    "clear_margin": 20, "predict_ms": 500, "unit_cm": 1, "points": 0, "fence": 0,
}  # fmt: skip


# A skin at 50 Hz; a port is broken after five silent periods [skin 5].
SKIN: dict[str, int] = {
    "rule": RULE_FEASIBLE, "updates": WAVE, "beacon_us": 20_000, "r_f": 168, "r_r": 168, "k": 5,
    "max_depth": 64, "seq_every": 5, "balance_periods": 64, "hold_periods": 133, "gap_us": 500,
    "skip_us": 12_000, "restart_us": 0, "forward_min_us": 0, "forward_max_us": 0,
}  # fmt: skip
RANGES = {name: (low, high, unit) for name, _, low, high, unit, _ in PARAMS}
SKIN_RANGES = {name: (low, high, unit) for name, _, low, high, unit, _ in skin_fields.PARAMS}
OURS = ("nodes", "width", "row", "told")  # follow from the node's file


def mesh_parameters(nodes: int, changes: dict[str, int], where: str = "") -> dict[str, Any]:
    """The router's parameters for a network of so many nodes, with what is to be different.

    Raises:
        LiveError: no such parameter, or out of its range; the message begins with `where`.
    """
    _check(changes, {name: RANGES[name] for name in RANGES if name not in OURS}, where)
    width = next(size for size in CLASSES if nodes <= size)
    corners = {name: [0] * POINTS for name in ("px", "py", "after")}
    own = {"nodes": nodes, "width": width, "row": words(width), "places": min(width, NEIGHBOURS)}
    return {**IP, **corners, **own, **changes}


def skin_parameters(changes: dict[str, int], where: str = "") -> dict[str, int]:
    """The skin's parameters, with what is to be different.

    Raises:
        LiveError: see mesh_parameters().
    """
    _check(changes, SKIN_RANGES, where)
    return {**SKIN, **changes}


def _check(changes: dict[str, int], ranges: dict[str, tuple[int, int, str]], where: str) -> None:
    for name, value in changes.items():
        if name not in ranges:
            raise LiveError(f"{where}: protocol.{name} is unknown; it knows {', '.join(ranges)}")
        low, high, unit = ranges[name]
        if not low <= value <= high:
            raise LiveError(f"{where}: protocol.{name} = {value} must be {low} to {high} {unit}")
