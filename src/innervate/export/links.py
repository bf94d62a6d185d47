"""What a capture says of its frames: numbers of link types, names of interfaces.

pcapng keeps sixteen link types for private use; ours are the first ones. An interface has a name
for people, and a description in these words for programs, its parts after "; ":
"cell 7 port 1", "pc port 0", "node 3" or "station 3" first, then "A to B" where its frames take
one cable only, from one end to the other. The interface at the cable's other end says "B to A".
"""

import re
from typing import NamedTuple

from innervate.network import networks

_FIRST = re.compile(r"(cell|pc|node|station)(?: (\d{1,9}))?(?: port (\d{1,9}))?")


def kind_of(link_type: int) -> str | None:
    """Whose frames have a link type; None = nobody's here."""
    known = networks().items()
    return next((name for name, network in known if network.link_type == link_type), None)


class Interface(NamedTuple):
    """An interface of a capture."""

    link_type: int  # of its frames
    name: str  # for people
    description: str  # as above


class Place(NamedTuple):
    """What an interface's description says of a link."""

    what: str  # "cell", "pc", "node", "station"; "" if it says nothing of the kind
    number: int  # which; -1 not said
    port: int  # of a cell or the PC, or a path of a live node; -1 not said
    here: str  # this end of the cable; "" not said
    there: str  # its other end


def describe(what: str, number: int = -1, port: int = -1, cable: tuple[str, str] = ("", "")) -> str:
    """What an interface is, as "cell 3 port 0; c3 to c4"."""
    text = what
    if number >= 0:
        text += f" {number}"
    if port >= 0:
        text += f" port {port}"
    return f"{text}; {cable[0]} to {cable[1]}" if cable[0] else text


def place_of(description: str) -> Place:
    """What a description says; any text will do."""
    first, _, cable = description.partition("; ")
    here, _, there = cable.partition(" to ")
    found = _FIRST.fullmatch(first)
    if found is None:
        return Place("", -1, -1, "", "")
    what, number, port = found.groups()
    return Place(what, int(number or -1), int(port or -1), here, there)
