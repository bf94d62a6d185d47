"""The state of running nodes as arrays over a map, from what they said last."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from innervate.analysis.ways import NOWHERE, Numbers, follow
from innervate.web.live_map import Link, Map, Place, Status

LOAD_FULL = 66  # cells whose samples fill a link, at 250 Hz each
QUEUE = 16
IDLE, SENDS, WAITS = 0, 1, 4  # what a station does, as pages count it

Told = Mapping[int, Status]


class State:
    """What is known of a network at one moment.

    Args:
        where: its map.
        told: what the nodes said that answer now.
        off: places that were cut off whole; they count as off while nothing comes over any path.

    Attributes:
        node_up, link_up: 1 or 0.
        cut_off: per place whether its node answers and carries nothing.
        hop: per place the next one on its way, NOWHERE without one.
        root, depth: where its chain leads over live links, and how far that is.
        unconnected: how many that answer have no way; of a radio team, how many are off.
    """

    def __init__(self, where: Map, told: Told, off: Collection[Place] = ()) -> None:
        self._map = where
        self._told = told
        # A station has nothing but its place on the channel: without it, it is off.
        asked = where.places if where.kind == "radio" else off
        self.cut_off = [place in asked and self._carries_nothing(place) for place in where.places]
        up = [p.node in told and not off for p, off in zip(where.places, self.cut_off, strict=True)]
        self.node_up: Numbers = np.array(up, np.int64)
        self.link_up: Numbers = np.array([self._is_up(link) for link in where.links], np.int64)
        self.hop = self._hops()
        nodes = np.arange(len(where.places))
        live = self._live()[nodes, np.maximum(self.hop, 0)]
        self.root, self.depth = follow(np.where(live, self.hop, NOWHERE), self._roots())
        lost = (self.root == NOWHERE) & (self.node_up == 1)
        if where.kind == "skin" and not where.links:  # cables unknown: what cells say has to do
            lost = np.array([self._word(place, "parent", 0) is None for place in where.places])
        if where.kind == "radio":  # everybody hears everybody, or nobody
            lost = self.node_up == 0
        self.unconnected = int(np.count_nonzero(lost))

    def _word(self, place: Place, name: str, otherwise: Any) -> Any:
        """What a node says of itself."""
        return self._told.get(place.node, {}).get(name, otherwise)

    def _carries_nothing(self, place: Place) -> bool:
        paths = [path["up"] for path in self._word(place, "paths", ())
                 if place.port in (-1, path["port"])]  # fmt: skip
        return bool(paths) and not any(paths)

    def _is_up(self, link: Link) -> bool:
        """Both ends answer, and neither has been told to drop what comes over the link."""
        for place, paths in ((link.a, link.paths_a), (link.b, link.paths_b)):
            if place.node not in self._told:
                return False
            up = {path["port"]: path["up"] for path in self._word(place, "paths", ())}
            if paths and not any(up.get(path, True) for path in paths):
                return False
        return True

    def _live(self) -> Any:
        """A matrix of flags: who is joined to whom by a link that is up."""
        count, number = len(self._map.places), self._map.number
        found = np.zeros((count, count), np.bool_)
        for link, up in zip(self._map.links, self.link_up.tolist(), strict=True):
            a, b = number[link.a], number[link.b]
            found[a, b] |= bool(up)
            found[b, a] |= bool(up)
        return found

    def _roots(self) -> Any:
        """Where ways lead: the PC's ports, or whoever leads; everybody of a radio team."""
        places = self._map.places
        if self._map.kind == "radio":
            return self.node_up == 1
        found = [place.port >= 0 or self._word(place, "role", "") == "gateway" for place in places]
        return np.array(found, np.bool_) & (self.node_up == 1)

    def _hops(self) -> Numbers:
        number = self._map.number
        found = np.full(len(self._map.places), NOWHERE, np.int64)
        if self._map.kind == "skin":
            across = {}
            for link in self._map.links:
                across.update({(link.a, path): link.b for path in link.paths_a})
                across.update({(link.b, path): link.a for path in link.paths_b})
        by_number = self._map.numbered(self._told)
        for at, place in enumerate(self._map.places):
            to = None
            if self._map.kind == "skin" and place.port < 0:
                ports = {port["port"]: port.get("path") for port in self._word(place, "ports", ())}
                path = ports.get(self._word(place, "parent", None))
                to = None if path is None else across.get((place, path))
            elif self._map.kind == "mesh":
                to = by_number.get(_next_hop(self._told.get(place.node, {})))
            found[at] = NOWHERE if to is None else number[to]
        return found

    def fields(self) -> dict[str, Any]:
        """The state's fields that are there for this kind."""
        places = self._map.places
        found: dict[str, Any] = {
            "node_up": self.node_up,
            "link_up": self.link_up,
            "cut_off": [int(off) for off in self.cut_off],
            "unconnected": self.unconnected,
            "flights": [],
        }
        if self._map.kind == "radio":
            queued = [self._word(place, "queued", 0) for place in places]
            turn = [self._word(place, "place", None) for place in places]
            found["load"] = (np.array(queued) / QUEUE).round(3)
            found["radio"] = {
                "now": [
                    SENDS
                    if self._word(place, "radio", "") == "sending"
                    else WAITS
                    if count
                    else IDLE
                    for place, count in zip(places, queued, strict=True)
                ],
                "turn": [-1 if at is None else at for at in turn],
            }
            return found
        found |= {"parent": self.hop, "depth": self.depth}
        if self._map.kind == "skin":
            port = [place.port for place in places]
            found["port"] = np.where(self.root == NOWHERE, NOWHERE, np.take(port, self.root))
            load = np.array([self._word(place, "load", 0) for place in places]) / LOAD_FULL
            found["load"] = np.minimum(load, 1.0).round(3)
        return found


def _next_hop(one: Status) -> int:
    """The number of the node that a mesh node would hand a packet for its gateway, or NOWHERE."""
    gateway = one.get("gateway")
    if gateway is None or gateway == one.get("number"):
        return NOWHERE
    doubted = {near["node"] for near in one["neighbours"] if near["suspect"]}
    known = {near["node"] for near in one["neighbours"]}
    ways = [*one["routes"].get(str(gateway), ()), gateway]
    return next((way for way in ways if way in known and way not in doubted), NOWHERE)
