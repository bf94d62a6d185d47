"""What running nodes of any network say of themselves, as `innervate live` prints it."""

from typing import Any

from innervate.network import networks


def lines(told: dict[str, Any]) -> list[str]:
    """The declared fields of a node's state, with their units."""
    units = {name: unit for name, _length, _low, _high, unit, _meaning
             in networks()[told["kind"]].fields.STATE}  # fmt: skip
    own = [f"{name} {_shown(value)} {units[name]}" for name, value in told["fields"].items()]
    return [f"  {', '.join(own)}"]


def _shown(value: Any) -> str:
    return " ".join(map(str, value)) if isinstance(value, list) else str(value)


def ports(told: dict[str, Any]) -> list[str]:
    """What each of a node's paths is called."""
    return [str(path["port"]) for path in told["paths"]]


def heard(answer: dict[str, Any]) -> str:
    """What came in at a node that is listened to."""
    if "payload" in answer:
        return message(answer)
    return ", ".join(f"{name} {value}" for name, value in answer.items() if name != "from")


def message(answer: dict[str, Any]) -> str:
    """The text of a message."""
    return bytes.fromhex(answer["payload"]).decode("utf-8", "backslashreplace")
