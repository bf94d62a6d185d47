"""Who is linked with whom among running nodes, as far as their own words tell."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from innervate.analysis.spread import spread

Status = dict[str, Any]


class Place(NamedTuple):
    """A node on the map: a running node, or one port of a node that is drawn by its ports."""

    node: int  # which running node it is
    port: int  # which port it is; -1 for a node as a whole


class Link(NamedTuple):
    """A link between two places, with the paths of either end that carry it, if they are known."""

    a: Place
    b: Place
    paths_a: tuple[int, ...]
    paths_b: tuple[int, ...]


class Map:
    """Places and links of a network, from what its nodes said.

    Args:
        told: what they said, by their index.
        before: a map that this one takes the place of: a link that nobody names any more stays.

    Attributes:
        places: the map's nodes; those that are ports of a node come last.
        names: what their nodes are called.
        links: in order of their places.
    """

    def __init__(self, told: Mapping[int, Status], before: Map | None = None) -> None:
        ports = [
            Place(i, int(path["port"]))
            for i, one in sorted(told.items())
            if self.is_split(one)
            for path in one["paths"]
        ]
        plain = [Place(i, -1) for i, one in sorted(told.items()) if not self.is_split(one)]
        self.places = [*plain, *ports]
        self.number = {place: at for at, place in enumerate(self.places)}
        self.names = [str(told[place.node].get("name", place.node)) for place in self.places]
        named = self.find_links(told)
        known = {self.key(link): link for link in (*(before.links if before else ()), *named)}
        self.links: list[Link] = sorted(known.values())

    def key(self, what: Link | Place) -> tuple[Any, ...]:
        """What a link or place is known by; two nodes can have two cables."""
        return tuple(what)

    def is_split(self, one: Status) -> bool:
        """True if every port of a node is a place of its own."""
        return False

    def place(self, index: int, path: int) -> Place:
        """The place that a path of a node belongs to."""
        port = Place(index, path)
        return port if port in self.number else Place(index, -1)

    def numbered(self, told: Mapping[int, Status]) -> dict[int, Place]:
        """Places by the number that nodes know each other by."""
        return {int(one["number"]): Place(i, -1) for i, one in told.items() if "number" in one}

    def find_links(self, told: Mapping[int, Status]) -> list[Link]:
        """Cables whose ends name each other: each is called what the other is at home."""
        ends: dict[tuple[str, str], list[tuple[str, str, int, int]]] = {}
        for i, one in told.items():
            for path in one.get("paths", ()):
                own, far = str(path.get("own", "")), str(path.get("far", path["name"]))
                if own:
                    key = (_port(own), _port(far))
                    ends.setdefault(key, []).append((own, far, i, int(path["port"])))
        found = []
        for (near, away), here in ends.items():
            for own, far, i, port in here:
                for their_own, their_far, j, their_port in ends.get((away, near), ()):
                    if not (_fits(own, their_far) and _fits(their_own, far)):
                        continue
                    a, b = self.place(i, port), self.place(j, their_port)
                    if self.number[a] < self.number[b]:
                        found.append(Link(a, b, (port,), (their_port,)))
        return found

    def spread(self) -> Any:
        """x, y of every place: as far apart as they are in hops, about one from the next."""
        pairs = [(self.number[link.a], self.number[link.b]) for link in self.links]
        return spread(len(self.places), pairs)


def is_put_out(one: Status) -> bool:
    """True if the node's own identity stands in the list of those whom nobody answers any more."""
    identity = (one.get("keys") or {}).get("identity") or {}
    return identity.get("serial") in identity.get("revoked", ())


def _port(address: str) -> str:
    return address.rpartition(":")[2]


def _fits(own: str, far: str) -> bool:
    """True if `far` can be what the other end calls `own`: the same, or any address of here."""
    is_any = own.split(" ")[-1].startswith(("0.0.0.0:", "[::]:"))
    return own == far or (is_any and _port(own) == _port(far))
