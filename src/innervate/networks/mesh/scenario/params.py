"""The protocol's parameters of a mesh scenario (`mesh_fields.PARAMS`) [mesh 5]."""

from math import ceil
from typing import Any

from innervate.networks.mesh.protocol import constants as w
from innervate.networks.mesh.protocol import fields
from innervate.networks.mesh.scenario.plan import CLASSES
from innervate.networks.mesh.scenario.profiles import POOR_CDB, REPORT_CDB, Profile

DISCOVERY = {"list": w.LIST, "tree": w.TREE, "each": w.EACH}
FAILOVER = {"random": w.RANDOM, "rssi": w.LOUDEST, "heard": w.LOUDEST, "alternate": w.ALTERNATE,
            "search": w.SEARCH, "graph": w.SEARCH, "auto": w.SEARCH}  # fmt: skip
FAINTEST_DBM, LOUDEST_DBM = -128, 127
STANDBY_PERIODS = 2.5  # without a request, until the first standby takes over
FORGET_S = 60.0
FORGET_TICKS_MAX = 255
NO_FENCE: dict[str, Any] = {
    "watch": 0, "lost": 3, "flood": 1, "instances": 3, "clear_margin": 0, "predict_ms": 0,
    "unit_cm": 1, "points": 0, "fence": 0,
    **{corners: [0] * fields.POINTS for corners in ("px", "py", "after")},
}  # fmt: skip
# Keys of [protocol] whose parameter is called something else.
KEYS = {"faint": "min_rssi_dbm", "tick": "beacon_s", "jobs": "table_window", "job": "table_retry_s",
        "job_tries": "table_tries", "min_rssi": "min_rssi_dbm"}  # fmt: skip
# Parameters, keys of [protocol] and parts of a profile that are called the same.
OF_PROFILE = ("mtu", "transmissions", "hop_acks", "ack_us", "ack_adapt", "e2e_adapt",
              "e2e_tries", "copies", "asks")  # fmt: skip
SAID = ("retry", "reliable", "activation", "on_demand")  # keys and parameters alike
IN_TICKS = ("period", "period_max", "dead", "dead_step", "forget")


class _Chosen:
    """What a scenario says, and where it says nothing, the profile."""

    def __init__(self, settings: Any, beacon_s: float) -> None:
        self.settings = settings
        self.tick_us = self.micros("beacon_s", beacon_s)

    def value(self, key: str, default: Any) -> Any:
        value = getattr(self.settings, key)
        return default if value is None else value

    def micros(self, key: str, default_s: float) -> int:
        return round(float(self.value(key, default_s)) * 1_000_000)

    def ticks(self, key: str, default_s: float) -> int:
        return max(1, ceil(self.micros(key, default_s) / self.tick_us))


def parameters(
    profile: Profile,
    settings: Any,
    nodes: int,
    *,
    degree: int = 0,
    monitor: int = w.MONITOR,
    min_rssi_dbm: int | None = None,
) -> dict[str, Any]:
    """The protocol's parameters without a fence and standby gateways.

    What `settings`, a MeshProtocolTable, leave out comes from the radio's profile. `degree`: most
    neighbours of a node, as far as is known. `monitor`: its number, 254 = whoever is gateway.
    `min_rssi_dbm`: of the weakest link that is reported; None = 2 dB above the 50 % point.

    Raises:
        ValueError: a parameter leaves its range; the message is "key:what is wrong".
    """
    width: int = next(size for size in CLASSES if nodes <= size and degree <= fields.places(size))
    chosen = _Chosen(settings, profile.beacon)
    if min_rssi_dbm is None:
        min_rssi_dbm = round((profile.rssi50_cdb + REPORT_CDB) / 100)
    min_rssi = chosen.value("min_rssi_dbm", min_rssi_dbm)
    params: dict[str, Any] = {
        "nodes": nodes,
        "row": fields.row_bytes(width),
        "places": fields.places(width),
        "width": width,
        "told": int(profile.collisions),
        "hop_frames": 0,
        "gather": 0,
        "queue": fields.QUEUE,
        "kept": fields.WAITING,
        "suspect_us": chosen.micros("suspect_s", profile.suspect),
        "min_rssi": min_rssi,
        "faint": min(min_rssi + 1, LOUDEST_DBM) if _takes_best(settings) else FAINTEST_DBM,
        "e2e_us": chosen.micros("e2e_s", profile.e2e),
        "monitor": monitor,
        "standby": 0,
        "jobs": chosen.value("table_window", profile.jobs),
        "job_us": chosen.micros("table_retry_s", profile.job),
        "job_tries": chosen.value("table_tries", profile.job_tries),
        **_routing(settings, profile),
        **{name: int(chosen.value(name, getattr(profile, name))) for name in OF_PROFILE},
        **_rounds(profile, chosen),
        **NO_FENCE,
    }
    _check(params)
    return params


