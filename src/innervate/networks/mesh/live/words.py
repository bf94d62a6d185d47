"""What running nodes of a mesh say of themselves, as `innervate live` prints it."""

from typing import Any

from innervate.live.words import message, ports

__all__ = ["heard", "lines", "ports"]


def lines(told: dict[str, Any]) -> list[str]:
    """Gateway, neighbours, routes, what waits, robot and alarms."""
    gateway = "none yet" if told["gateway"] is None else told["gateway"]
    found = [f"  gateway {gateway}, epoch {told['epoch']}, table {told['table']}"]
    for near in told["neighbours"]:
        quality = "-" if near["quality"] is None else f"{100 * near['quality']:.1f} %"
        suspect = ", does not answer" if near["suspect"] else ""
        by = ", ".join(map(str, near["ports"]))
        found.append(f"  neighbour {near['node']} by port {by}: acknowledged {quality}{suspect}")
    ways = [f"{dest} by {hop[0]}" for dest, hop in told["routes"].items()]
    found.append(f"  routes: {', '.join(ways) or 'none'}")
    waiting = ", ".join(f"{count} for {dest}" for dest, count in told.get("waiting", {}).items())
    if waiting:
        found.append(f"  messages that wait: {waiting}")
    if "robot" in told:
        at = told["robot"]["at_cm"]
        place = "no position yet" if at is None else f"at {at[0] / 100:.2f}, {at[1] / 100:.2f} m"
        found.append(f"  robot: {place}, {told['robot']['fence']}")
    for alarm in told.get("alarms", ()):
        found.append(f"  alarm {alarm['ago_s']:.1f} s ago: {alarm_text(alarm)}")
    return found


def alarm_text(alarm: dict[str, Any]) -> str:
    """What an alarm says, as "cross, robot 3 at 1.00, 2.00 m (from node 3)"."""
    x, y, margin = (alarm[key] / 100 for key in ("x_cm", "y_cm", "margin_cm"))
    where = "" if alarm["kind"] == "lost" else f" at {x:.2f}, {y:.2f} m, margin {margin:.2f} m"
    return f"{alarm['kind']}, robot {alarm['robot']}{where} (from node {alarm['reporter']})"


def heard(answer: dict[str, Any]) -> str:
    """A message, or an alarm of the fence."""
    return f"alarm: {alarm_text(answer['alarm'])}" if "alarm" in answer else message(answer)
