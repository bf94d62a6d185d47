"""Networks that were measured, or are published: who hears whom how well.

Three forms are read. JSON as community meshes publish it: `links` with `source`, `target`,
`source_tq`, `target_tq` (the share of frames that arrives at that end) and `type`, and `nodes` with
`id` and perhaps `x` (latitude) and `y` (longitude) in degrees; their servers' `meshviewer.json` has
`node_id` and `location` with `latitude` and `longitude` instead. Plain lines `A B 0.9 0.7`: two
names, the quality from A to B and back; one number stands for both, none for 1. And the networks
of the package topohub, by name.
"""

from __future__ import annotations

import json
import math
from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from innervate.topology.errors import TopologyError
from innervate.topology.placement import Point, components, neighbours
from innervate.topology.unseen import unseen

SIZE_MAX = 64 * 1024 * 1024
EARTH_CM = 637_100_000
NAME_MAX = 200  # characters
Quality = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Measured:
    """A network as it was found."""

    names: list[str]  # per node
    # (a, b) with a < b -> quality from a to b, and from b to a, 0 .. 1.
    links: dict[tuple[int, int], Quality]
    # Per node (x, y) in cm, x to the east, y to the north; empty where nobody's place is known. Who
    # has none is put amidst its neighbours.
    points: list[Point]

    def kept(self, least: float) -> Measured:
        """Without links that are worse in one direction, and without nodes that have no link.

        Raises:
            TopologyError: nothing is left.
        """
        links = {pair: both for pair, both in self.links.items() if min(both) >= least}
        if not self.links:
            raise TopologyError("holds no links", "file")
        if not links:
            best = max(min(both) for both in self.links.values())
            raise TopologyError(
                f"no link has a quality of {least:g} or better both ways: the best has {best:g}; "
                "lower min_tq",
                "min_tq",
            )
        return self._only({node for pair in links for node in pair}, links)

    def largest(self) -> Measured:
        """Its largest part that holds together by links that work both ways."""
        return self._only(set(components(self._near())[0]), self.links)

    def best_connected(self) -> int:
        """The node with the most links that work both ways; of several the first."""
        degrees = [len(near) for near in self._near()]
        return degrees.index(max(degrees))

    def around(self, start: int, most: int) -> Measured:
        """At most so many nodes, from `start` on: fewer hops first, then by the better link.

        They hold together by links that work both ways.
        """
        near, line = self._near(), {start: None}
        ring = [start]
        while ring and len(line) < most:
            outer = sorted(
                (-min(self.links[min(node, other), max(node, other)]), other)
                for node in ring
                for other in near[node]
                if other not in line
            )
            ring = list(dict.fromkeys(other for _, other in outer))
            line |= dict.fromkeys(ring)
        return self._only(set(list(line)[:most]), self.links)

    def _near(self) -> list[list[int]]:
        """Per node whom links lead to that work both ways."""
        links = [pair for pair, both in self.links.items() if min(both) > 0]
        return neighbours(len(self.names), links)

    def least_for(self, most: int, *, in_one: bool) -> float | None:
        """The least quality, in hundredths, with which `kept` leaves at most so many nodes.

        With `in_one` those of the largest part count. None where no quality leaves any.
        """

        def left(least: float) -> int:
            some = self.kept(least)
            return len((some.largest() if in_one else some).names)

        best = max((min(both) for both in self.links.values()), default=0.0)
        fewest = next(step for step in range(101, -1, -1) if step / 100 <= best)
        steps = range(fewest + 1) if self.links else range(0)
        fitting = bisect_left(steps, -most, key=lambda step: -left(step / 100))
        return steps[fitting] / 100 if fitting < len(steps) else None

    def _only(self, kept: set[int], links: dict[tuple[int, int], Quality]) -> Measured:
        order = sorted(kept)
        number = {old: new for new, old in enumerate(order)}
        return Measured(
            [self.names[old] for old in order],
            {(number[a], number[b]): both for (a, b), both in links.items()
             if a in kept and b in kept},
            [self.points[old] for old in order] if self.points else [],
        )  # fmt: skip


def read(path: Path, types: Iterable[str] = ()) -> Measured:
    """The network of a file.

    Args:
        path: JSON or plain lines.
        types: the types of links that count; none = all. Links without a type count always.

    Raises:
        TopologyError: not readable, or not of one of these forms; says where.
    """
    try:
        if path.exists() and not path.is_file() and not path.is_dir():  # a pipe is read only once
            message = f"{path}: is no plain file, and every run reads it again; save it as one"
            raise TopologyError(message, "file")
        with path.open("rb") as file:
            content = file.read(SIZE_MAX + 1)
    except OSError as error:
        raise TopologyError(f"{path}: cannot be read: {error.strerror or error}", "file") from None
    except ValueError:
        raise TopologyError("this is no name of a file", "file") from None
    if len(content) > SIZE_MAX:
        raise TopologyError(f"{path}: is too large for a network (over 64 MiB)", "file")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise TopologyError(f"{path}: is not UTF-8 text", "file") from None
    try:
        return from_json(text, types) if text.lstrip()[:1] == "{" else from_lines(text)
    except TopologyError as error:
        raise TopologyError(f"{path}: {error}", error.subject) from None


