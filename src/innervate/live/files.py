"""Node files of a scenario's plan."""

from __future__ import annotations

import json
from typing import Any

from innervate.live.errors import LiveError
from innervate.live.profile import RADIO

# They follow from the file itself, or stand in its [fence].
NOT_IN_FILES = ("nodes", "width", "row", "told", "places", "points", "px", "py", "after")
Table = dict[str, Any]


def mesh(plan: Any, number: int) -> tuple[Table, dict[str, Table]]:
    """What is particular to a node of a mesh: keys of its file, and tables."""
    rank = plan.ranks[number]
    head: Table = {"nodes": plan.nodes}
    head["role"] = "node" if rank < 0 else "gateway" if rank == 0 else "standby"
    if rank > 0:
        head["rank"] = rank
    if plan.robots[number]:
        head["robot"] = True
    tables = {"protocol": {k: v for k, v in plan.params.items() if k not in NOT_IN_FILES}}
    rings = rings_of(plan.params)
    if rings:
        tables["fence"] = {"polygon": rings[0], "holes": rings[1:]}
    return head, tables


def rings_of(params: dict[str, Any]) -> list[list[list[int]]]:
    """The polygon of a fence and its holes; none if there is no fence."""
    rings: list[list[list[int]]] = []
    start = 0
    for i in range(params["points"]):
        if params["after"][i] != i + 1:  # the last corner of a ring leads back to its first
            rings.append([[params["px"][k], params["py"][k]] for k in range(start, i + 1)])
            start = i + 1
    return rings


def sink(plan: Any) -> tuple[Table, dict[str, Table]]:
    """What is particular to the PC of a skin."""
    return {"role": "sink"}, {"protocol": dict(plan.params)}


def cell(plan: Any, ports: list[int]) -> tuple[Table, dict[str, Table]]:
    """What is particular to a cell."""
    rate_hz = 1e6 / plan.data_period_us if plan.data_period_us else 0.0
    head = {"role": "cell", "ports": ports, "rate_hz": rate_hz}
    return head, {"protocol": dict(plan.params)}


def station(plan: Any) -> tuple[Table, dict[str, Table]]:
    """What is particular to a station: the scenario's turns, in slots that a PC can keep."""
    given = {name: plan.params[name] for name in ("packet_slots", "turns", "per_turn")}
    wait_us = 2 * given["packet_slots"] * RADIO["slot_us"]
    return {"role": "station"}, {"protocol": {**given, "wait_us": wait_us}}


def check_station_plan(plan: Any) -> None:
    """Refuse what live stations do not speak.

    Raises:
        LiveError: another medium access protocol.
    """
    if plan.protocol != "csma-cd-r/practical":
        raise LiveError(
            f"live stations speak practical CSMA/CD-R, not {plan.protocol}; "
            'set protocol.mac = "csma-cd-r" and protocol.mode = "practical"'
        )


def text(head: Table, tables: dict[str, Table], links: list[Table]) -> str:
    """A node file."""
    lines = _lines(head)
    for name, table in tables.items():
        lines += ["", f"[{name}]", *_lines(table)]
    for link in links:
        lines += ["", "[[link]]", *_lines(link)]
    return "\n".join(lines) + "\n"


def _lines(table: Table) -> list[str]:
    return [f"{key} = {json.dumps(value)}" for key, value in table.items()]
