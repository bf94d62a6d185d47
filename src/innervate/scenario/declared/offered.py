"""What a network lets a scenario have besides its settings: tables to be uncommented, in TOML."""

from collections.abc import Iterator
from typing import Any

from innervate.network import Network

AGAIN = ("every_s = 0.2  # once, if left out", "node = 0  # all, if left out")


def offered(network: Network, words: str, target: str, *more: list[str]) -> str:
    """Comments: what its users hand in, what happens to it, and tables of the medium.

    Args:
        network: with `fields`, and `happenings` if it has own words.
        words: of what can happen on its medium, with what each needs besides a target.
        target: a line with what the first of them happens to.
        more: tables of the medium, line by line.
    """
    own = "".join(f"; {word} of a node, with value" for word in _own_words(network))
    first, _, others = words.partition(", ")
    event = ["[[event]]", "at_s = 0.5", f'action = "{first}"  # {others}{own}', target]
    tables = [*_inputs(network), *more, event]
    return "".join("\n" + "".join(f"# {line}\n" for line in table) for table in tables)


def _own_words(network: Network) -> list[str]:
    return list(network.happenings) if network.has("happenings") else []


def _inputs(network: Network) -> Iterator[list[str]]:
    """An [[input]] of each kind that the explorer hands in; places of robots are none."""
    fields = network.fields
    given = {kind: item for kind, item in reversed(getattr(fields, "GIVEN", ()))}
    for kind, item in sorted(given.items()):
        if kind != getattr(fields, "PLACED", None):
            what = ", ".join(f"{name} = {_number(value)}" for name, value in item.items())
            inside = f"item = {{ {what} }}" if what else "item = {}"
            yield ["[[input]]", "at_s = 0.1", *AGAIN, f"kind = {kind}", inside]


def _number(value: Any) -> str:
    return str(list(value)) if isinstance(value, tuple | list) else str(value)
