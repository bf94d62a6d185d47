"""Parameters of the protocols on live links: the profile "ip" [mesh 5]; whole numbers."""

from __future__ import annotations

from typing import Any

from innervate.live.errors import LiveError
from innervate.live.mesh import CLASSES
from innervate.protocol import radio_fields, skin_fields
from innervate.protocol.mesh_fields import NEIGHBOURS, PARAMS, POINTS, words
from innervate.protocol.mesh_words import LIST, MONITOR, SEARCH, TABLES
from innervate.protocol.skin_words import RULE_FEASIBLE, WAVE

IP: dict[str, int] = {
    "mtu": 127, "mode": TABLES, "discovery": LIST, "failover": SEARCH, "avoid_origin": 0,
    "retry": 1, "reliable": 1, "activation": 0, "told": 0, "hop_acks": 1, "flood_us": 625,
    "transmissions": 3, "ack_us": 5000,
    "suspect_us": 2_000_000, "min_rssi": -93, "jitter_us": 5000, "copies": 2,
    "listen_us": 50_000, "spread_us": 50_000, "collect_us": 200_000, "tick_us": 250_000,
    "period": 8, "period_max": 8, "dead": 20, "dead_step": 4, "standby": 0, "jobs": 4,
    "job_us": 100_000, "job_tries": 3, "e2e_us": 30_000, "e2e_adapt": 1, "e2e_tries": 8,
    "forget": 120, "monitor": MONITOR, "watch": 0, "lost": 3, "flood": 1, "instances": 3,
    "clear_margin": 20, "predict_ms": 500, "unit_cm": 1, "points": 0, "fence": 0,
}  # fmt: skip


# A channel of processes: slots of 10 ms, a turnaround of 5 ms, and stations that act up to 3 ms
# late; the rest follows as docs/radio.md says.
RADIO: dict[str, int] = {
    "slot_us": 10_000, "bit_us": 1250, "ta_us": 5000, "dmin_us": 1, "dmax_us": 3000,
    "packet_slots": 20, "minislot_us": 17_248, "probe_us": 25_000, "retry_us": 58_000,
    "join_us": 609_184, "dead_us": 36_248, "turns": 20, "per_turn": 1, "wait_us": 400_000,
    "tail_rule": 1, "overlap_rule": 1, "window_slots": 0, "dilate": 1, "mac": 0, "stations": 1,
    "oracle": 0, "full_duplex": 0, "period_us": 0, "gap_us": 0, "answer_us": 0, "backoff_us": 208,
    "cw_min": 32, "cw_max": 1024, "p_q15": 3277,
}  # fmt: skip
# A skin at 50 Hz; a port is broken after five silent periods [skin 5].
SKIN: dict[str, int] = {
    "rule": RULE_FEASIBLE, "updates": WAVE, "beacon_us": 20_000, "r_f": 168, "r_r": 168, "k": 5,
    "max_depth": 64, "seq_every": 5, "balance_periods": 64, "balance_rule": 0,
    "hold_periods": 133, "gap_us": 500, "skip_us": 12_000, "restart_us": 0, "forward_min_us": 0,
    "forward_max_us": 0,
}  # fmt: skip
RANGES = {name: (low, high, unit) for name, _, low, high, unit, _ in PARAMS}
RADIO_RANGES = {name: (low, high, unit) for name, _, low, high, unit, _ in radio_fields.PARAMS}
EXTENT_MAX = 23_000  # units: squares of distances stay below 2^29
SKIN_RANGES = {name: (low, high, unit) for name, _, low, high, unit, _ in skin_fields.PARAMS}
# They follow from the node's file.
OURS = ("nodes", "width", "row", "told", "points", "px", "py", "after")


def fence_parameters(rings: list[list[tuple[int, int]]], where: str = "") -> dict[str, Any]:
    """The corners of a fence as the router has them: the polygon, then its holes.

    Raises:
        LiveError: too many corners, or one out of reach; the message begins with `where`.
    """
    count = sum(len(ring) for ring in rings)
    if count > POINTS:
        raise LiveError(f"{where}: the fence has {count} corners, more than {POINTS}")
    px, py, after = ([0] * POINTS for _ in range(3))
    at = 0
    for ring in rings:
        for i, (x, y) in enumerate(ring):
            if not (0 <= x <= EXTENT_MAX and 0 <= y <= EXTENT_MAX):
                raise LiveError(
                    f"{where}: fence corner [{x}, {y}] must be 0 to {EXTENT_MAX} units both ways; "
                    "raise protocol.unit_cm, or move the origin"
                )
            px[at + i], py[at + i], after[at + i] = x, y, at + (i + 1) % len(ring)
        at += len(ring)
    return {"points": count, "px": px, "py": py, "after": after}


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


def radio_parameters(changes: dict[str, int], where: str = "") -> dict[str, int]:
    """A station's parameters, with what is to be different.

    Raises:
        LiveError: see mesh_parameters().
    """
    _check(changes, RADIO_RANGES, where)
    return {**RADIO, **changes}


def _check(changes: dict[str, int], ranges: dict[str, tuple[int, int, str]], where: str) -> None:
    for name, value in changes.items():
        if name not in ranges:
            raise LiveError(f"{where}: protocol.{name} is unknown; it knows {', '.join(ranges)}")
        low, high, unit = ranges[name]
        if not low <= value <= high:
            raise LiveError(f"{where}: protocol.{name} = {value} must be {low} to {high} {unit}")
