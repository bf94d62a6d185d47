"""What a node file may set of a protocol: its declared parameters, each within its range."""

from collections.abc import Iterable, Mapping
from typing import Any

from innervate.live.errors import LiveError


def settings_of(words: Iterable[str], declared: Iterable[tuple[Any, ...]]) -> dict[str, int]:
    """Parameters by name, of `name=value` on a command line; declared as for `check_parameters`.

    Raises:
        LiveError: one is not of this form.
    """
    found = {}
    for word in words:
        name, _, value = word.partition("=")
        if not value.lstrip("-").isdigit():
            like = next((one[0] for one in declared if one[4] == "us"), "name")
            raise LiveError(f"{word}: give a whole number, like {like}=20000")
        found[name] = int(value)
    return found


def check_parameters(
    changes: Mapping[str, int], declared: Iterable[tuple[Any, ...]], where: str
) -> None:
    """Refuse what a protocol does not declare.

    Args:
        changes: parameters by name, as the file has them.
        declared: the protocol's declarations (name, length, low, high, unit, meaning).
        where: how messages begin.

    Raises:
        LiveError: no such parameter, or out of its range.
    """
    ranges = {name: (low, high, unit) for name, _length, low, high, unit, _meaning in declared}
    for name, value in changes.items():
        if name not in ranges:
            raise LiveError(f"{where}: protocol.{name} is unknown; it knows {', '.join(ranges)}")
        low, high, unit = ranges[name]
        if not low <= value <= high:
            raise LiveError(f"{where}: protocol.{name} = {value} must be {low} to {high} {unit}")
