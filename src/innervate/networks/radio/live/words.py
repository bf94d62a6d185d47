"""What running stations say of themselves, as `innervate live` prints it."""

from typing import Any

from innervate.live.words import message as heard

__all__ = ["heard", "lines", "ports"]


def lines(told: dict[str, Any]) -> list[str]:
    """Its place in the round, and how many packets wait."""
    place = "none" if told["place"] is None else told["place"]
    return [f"  place in the round: {place}, packets queued {told['queued']}"]


def ports(told: dict[str, Any]) -> list[str]:
    """A station has nothing but its channel."""
    return []
