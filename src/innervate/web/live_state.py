"""The state of running nodes as arrays over a map, from what they said last."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import cached_property
from typing import Any

import numpy as np

from innervate.analysis import headline as words
from innervate.analysis.headline import Headline
from innervate.analysis.ways import NOWHERE, Numbers, reach
from innervate.web.live_map import Link, Map, Place, Status, is_put_out

Told = Mapping[int, Status]


class State:
    """What is known of a network at one moment; networks that know more of it have their own.

    Args:
        where: its map.
        told: what the nodes said that answer now.
        off: places that were cut off whole; they count as off while nothing comes over any path.

    Attributes:
        node_up, link_up: 1 or 0.
        cut_off: per place whether its node answers and carries nothing.
        hop: per place the next one on its way, NOWHERE without one.
        root, depth: where its chain leads over live links, and how far that is.
        answers: per place whether its node answers.
        out: per place whether its node answers, and has an identity that is revoked.
        without: per place whether its node answers and has no way.
        unconnected: how many that answer have no way, those that are cut off whole too.
        lacking: how many of those could have one, as links that are up join them.
        left: how many could have one at all, with it or without: they answer and are joined.
    """

    noun = "node"
    # A node whose paths are all cut is off, whoever cut them: it has no others.
    is_off_when_cut = False

    def __init__(self, where: Map, told: Told, off: Collection[Place] = ()) -> None:
        self.map = where
        self.told = told
        self.answers = np.array([place.node in told for place in where.places], np.bool_)
        asked = where.places if self.is_off_when_cut else off
        self.cut_off = [place in asked and self._carries_nothing(place) for place in where.places]
        up = [p.node in told and not off for p, off in zip(where.places, self.cut_off, strict=True)]
        self.node_up: Numbers = np.array(up, np.int64)
        self.link_up: Numbers = np.array([self._is_up(link) for link in where.links], np.int64)
        self.out = np.array([place.node in self.put_out for place in where.places], np.bool_)
        self.without = self.out
        self.hop = self.depth = self.root = np.full(len(where.places), NOWHERE)
        self.unconnected, self.lacking, self.left = self.look()

    def look(self) -> tuple[int, int, int]:
        """Find everybody's way; (who has none, who of those could have one, who at all could).

        Of nodes that do not say what their ways are, those have one whom links that are up join
        with the first one that answers, and on which something comes where it has to.
        """
        on = np.flatnonzero((self.node_up == 1) & ~self.out)
        if not self.map.links or not len(on):
            return int(np.count_nonzero(self.without)), 0, len(on)
        first = np.zeros(len(self.node_up), np.bool_)
        first[on[0]] = True
        live, beyond = self.live(self._is_heard), self.hears_beyond()
        joined = reach(live, first)
        if (joined & beyond).any():  # others, of whom nothing is known here, can join them
            joined = reach(live, first | beyond)
        joined &= ~self.out
        with_it = np.count_nonzero(joined) - 1
        self.without = ~joined & self.answers
        return int(np.count_nonzero(self.without)), 0, int(with_it)

    def hears_beyond(self) -> Any:
        """Per place whether it hears somebody who does not run here."""
        hearing = {place for place, _ in self.paths_beyond}
        return np.array([place in hearing for place in self.map.places], np.bool_)

    @cached_property
    def paths_beyond(self) -> set[tuple[Place, int]]:
        """Paths on which somebody is heard, by cables to nobody who runs here.

        Where no path has a name that its far end knows, too, nobody's cables are known.
        """
        ends = ((link.a, link.paths_a, link.b, link.paths_b) for link in self.map.links)
        inside = {(at, port) for a, paths_a, b, paths_b in ends
                  for at, paths in ((a, paths_a), (b, paths_b)) for port in paths}  # fmt: skip
        heard = {
            (self.map.place(i, int(path["port"])), int(path["port"]))
            for i, one in self.told.items()
            for path in one.get("paths", ())
            if path["up"]
            and path.get("heard_s") is not None
            and not path.get("broken")
            and (path.get("own") or self.map.links)
        }
        return heard - inside

    @cached_property
    def put_out(self) -> set[int]:
        """Nodes that answer and have an identity that is revoked."""
        return {i for i, one in self.told.items() if is_put_out(one)}

    @property
    def apart(self) -> int:
        """How many no links join with the others, without those cut off whole, or put out."""
        known = self.out | np.array(self.cut_off, np.bool_)
        return max(0, int(np.count_nonzero(self.without & ~known)) - self.lacking)

    def without_words(self) -> str:
        """Who has no way whatever anybody does: "2 that are cut off"; "" nobody."""
        if not self.unconnected:
            return ""
        out = self.without & self.out
        what = "cut off" if not out.any() else "put out" if out[self.without].all() else ""
        are = "is" if self.unconnected == 1 else "are"
        return f"{self.unconnected} that {are} {what or 'cut off or put out'}"

    def changed_links(self, now: State) -> list[tuple[Link, bool]]:
        """Links that were cut or put back since, while their ends went on answering.

        Those of who was put out since were not cut.
        """
        key, out = now.map.key, now.put_out - self.put_out
        were = dict(zip(map(key, self.map.links), self.link_up.tolist(), strict=True))
        return [
            (link, bool(up))
            for link, up in zip(now.map.links, now.link_up.tolist(), strict=True)
            if were.get(key(link), up) != up
            and self.is_told(now, link.a, link.b)
            and not out & {link.a.node, link.b.node}
        ]

    def changed_places(self, now: State) -> list[tuple[Place, bool]]:
        """Nodes that were cut off or let back since, by whoever it was, while they answered."""
        if not self.is_off_when_cut:
            return []
        were = dict(zip(self.map.places, self.cut_off, strict=True))
        return [
            (place, not off)
            for place, off in zip(now.map.places, now.cut_off, strict=True)
            if were.get(place, off) != off and self.is_told(now, place)
        ]

    def is_told(self, now: State, *places: Place) -> bool:
        """True if these answered before, and do now."""
        return all(place.node in told for place in places for told in (self.told, now.told))

    def headline(self) -> Headline:
        """Is all well, as far as these nodes say."""
        if not self.told:
            return words.silent(len({place.node for place in self.map.places}), self.noun)
        return self.judge()

    def judge(self) -> Headline:
        """The headline while somebody answers."""
        count, off = len(self.node_up), tuple(np.flatnonzero(self.node_up == 0).tolist())
        out, said = np.flatnonzero(self.out), []
        if off:
            are = (
                "does not answer or is cut off" if len(off) == 1 else "do not answer or are cut off"
            )
            said.append(f"{len(off):,} of {count:,} {self.noun}s {are}")
        elif apart := int(np.count_nonzero(self.without & ~self.out)):
            said.append(f"no links join {apart:,} of {count:,} {self.noun}s with the others")
        if len(out):
            said.append(words.put_out(words.part_of(len(out), count, self.noun), len(out)))
        if said:
            level = words.DOWN if len(out) and self.out[self.answers].all() else words.DEGRADED
            return Headline(level, words.sentence(said), tuple(sorted({*off, *out.tolist()})))
        who = words.every(count, self.noun)
        return Headline(words.OK, f"{who[0].upper()}{who[1:]} answer{'s' if count == 1 else ''}.")

    def word(self, place: Place, name: str, otherwise: Any) -> Any:
        """What a node says of itself."""
        return self.told.get(place.node, {}).get(name, otherwise)

    def _carries_nothing(self, place: Place) -> bool:
        paths = [path["up"] for path in self.word(place, "paths", ())
                 if place.port in (-1, path["port"])]  # fmt: skip
        return bool(paths) and not any(paths)

    def _is_up(self, link: Link) -> bool:
        """Both ends answer, are members, and were not told to drop what comes over the link.

        A node that drops all that comes forgets by which paths it heard whom.
        """
        return self.carries(link.a, link.paths_a) and self.carries(link.b, link.paths_b)

    def carries(self, place: Place, paths: Collection[int]) -> bool:
        """This end of a link that goes by these paths, or by any if they are not known, is up."""
        if place.node not in self.told or is_put_out(self.told[place.node]):
            return False
        if self._carries_nothing(place):
            return False
        up = {path["port"]: path["up"] for path in self.word(place, "paths", ())}
        return not paths or any(up.get(path, True) for path in paths)

    def _is_heard(self, link: Link) -> bool:
        """At both ends something comes, as often as their protocol says."""
        ends = ((link.a, link.paths_a), (link.b, link.paths_b))
        return all(
            not path.get("broken") or path["port"] not in paths
            for place, paths in ends
            for path in self.word(place, "paths", ())
        )

    def live(self, counts: Callable[[Link], bool] = lambda _: True) -> Any:
        """A matrix of flags: who is joined to whom by a link that is up, of those that count."""
        count, number = len(self.map.places), self.map.number
        found = np.zeros((count, count), np.bool_)
        for link, up in zip(self.map.links, self.link_up.tolist(), strict=True):
            a, b = number[link.a], number[link.b]
            found[a, b] = found[b, a] = found[a, b] or (up and counts(link))
        return found

    def fields(self) -> dict[str, Any]:
        """The state's fields for pages."""
        return {
            "node_up": self.node_up,
            "link_up": self.link_up,
            "cut_off": [int(off) for off in self.cut_off],
            "put_out": self.out.astype(np.int64),
            "unconnected": self.unconnected if self.told else None,
            "flights": [],
            **self.more(),
        }

    def more(self) -> dict[str, Any]:
        """Fields that only this network has: what its nodes declare and say of themselves."""
        said = [self.word(place, "fields", {}) for place in self.map.places]
        names = {name for one in said for name, value in one.items() if isinstance(value, int)}
        return {"fields": {name: [one.get(name) for one in said] for name in sorted(names)}}
