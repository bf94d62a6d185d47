"""What running nodes say of themselves, as `innervate live status` prints it."""

from __future__ import annotations

from typing import Any

SOCKETS = ("W", "E", "up", "down")
LOSSES = ("unsent", "dropped", "unplugged")  # a path's counters that somebody should see


def headline(told: list[dict[str, Any]], silent: int) -> str:
    """Is all well with these nodes and `silent` more that do not answer: as pages say it, now."""
    from innervate.analysis.headline import silent as nobody
    from innervate.web.live_map import Map
    from innervate.web.live_state import State

    kinds = {one["kind"] for one in told}
    if len(kinds) > 1:
        return f"{' and '.join(sorted(kinds))} nodes: name those of one network to have it judged"
    found = nobody(silent, "node")
    if told:
        unknown = [{"kind": min(kinds), "neighbours": [], "paths": []} for _ in range(silent)]
        if silent and kinds == {"skin"} and all(one["role"] != "sink" for one in told):
            unknown[0] |= {"role": "sink", "paths": [{"port": 0, "name": ""}]}  # so that is the PC
        where = Map(dict(enumerate([*told, *unknown])))
        found = State(where, dict(enumerate(told))).headline(0.0)
    return f"{found.level}: {found.text}"


def broken(told: list[dict[str, Any]]) -> list[str]:
    """A line for each broken cable; of a cable between two of these nodes, one line for both."""
    found: dict[frozenset[str], list[str]] = {}
    for one in told:
        for path in one["paths"]:
            if path["broken"]:
                ends = frozenset((path["own"] or f"{one['name']} {path['name']}", path["name"]))
                found.setdefault(ends, []).append(f"{one['name']} port {path['port']}")
    return [f"broken: {' - '.join(ends)}" for ends in found.values()]


def lines(told: dict[str, Any]) -> list[str]:
    """A node's status, line by line."""
    key = "sealed" if told["sealed"] else "no key"
    if told["kind"] == "radio":
        told["paths"] = []
    found = [f"{told['name']}: {told['kind']} {told['role']}, up {told['up_s']:g} s, {key}"]
    state = told.get("state")
    if state is not None and state["trouble"]:
        since = "never" if state["written_s"] is None else f"{state['written_s']:g} s ago"
        found.append(f"  STATE NOT WRITTEN: {state['trouble']}; last {since}, to {state['file']}")
    # A cell's own numbers are those of its sockets; its paths are numbered through.
    cabled = sorted((one for one in told.get("ports", ()) if one["cabled"]),
                    key=lambda one: one["path"])  # fmt: skip
    sockets = {one["port"]: f"{one['path']} ({SOCKETS[one['port']]})" for one in cabled}
    names = [*sockets.values()] or [str(path["port"]) for path in told["paths"]]
    if told["kind"] == "mesh":
        found += _mesh_lines(told)
    elif told["kind"] == "radio":
        place = "none" if told["place"] is None else told["place"]
        found.append(f"  place in the round: {place}, packets queued {told['queued']}")
    elif told["role"] == "cell":
        way = "no route"
        if told["parent"] is not None:
            way = f"by port {sockets[told['parent']]}, {told['dist']} hops"
        found.append(f"  to the PC: {way}, load {told['load']}")
    elif told["role"] == "sink":
        found.append(f"  cells per interface port: {told['cells']}")
    for name, path in zip(names, told["paths"], strict=True):
        heard = "never" if path["heard_s"] is None else f"{path['heard_s']:.1f} s ago"
        lost = "".join(f", {what} {count}" for what, count in path["counters"].items()
                       if count and what.startswith(LOSSES))  # fmt: skip
        state = "  BROKEN" if path["broken"] else "" if path["up"] else "  CUT HERE"
        found.append(f"  port {name}: {path['name']}, heard {heard}{lost}{state}")
    counts = ", ".join(f"{what} {count}" for what, count in told["counters"].items())
    return [*found, f"  {counts}"]


def _mesh_lines(told: dict[str, Any]) -> list[str]:
    gateway = "none yet" if told["gateway"] is None else told["gateway"]
    lines = [f"  gateway {gateway}, epoch {told['epoch']}, table {told['table']}"]
    for near in told["neighbours"]:
        quality = "-" if near["quality"] is None else f"{100 * near['quality']:.1f} %"
        suspect = ", does not answer" if near["suspect"] else ""
        ports = ", ".join(map(str, near["ports"]))
        lines.append(f"  neighbour {near['node']} by port {ports}: acknowledged {quality}{suspect}")
    ways = [f"{dest} by {hop[0]}" for dest, hop in told["routes"].items()]
    lines.append(f"  routes: {', '.join(ways) or 'none'}")
    waiting = ", ".join(f"{count} for {dest}" for dest, count in told.get("waiting", {}).items())
    if waiting:
        lines.append(f"  messages that wait: {waiting}")
    if "robot" in told:
        at = told["robot"]["at_cm"]
        place = "no position yet" if at is None else f"at {at[0] / 100:.2f}, {at[1] / 100:.2f} m"
        lines.append(f"  robot: {place}, {told['robot']['fence']}")
    for alarm in told.get("alarms", ()):
        lines.append(f"  alarm {alarm['ago_s']:.1f} s ago: {alarm_text(alarm)}")
    return lines


def alarm_text(alarm: dict[str, Any]) -> str:
    """What an alarm says."""
    x, y, margin = (alarm[key] / 100 for key in ("x_cm", "y_cm", "margin_cm"))
    where = "" if alarm["kind"] == "lost" else f" at {x:.2f}, {y:.2f} m, margin {margin:.2f} m"
    return f"{alarm['kind']}, robot {alarm['robot']}{where} (from node {alarm['reporter']})"