def from_json(text: str, types: Iterable[str] = ()) -> Measured:
    """The network of a text in the form of community meshes.

    Raises:
        TopologyError: see read().
    """
    try:
        tables = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise TopologyError(f"not valid JSON: {str(error)[:100]}", "file") from None
    nodes, links = tables.get("nodes"), tables.get("links")
    if not isinstance(nodes, list) or not isinstance(links, list):
        raise TopologyError('lacks the lists "nodes" and "links"', "file")
    number, degrees = _numbered(nodes)
    found = _joined(links, number, list(types))
    return Measured(list(number), found, _metres(degrees, found))


def _numbered(nodes: list[Any]) -> tuple[dict[str, int], list[tuple[float, float] | None]]:
    """Each name's number, and where it lies; a name that is there twice is one node."""
    number: dict[str, int] = {}
    degrees: list[tuple[float, float] | None] = []
    for i, node in enumerate(nodes):
        name = _name(node.get("id", node.get("node_id")) if isinstance(node, dict) else None)
        if name is None:
            raise TopologyError(f'node {i} has no "id" that is a number or a string', "file")
        if problem := _unnameable(name):
            raise TopologyError(f'the "id" of node {i} {problem}', "file")
        place = _degrees(node, i)
        if name not in number:
            number[name] = len(degrees)
            degrees.append(place)
        elif degrees[number[name]] is None:  # links tell nodes by their ids: it is the same one
            degrees[number[name]] = place
    return number, degrees


def _name(given: Any) -> str | None:
    """What a node is called by its id: 7 and "7" are the same; None if that is no name."""
    return str(given) if isinstance(given, int | str) and not isinstance(given, bool) else None


def _unnameable(name: str) -> str:
    """Why nobody can be called so in a scenario, on a terminal and in a report; "" if one can."""
    if not name.strip():
        return "is empty; name it"
    if wrong := unseen(name):
        return wrong
    return f"is longer than {NAME_MAX} characters; shorten it" if len(name) > NAME_MAX else ""


def _joined(
    links: list[Any], number: dict[str, int], wanted: list[str]
) -> dict[tuple[int, int], Quality]:
    """The links of the wanted types (all if none are named), with their qualities."""
    found: dict[tuple[int, int], Quality] = {}
    others: dict[str, None] = {}
    for i, link in enumerate(links):
        if not isinstance(link, dict):
            raise TopologyError(f"link {i} is no table", "file")
        if wanted and link.get("type", None) not in (*wanted, None):
            others[str(link["type"])[:40]] = None
            continue
        a, b = (_known(number, link, i, side) for side in ("source", "target"))
        # What arrives at the target is the quality from source to target, and the other way round.
        _join(found, a, b, _share(link, i, "target_tq"), _share(link, i, "source_tq"), f"link {i}")
    if others and not found:
        there = ", ".join(list(others)[:4])
        asked = " or ".join(one[:40] or '""' for one in wanted[:4])
        raise TopologyError(f"no link is of type {asked}; there is {there}", "types")
    return found


def _known(number: dict[str, int], link: dict[str, Any], i: int, side: str) -> int:
    if link.get(side) is None:
        raise TopologyError(f'link {i} has no "{side}"; name a node', "file")
    end = _name(link[side])
    if end is None or end not in number:
        raise TopologyError(f"link {i} leads to {str(link[side])[:40]}, which is no node", "file")
    return number[end]


def _share(link: dict[str, Any], i: int, key: str) -> float:
    value = link.get(key, 1)
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= 1:
        raise TopologyError(f"{key} of link {i} must be 0 to 1, not {str(value)[:40]}", "file")
    return float(value)


def _degrees(node: dict[str, Any], i: int) -> tuple[float, float] | None:
    """Where a node is; what its owner typed for a map and is not on the Earth counts as none."""
    place = node.get("location")
    if isinstance(place, dict):
        latitude, longitude = place.get("latitude"), place.get("longitude")
    else:
        latitude, longitude = node.get("x"), node.get("y")
    if latitude is None or longitude is None:
        return None
    if _is_angle(latitude, 90) and _is_angle(longitude, 180):
        return float(latitude), float(longitude)
    if isinstance(place, dict):
        return None
    raise TopologyError(f"x or y of node {i} is no number of degrees", "file")


