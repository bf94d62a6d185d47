"""A watched network as a scenario: what was done to it by hand becomes its events."""

import tomllib
from typing import Any

from innervate.network import networks
from innervate.scenario import dump
from innervate.scenario.emit import to_toml
from innervate.web.view import View


def saved(view: View) -> str:
    """TOML that `innervate run` replays to the same network.

    Events of the scenario that were drawn are written out as they happened: what is added in
    between would alter the draw.
    """
    scenario = view.plan.scenario
    tables: dict[str, Any] = tomllib.loads(dump(scenario))
    faults: dict[int, list[Any]] = {}
    for fault in view.plan.faults:
        faults.setdefault(fault.index, []).append(fault)
    events = []
    for index, table in enumerate(tables.pop("event", [])):
        if "random" in table or isinstance(table["at_s"], list) or table.get("station") == "random":
            events += [_plain(view, table, fault) for fault in faults[index]]
        else:
            events.append(table)
    events += [_event(view, fault) for fault in view.engine.given]
    return to_toml({**tables, **view.extra(), **({"event": events} if events else {})})


def _event(view: View, fault: Any) -> dict[str, Any]:
    """The [[event]] table of a fault."""
    action = networks()[view.plan.kind].actions[fault.action]
    return {"at_s": fault.at_us / 1e6, "action": action, **view.event(fault)}


def _plain(view: View, table: dict[str, Any], fault: Any) -> dict[str, Any]:
    """An event with nothing drawn: its time and target as they are in the plan."""
    kept = [key for key in ("loss", "frames", "noise_dbm") if key in table]
    return {**_event(view, fault), **{key: table[key] for key in kept}}
