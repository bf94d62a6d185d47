"""What running nodes of any network say of themselves, as `innervate live` prints it."""

from __future__ import annotations

from typing import Any

# What every node says of itself; what else its status has was declared by its protocol.
COMMON = frozenset((
    "name", "up_s", "sealed", "keys", "state", "paths", "broken", "counters", "kind", "role",
    "number",
))  # fmt: skip


def lines(told: dict[str, Any]) -> list[str]:
    """What is particular to a node's status, line by line."""
    own = [f"{name} {value}" for name, value in told.items() if name not in COMMON]
    return [f"  {', '.join(own)}"] if own else []


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