def _is_angle(value: Any, most: int) -> bool:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and -most <= value <= most


def _join(
    found: dict[tuple[int, int], Quality], a: int, b: int, there: float, back: float, where: str
) -> None:
    """Add a link; of two between the same nodes the better one counts."""
    if a == b:
        raise TopologyError(f"{where} joins a node with itself", "file")
    pair, both = ((a, b), (there, back)) if a < b else ((b, a), (back, there))
    old = found.get(pair, (0.0, 0.0))
    found[pair] = (max(old[0], both[0]), max(old[1], both[1]))


def from_lines(text: str) -> Measured:
    """The network of plain lines "A B 0.9 0.7"; # starts a comment.

    Raises:
        TopologyError: see read().
    """
    number: dict[str, int] = {}
    found: dict[tuple[int, int], Quality] = {}
    lines: dict[frozenset[str], int] = {}
    for line_number, line in enumerate(text.splitlines(), 1):
        words = line.partition("#")[0].split()
        if not words:
            continue
        where = f"line {line_number}"
        try:
            shares = [float(word) for word in words[2:]] or [1.0]
        except ValueError:
            shares = [-1.0]
        if not 2 <= len(words) <= 4 or not all(0 <= share <= 1 for share in shares):
            raise TopologyError(f'{where} is no link; write "A B 0.9 0.7"', "file")
        if problem := _unnameable(words[0]) or _unnameable(words[1]):
            raise TopologyError(f"a name in {where} {problem}", "file")
        first = lines.setdefault(frozenset(words[:2]), line_number)
        if first < line_number:
            message = f"{where} joins {words[0]} and {words[1]}, as line {first} does; "
            raise TopologyError(f"{message}put both qualities into one line", "file")
        a, b = (number.setdefault(word, len(number)) for word in words[:2])
        _join(found, a, b, shares[0], shares[-1], where)
    if not found:
        raise TopologyError("holds no links", "file")
    return Measured(list(number), found, [])


def from_topohub(name: str) -> Measured:
    """A network of the package topohub; its links are perfect.

    Raises:
        TopologyError: the package is missing, or has no such network.
    """
    try:
        import topohub
    except ImportError:
        message = "needs the package topohub; install it with: pip install 'innervate[topohub]'"
        raise TopologyError(message, "topohub") from None
    try:
        tables = topohub.get(name)
    except Exception:  # whatever a file that is not there leads to inside
        message = f'topohub has no network "{name[:60]}"; they are called like "sndlib/germany50"'
        raise TopologyError(message, "topohub") from None
    number = {node["id"]: i for i, node in enumerate(tables["nodes"])}
    found: dict[tuple[int, int], Quality] = {}
    for i, edge in enumerate(tables.get("edges") or tables["links"]):
        if edge["source"] != edge["target"]:
            _join(found, number[edge["source"]], number[edge["target"]], 1.0, 1.0, f"link {i}")
    # A place is [longitude, latitude] there.
    places = [tuple(node["pos"])[::-1] if "pos" in node else None for node in tables["nodes"]]
    names = _different([str(node.get("name", node["id"])) for node in tables["nodes"]])
    for i, one in enumerate(names):
        if problem := _unnameable(one):
            raise TopologyError(f"the name of node {i} {problem}", "topohub")
    return Measured(names, found, _metres(places, found))


def _different(names: list[str]) -> list[str]:
    """Names, with their number behind those that are there more than once."""
    return [name if names.count(name) == 1 else f"{name}-{i}" for i, name in enumerate(names)]


def _metres(
    degrees: list[tuple[float, float] | None], links: Iterable[tuple[int, int]]
) -> list[Point]:
    """Places in the plane around the middle of all, in cm."""
    located = [place for place in degrees if place is not None]
    if not located:
        return []
    middle = [sum(place[i] for place in located) / len(located) for i in (0, 1)]
    across = EARTH_CM * math.cos(math.radians(middle[0]))
    points: list[Point | None] = [
        place and (round(across * math.radians(place[1] - middle[1])),
                   round(EARTH_CM * math.radians(place[0] - middle[0])))
        for place in degrees
    ]  # fmt: skip
    near = neighbours(len(points), list(links))
    while True:
        new = {}
        for node, place in enumerate(points):
            around = [known for other in near[node] if (known := points[other]) is not None]
            if place is None and around:
                new[node] = (
                    sum(x for x, _ in around) // len(around),
                    sum(y for _, y in around) // len(around),
                )
        if not new:
            return [place or (0, 0) for place in points]
        for node, place in new.items():
            points[node] = place
