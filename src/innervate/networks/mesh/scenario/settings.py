"""The settings of the mesh protocol in a scenario: [protocol] [mesh 5].

What is left out comes from the radio's profile (see profiles.py, params.py).
"""

from typing import Annotated, Literal

from innervate.networks.mesh.protocol.constants import MTU_MAX
from innervate.scenario import keys

Wait = Annotated[float, keys.above_0("seconds", 268)]
Slow = Annotated[float, keys.above_0("seconds", 65_535)]
Short = Annotated[float, keys.number("seconds", 0, 2.55)]
Beat = Annotated[float, keys.number("seconds", 0.001, 16)]
Tries = Annotated[int, keys.whole("tries", 0, 15)]


class MeshProtocolTable(keys.Table, frozen=True, kw_only=True):
    """[protocol] of a mesh: discovery, failover, retransmission, timers."""

    discovery: Literal["list", "tree", "each"] = "list"
    uplink: Literal["best", "first"] | None = None
    failover: Literal["search", "alternate", "heard", "rssi", "random", "graph", "auto"] = "search"
    avoid: Literal["sender", "origin"] = "sender"
    tables: bool = True
    on_demand: bool = False
    retry: bool = True
    reliable: bool = True
    activation: bool = False
    mtu: Annotated[int, keys.whole("bytes", 64, MTU_MAX)] | None = None
    transmissions: Annotated[int, keys.whole("tries", 1, 15)] | None = None
    hop_acks: bool | None = None
    ack_us: Annotated[int, keys.whole("microseconds", 1, limit=16_777_215)] | None = None
    ack_adapt: bool | None = None
    suspect_s: Wait | None = None
    min_rssi_dbm: Annotated[int, keys.whole("dBm", -128, 127)] | None = None
    jitter_s: Short | None = None
    flood_s: Short | None = None
    copies: Annotated[int, keys.whole("copies", 1, 15)] | None = None
    asks: bool | None = None
    listen_s: Wait | None = None
    spread_s: Wait | None = None
    collect_s: Wait | None = None
    beacon_s: Beat | None = None
    period_s: Slow | None = None
    period_max_s: Slow | None = None
    dead_s: Slow | None = None
    dead_step_s: Slow | None = None
    guard_s: Annotated[float, keys.number("seconds", 0, 2)] | None = None
    table_window: Annotated[int, keys.whole("nodes", 1, 15)] | None = None
    table_retry_s: Annotated[float, keys.above_0("seconds", 67)] | None = None
    table_tries: Tries | None = None
    e2e_s: Beat | None = None
    e2e_adapt: bool | None = None
    e2e_tries: Tries | None = None
    forget_s: Slow | None = None
