"""What radios and their timers are like, by profile [mesh 5, 6]; and the protocol's parameters."""

from __future__ import annotations

from math import ceil
from typing import Any, NamedTuple

from innervate.protocol.mesh_fields import NEIGHBOURS, PARAMS, POINTS, words
from innervate.protocol.mesh_words import (
    ACK_BYTES,
    ALTERNATE,
    CLASSES,
    EACH,
    LIST,
    LOUDEST,
    MONITOR,
    RANDOM,
    SEARCH,
    TABLE_FREE,
    TABLES,
    TREE,
    WHOLE_GRAPH,
)

DISCOVERY = {"list": LIST, "tree": TREE, "each": EACH}
FAILOVER = {"random": RANDOM, "rssi": LOUDEST, "alternate": ALTERNATE, "search": SEARCH,
            "graph": SEARCH}  # fmt: skip
GOOD_CDB = 300  # a good link is so much above the 50 % point, both ways
REPORT_CDB = 200
STANDBY_PERIODS = 2.5
FORGET_S = 30.0
SMALL = 15  # up to so many nodes a slow radio can afford twice the rounds
LARGE = 20  # above so many, it can only afford half the beacons


class Profile(NamedTuple):
    """A radio and the timers that suit it; times in seconds where not said otherwise.

    Attributes:
        byte_ns: airtime of a byte, ns.
        phy_bytes: preamble and the like.
        turnaround_us: from deciding to send to being on the air.
        backoff_us: unit of the random wait before a frame; 0 = no carrier sense.
        rssi50_cdb: 0.01 dBm at which half the frames are received.
        loss_1m_cdb: path loss at 1 m in free space, 0.01 dB.
        ack_us: wait for a hop's ack.
        dead_step: more for every rank of standby.
        settled: messages start then if nothing is said: the first tables are there.
    """

    byte_ns: int
    phy_bytes: int
    turnaround_us: int
    backoff_us: int
    rssi50_cdb: int
    loss_1m_cdb: int
    mtu: int
    collisions: bool
    period: float
    period_max: float
    jitter: float
    copies: int
    listen: float
    spread: float
    collect: float
    transmissions: int
    ack_us: int
    suspect: float
    e2e: float
    e2e_adapt: bool
    jobs: int
    job: float
    beacon: float
    dead_step: float
    settled: float


def _ack_us(turnaround_us: int, phy_bytes: int, byte_ns: int, backoff_us: int) -> int:
    """Turnaround, the ack, and two units [mesh 5]."""
    return turnaround_us + (phy_bytes + int(ACK_BYTES)) * byte_ns // 1000 + 2 * backoff_us


FAST = Profile(
    byte_ns=32_000, phy_bytes=6, turnaround_us=192, backoff_us=320, rssi50_cdb=-9500,
    loss_1m_cdb=4000, mtu=127, collisions=True, period=10, period_max=60, jitter=0.1, copies=2,
    listen=0.3, spread=0.4, collect=1.5, transmissions=3, ack_us=_ack_us(192, 6, 32_000, 320),
    suspect=10, e2e=0.25, e2e_adapt=False, jobs=4, job=0.5, beacon=1, dead_step=5, settled=8,
)  # fmt: skip
SLOW = Profile(
    byte_ns=208_333, phy_bytes=7, turnaround_us=2000, backoff_us=2000, rssi50_cdb=-10_500,
    loss_1m_cdb=3100, mtu=64, collisions=True, period=60, period_max=300, jitter=1.0, copies=2,
    listen=3, spread=4, collect=13, transmissions=3, ack_us=_ack_us(2000, 7, 208_333, 2000),
    suspect=10, e2e=1.5, e2e_adapt=False, jobs=2, job=3, beacon=1, dead_step=5, settled=45,
)  # fmt: skip
# Nobody tells when a frame has left, so the wait begins when it is handed down: a whole frame more.
IDEAL = FAST._replace(
    collisions=False, backoff_us=0, ack_us=_ack_us(2 * 192, 12 + 127, 32_000, 320)
)
# Ethernet at 100 Mbit/s with UDP's headers; the turnaround stands for the operating system.
IP = Profile(
    byte_ns=80, phy_bytes=66, turnaround_us=200, backoff_us=0, rssi50_cdb=-9500, loss_1m_cdb=4000,
    mtu=127, collisions=False, period=2, period_max=12, jitter=0.005, copies=2, listen=0.05,
    spread=0.05, collect=0.2, transmissions=2, ack_us=5000, suspect=2, e2e=0.03, e2e_adapt=True,
    jobs=4, job=0.1, beacon=0.25, dead_step=1, settled=1,
)  # fmt: skip
PROFILES = {"250k": FAST, "38k4": SLOW, "ideal": IDEAL, "ip": IP}


def profile_of(name: str, nodes: int) -> Profile:
    """A profile as it suits so many nodes."""
    found = PROFILES[name]
    if name == "38k4" and nodes <= SMALL:
        found = found._replace(period=30)
    if name == "38k4" and nodes > LARGE:
        found = found._replace(beacon=2)
    return found


