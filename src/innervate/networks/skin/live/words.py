"""What running cells and their PC say of themselves, as `innervate live` prints it."""

from datetime import datetime
from typing import Any

from innervate.kernel.words import number_of

SOCKETS = ("W", "E", "up", "down")


def lines(told: dict[str, Any]) -> list[str]:
    """A cell's way to the PC; how many cells each interface port of the PC serves."""
    if told["role"] == "sink":
        return [f"  cells per interface port: {told['cells']}"]
    way = "no route"
    if told["parent"] is not None:
        way = f"by port {_sockets(told)[told['parent']]}, {number_of(told['dist'], 'hop')}"
    return [f"  to the PC: {way}, load {told['load']}"]


def ports(told: dict[str, Any]) -> list[str]:
    """Paths are numbered through; a cell's have the names of its sockets, too."""
    return [*_sockets(told).values()] or [str(path["port"]) for path in told["paths"]]


def _sockets(told: dict[str, Any]) -> dict[int, str]:
    """What a cell's ports with cables are called, in order of their paths."""
    cabled = sorted((one for one in told.get("ports", ()) if one["cabled"]),
                    key=lambda one: int(one["path"]))  # fmt: skip
    return {one["port"]: f"{one['path']} ({SOCKETS[one['port']]})" for one in cabled}


def heard(answer: dict[str, Any]) -> str:
    """A sample at the PC, a command at a cell."""
    return touch_text(answer["touch"]) if "touch" in answer else command_text(answer["command"])


def command_text(command: dict[str, Any]) -> str:
    """A command, with the time at which the cell received it."""
    whom = "all cells" if command["to_all"] else "this cell"
    return (
        f"{_time(command['time_us'])} command {command['number']} for {whom}: code "
        f"{command['code']}, value {command['value']}, {number_of(command['hops'], 'hop')}"
    )


def _time(time_us: int) -> str:
    return datetime.fromtimestamp(time_us / 1e6).isoformat(" ", "microseconds")


def touch_text(touch: dict[str, Any]) -> str:
    """A sample, with the time at which the PC received it."""
    force = " ".join(str(value) for value in touch["force"])
    return (
        f"{_time(touch['time_us'])} seq {touch['seq']}, {number_of(touch['hops'], 'hop')}, "
        f"interface {touch['port']}, proximity {touch['proximity']}, force {force} mN, "
        f"{20 + touch['temperature'] / 2:g} degC"
    )
