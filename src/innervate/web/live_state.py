"""The state of running nodes as arrays over a map, from what they said last."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from innervate.analysis.headline import Headline, silent
from innervate.analysis.mesh_headline import headline
from innervate.analysis.mesh_reach import Choices, Ways, ways
from innervate.analysis.radio_headline import headline as radio_headline
from innervate.analysis.radio_live import of_stations
from innervate.analysis.skin_headline import SkinFacts, skin_headline
from innervate.analysis.ways import NOWHERE, Numbers, follow, reach
from innervate.web.live_map import Link, Map, Place, Status

LOAD_FULL = 66  # cells whose samples fill a link, at 250 Hz each
QUEUE = 16
IDLE, SENDS, WAITS = 0, 1, 4  # what a station does, as pages count it

NAMES = {"skin": "node", "mesh": "node", "radio": "station"}

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
        lacking: how many of those could have one, as links that are up join them.
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
        self.unconnected, self.lacking = self._look()

    def _look(self) -> tuple[int, int]:
        """Find everybody's way; (who has none, who of those could have one)."""
        where = self._map
        count = len(where.places)
        none = np.zeros(count, np.bool_)
        if where.kind == "radio":  # everybody hears everybody, or nobody
            self.hop = self.depth = self.root = np.full(count, NOWHERE)
            return int(np.count_nonzero(self.node_up == 0)), 0
        if where.kind == "mesh":
            self.ways = self._mesh_ways()
            self.hop, self.depth = self.ways.hop, self.ways.depth
            self.root = np.full(count, NOWHERE)
            found = self.ways.without & (self.node_up == 1), self.ways.astray
            return int(np.count_nonzero(found[0])), int(np.count_nonzero(found[1]))
        self.hop = self._parents()
        live, roots = self._live(), self._ports()
        self.root, self.depth = follow(
            np.where(live[np.arange(count), np.maximum(self.hop, 0)], self.hop, NOWHERE), roots
        )
        lost = (self.root == NOWHERE) & (self.node_up == 1)
        if not where.links:  # cables unknown: what cells say has to do
            lost = np.array([self._word(place, "parent", 0) is None for place in where.places])
        joined = reach(live, roots) if where.links else ~none
        self._skin = self._skin_facts(lost, joined)
        return int(np.count_nonzero(lost)), int(np.count_nonzero(lost & joined))

    def _skin_facts(self, lost: Any, joined: Any) -> SkinFacts:
        """What cells say of their ways; `joined`: cables join them with the PC."""
        places = self._map.places
        is_cell = np.array([place.port < 0 for place in places], np.bool_)
        told = np.array([place.node in self._told for place in places], np.bool_)
        apart = told & (~joined | np.array(self.cut_off, np.bool_))
        ports = told[~is_cell]

        def of(flags: Any) -> list[int]:
            found: list[int] = np.flatnonzero(is_cell & flags).tolist()
            return found

        return SkinFacts(
            cells=int(np.count_nonzero(is_cell)),
            silent=of(~told),
            cut_off=of(apart),
            seeking=of(told & lost & ~apart),
            pc_off=bool(len(ports)) and not ports.any(),
        )

    def changed_links(self, now: State) -> list[tuple[Link, bool]]:
        """Links that were cut or put back since, while their ends went on answering."""
        key = now._map.key
        were = dict(zip(map(key, self._map.links), self.link_up.tolist(), strict=True))
        return [
            (link, bool(up))
            for link, up in zip(now._map.links, now.link_up.tolist(), strict=True)
            if were.get(key(link), up) != up and self._answered(now, link.a, link.b)
        ]

    def changed_places(self, now: State) -> list[tuple[Place, bool]]:
        """Stations that were cut off from their channel or let back since, while they answered."""
        if self._map.kind != "radio":
            return []
        were = dict(zip(self._map.places, self.cut_off, strict=True))
        return [
            (place, not off)
            for place, off in zip(now._map.places, now.cut_off, strict=True)
            if were.get(place, off) != off and self._answered(now, place)
        ]

    def _answered(self, now: State, *places: Place) -> bool:
        return all(place.node in told for place in places for told in (self._told, now._told))

    def headline(self, still_ms: float) -> Headline:
        """Is all well, as far as these nodes say.

        Args:
            still_ms: for how long stations that had a packet have delivered nothing.
        """
        kind, places = self._map.kind, self._map.places
        if not self._told:
            return silent(len({place.node for place in places}), NAMES[kind])
        if kind == "mesh":
            return headline(self.ways, absent="silent")
        if kind == "radio":
            told = {at: self._told[p.node] for at, p in enumerate(places) if p.node in self._told}
            off = tuple(np.flatnonzero(self.node_up == 0).tolist())
            timing = next(iter(told.values()))["timing"]
            return radio_headline(of_stations(told, len(places), off, still_ms, timing))
        return skin_headline(self._skin)

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

    def _ports(self) -> Any:
        """Where a skin's ways lead: the PC's ports."""
        found = [place.port >= 0 for place in self._map.places]
        return np.array(found, np.bool_) & (self.node_up == 1)

    def _parents(self) -> Numbers:
        """Per place of a skin the one that its cell sends to."""
        number = self._map.number
        found = np.full(len(self._map.places), NOWHERE, np.int64)
        across = {}
        for link in self._map.links:
            across.update({(link.a, path): link.b for path in link.paths_a})
            across.update({(link.b, path): link.a for path in link.paths_b})
        for at, place in enumerate(self._map.places):
            if place.port < 0:
                ports = {port["port"]: port.get("path") for port in self._word(place, "ports", ())}
                path = ports.get(self._word(place, "parent", None))
                to = None if path is None else across.get((place, path))
                found[at] = NOWHERE if to is None else number[to]
        return found

    def _mesh_ways(self) -> Ways:
        """Who of a mesh reaches its gateway."""
        places, count = self._map.places, len(self._map.places)
        numbered = self._map.numbered(self._told).items()
        place_of: dict[Any, int] = {name: self._map.number[at] for name, at in numbered}
        on = np.array([place.node in self._told for place in places], np.bool_)
        said = [self._told.get(place.node, {}) for place in places]
        onward = [
            [place_of[who] for who in one.get("onward", ()) if who in place_of] for one in said
        ]
        wide = max(1, *map(len, onward))
        near = np.zeros((count, count), np.bool_)
        for at, one in enumerate(said):
            to = [place_of.get(other["node"], at) for other in one.get("neighbours", ())]
            near[at, to] = True
        known = Choices(
            gateway=np.array([place_of.get(one.get("gateway"), NOWHERE) for one in said]),
            named=np.array([row + [NOWHERE] * (wide - len(row)) for row in onward]),
            near=near,
            goes_back=all(one.get("gives_back", True) for one in said),
        )
        leads = np.array([one.get("role") == "gateway" for one in said], np.bool_)
        return ways(known, self._live(), on, ~on, leads)

    def fields(self) -> dict[str, Any]:
        """The state's fields that are there for this kind."""
        places = self._map.places
        found: dict[str, Any] = {
            "node_up": self.node_up,
            "link_up": self.link_up,
            "cut_off": [int(off) for off in self.cut_off],
            "unconnected": self.unconnected if self._told else None,
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
        if self._map.kind == "mesh":
            found |= {"way": self.ways.lacks, "apart": int(self.ways.cut_off.sum())}
        if self._map.kind == "skin":
            port = [place.port for place in places]
            found["port"] = np.where(self.root == NOWHERE, NOWHERE, np.take(port, self.root))
            load = np.array([self._word(place, "load", 0) for place in places]) / LOAD_FULL
            found["load"] = np.minimum(load, 1.0).round(3)
        return found