def parameters(
    profile: Profile,
    settings: Any,
    nodes: int,
    *,
    standbys: int = 0,
    monitor: int = MONITOR,
    min_rssi_dbm: int | None = None,
) -> dict[str, Any]:
    """The protocol's parameters (`mesh_fields.PARAMS`) without a fence.

    Args:
        profile: the radio's.
        settings: a MeshProtocolTable; what it leaves out comes from the profile.
        nodes: 1 .. 254.
        standbys: how many are configured.
        monitor: its number, 254 = whoever is gateway.
        min_rssi_dbm: weakest link that is reported; None = 2 dB above the 50 % point.

    Raises:
        ValueError: a parameter leaves its range; the message names the key and the range.
    """
    width: int = next(size for size in CLASSES if nodes <= size)

    def chosen(key: str, default: Any) -> Any:
        value = getattr(settings, key)
        return default if value is None else value

    def micros(key: str, default_s: float) -> int:
        return round(float(chosen(key, default_s)) * 1_000_000)

    tick_us = micros("beacon_s", profile.beacon)
    period_s = chosen("period_s", profile.period)

    def ticks(key: str, default_s: float) -> int:
        return max(1, ceil(micros(key, default_s) / tick_us))

    graph = settings.failover == "graph"
    reported = round((profile.rssi50_cdb + REPORT_CDB) / 100)
    listen_us = micros("listen_s", profile.listen)
    spread_us = micros("spread_s", profile.spread)
    rest_s = profile.collect - profile.listen - profile.spread
    params: dict[str, Any] = {
        "nodes": nodes,
        "row": words(width),
        "places": min(width, NEIGHBOURS),
        "width": width,
        "mtu": chosen("mtu", profile.mtu),
        "mode": WHOLE_GRAPH if graph else TABLES if settings.tables else TABLE_FREE,
        "discovery": DISCOVERY[settings.discovery],
        "failover": FAILOVER[settings.failover],
        "avoid_origin": int(settings.avoid == "origin"),
        "retry": int(settings.retry),
        "reliable": int(settings.reliable),
        "activation": int(settings.activation),
        "told": int(profile.collisions),
        "transmissions": chosen("transmissions", profile.transmissions),
        "ack_us": chosen("ack_us", profile.ack_us),
        "suspect_us": micros("suspect_s", profile.suspect),
        "min_rssi": chosen("min_rssi_dbm", reported if min_rssi_dbm is None else min_rssi_dbm),
        "jitter_us": micros("jitter_s", profile.jitter),
        "copies": chosen("copies", profile.copies),
        "listen_us": listen_us,
        "spread_us": spread_us,
        "collect_us": micros("collect_s", (listen_us + spread_us) / 1e6 + rest_s),
        "tick_us": tick_us,
        "period": ticks("period_s", period_s),
        "period_max": ticks("period_max_s", max(profile.period_max, period_s)),
        "dead": ticks("dead_s", STANDBY_PERIODS * period_s),
        "dead_step": ticks("dead_step_s", profile.dead_step),
        "standby": int(standbys > 0),
        "jobs": chosen("table_window", profile.jobs),
        "job_us": micros("table_retry_s", profile.job),
        "job_tries": chosen("table_tries", 3),
        "e2e_us": micros("e2e_s", profile.e2e),
        "e2e_adapt": int(chosen("e2e_adapt", profile.e2e_adapt)),
        "e2e_tries": chosen("e2e_tries", 5),
        "forget": min(255, ticks("forget_s", FORGET_S)),
        "monitor": monitor,
        **NO_FENCE,
    }
    _check(params)
    return params


NO_FENCE: dict[str, Any] = {
    "watch": 0, "lost": 3, "flood": 1, "instances": 3, "clear_margin": 0, "predict_ms": 0,
    "unit_cm": 1, "points": 0, "px": [0] * POINTS, "py": [0] * POINTS, "after": [0] * POINTS,
    "fence": 0,
}  # fmt: skip
# Keys of [protocol] whose parameter is called something else.
_KEYS = {"tick": "beacon_s", "jobs": "table_window", "job": "table_retry_s",
         "job_tries": "table_tries", "min_rssi": "min_rssi_dbm"}  # fmt: skip
_IN_TICKS = ("period", "period_max", "dead", "dead_step", "forget")


def _check(params: dict[str, Any]) -> None:
    for name, length, low, high, unit, _ in PARAMS:
        if length == 0 and not low <= params[name] <= high:
            stem = name.removesuffix("_us")
            key = _KEYS.get(stem, f"{stem}_s" if stem != name or name in _IN_TICKS else name)
            most = f"{low} to {high} {unit}"
            if name in _IN_TICKS:
                most = f"at most {high * params['tick_us'] / 1e6:g} s at this protocol.beacon_s"
            raise ValueError(f"{key}:protocol.{key} is out of range; it can be {most}")
    if params["period_max"] < params["period"]:
        raise ValueError(
            "period_max_s:protocol.period_max_s is below period_s; make it as long or longer"
        )
