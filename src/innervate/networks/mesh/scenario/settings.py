"""The settings of the mesh protocol in a scenario: [protocol] [mesh 5].

What is left out comes from the radio's profile (see mesh_profiles.py, mesh_params.py).
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

Wait = Annotated[float, Meta(gt=0, le=268, description="a number of seconds > 0, at most 268")]
Slow = Annotated[float, Meta(gt=0, le=65_535, description="a number of seconds > 0, at most 65535")]
Flag = Annotated[bool, Meta(description="true or false")]


class MeshProtocolTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[protocol] of a mesh: discovery, failover, retransmission, timers."""

    discovery: Annotated[
        Literal["list", "tree", "each"], Meta(description='"list", "tree" or "each"')
    ] = "list"
    failover: Annotated[
        Literal["search", "alternate", "rssi", "random", "graph"],
        Meta(description='"search", "alternate", "rssi", "random" or "graph"'),
    ] = "search"
    avoid: Annotated[Literal["sender", "origin"], Meta(description='"sender" or "origin"')] = (
        "sender"
    )
    tables: Flag = True
    retry: Flag = True
    reliable: Flag = True
    activation: Flag = False
    mtu: Annotated[Literal[64, 127], Meta(description="64 or 127 bytes")] | None = None
    transmissions: (
        Annotated[int, Meta(ge=1, le=15, description="a whole number of tries, 1 to 15")] | None
    ) = None
    hop_acks: Flag | None = None
    ack_us: (
        Annotated[
            int, Meta(ge=1, le=16_777_215, description="a whole number of microseconds from 1")
        ]
        | None
    ) = None
    suspect_s: Wait | None = None
    min_rssi_dbm: (
        Annotated[int, Meta(ge=-128, le=127, description="a whole number of dBm, -128 to 127")]
        | None
    ) = None
    jitter_s: (
        Annotated[float, Meta(ge=0, le=2.55, description="a number of seconds, 0 to 2.55")] | None
    ) = None
    flood_s: (
        Annotated[float, Meta(ge=0, le=2.55, description="a number of seconds, 0 to 2.55")] | None
    ) = None
    copies: (
        Annotated[int, Meta(ge=1, le=15, description="a whole number of copies, 1 to 15")] | None
    ) = None
    listen_s: Wait | None = None
    spread_s: Wait | None = None
    collect_s: Wait | None = None
    beacon_s: (
        Annotated[float, Meta(ge=0.001, le=16, description="a number of seconds, 0.001 to 16")]
        | None
    ) = None
    period_s: Slow | None = None
    period_max_s: Slow | None = None
    dead_s: Slow | None = None
    dead_step_s: Slow | None = None
    table_window: (
        Annotated[int, Meta(ge=1, le=15, description="a whole number of nodes, 1 to 15")] | None
    ) = None
    table_retry_s: (
        Annotated[float, Meta(gt=0, le=67, description="a number of seconds > 0, at most 67")]
        | None
    ) = None
    table_tries: (
        Annotated[int, Meta(ge=0, le=15, description="a whole number of tries, 0 to 15")] | None
    ) = None
    e2e_s: (
        Annotated[float, Meta(ge=0.001, le=16, description="a number of seconds, 0.001 to 16")]
        | None
    ) = None
    e2e_adapt: Flag | None = None
    e2e_tries: (
        Annotated[int, Meta(ge=0, le=15, description="a whole number of tries, 0 to 15")] | None
    ) = None
    forget_s: Slow | None = None