def sent_at_most(params: Any) -> int:
    """How often a message goes over one hop, with all retries of the hop and of its origin."""
    again = params["e2e_tries"] * params["reliable"]
    return int(params["transmissions"] * (1 + again))


def _takes_best(settings: Any) -> bool:
    """Whether the next hop to the gateway is the best [A2]; as a rule with what was heard [A1]."""
    if settings.uplink is None:
        return bool(settings.discovery == "list")
    return bool(settings.uplink == "best")


def of_mode(mode: int, profile: Profile) -> dict[str, int]:
    """How nodes get their routes, and what goes with it.

    Links below `poor`, dBm, lose frames in a free channel, too; a flooded graph leaves none free.
    """
    poor_dbm = round((profile.rssi50_cdb + POOR_CDB) / 100)
    return {"mode": mode, "poor": FAINTEST_DBM if mode == w.WHOLE_GRAPH else poor_dbm}


def _routing(settings: Any, profile: Profile) -> dict[str, int]:
    """What a scenario says of routes; with "auto" that of tables."""
    graph = settings.failover == "graph"
    mode = w.WHOLE_GRAPH if graph else w.TABLES if settings.tables else w.TABLE_FREE
    return {
        **of_mode(mode, profile),
        "discovery": DISCOVERY[settings.discovery],
        "failover": FAILOVER[settings.failover],
        "recent": int(settings.failover == "heard"),
        "avoid_origin": int(settings.avoid == "origin"),
        **{name: int(getattr(settings, name)) for name in SAID},
    }


def _rounds(profile: Profile, chosen: _Chosen) -> dict[str, int]:
    """Discovery rounds, and everything that is counted in ticks."""
    period_s = chosen.value("period_s", profile.period)
    listen_us = chosen.micros("listen_s", profile.listen)
    spread_us = chosen.micros("spread_s", profile.spread)
    rest_s = profile.collect - profile.listen - profile.spread
    return {
        "jitter_us": chosen.micros("jitter_s", profile.jitter),
        "flood_us": chosen.micros("flood_s", profile.flood),
        "listen_us": listen_us,
        "spread_us": spread_us,
        "collect_us": chosen.micros("collect_s", (listen_us + spread_us) / 1e6 + rest_s),
        "tick_us": chosen.tick_us,
        "period": chosen.ticks("period_s", period_s),
        "period_max": chosen.ticks("period_max_s", max(profile.period_max, period_s)),
        "dead": chosen.ticks("dead_s", STANDBY_PERIODS * period_s),
        "dead_step": chosen.ticks("dead_step_s", profile.dead_step),
        "guard_us": chosen.micros("guard_s", 0 if chosen.settings.dead_s else profile.guard),
        "forget": min(FORGET_TICKS_MAX, chosen.ticks("forget_s", FORGET_S)),
    }


def _check(params: dict[str, Any]) -> None:
    for name, length, low, high, unit, _ in fields.PARAMS:
        if length == 0 and not low <= params[name] <= high:
            stem = name.removesuffix("_us")
            key = KEYS.get(stem, f"{stem}_s" if stem != name or name in IN_TICKS else name)
            most = f"{low} to {high} {unit}"
            if name in IN_TICKS:
                most = f"at most {high * params['tick_us'] / 1e6:g} s at this protocol.beacon_s"
            raise ValueError(f"{key}:protocol.{key} is out of range; it can be {most}")
    if params["period_max"] < params["period"]:
        raise ValueError(
            "period_max_s:protocol.period_max_s is below period_s; make it as long or longer"
        )
    if params["collect_us"] <= params["listen_us"] and params["discovery"] != w.EACH:
        listen_s = params["listen_us"] / 1e6
        raise ValueError(
            f"collect_s:protocol.collect_s must be more than listen_s, {listen_s:g} s: before that "
            "nobody responds"
        )
