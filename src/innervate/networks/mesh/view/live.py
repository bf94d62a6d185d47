"""A running mesh on the page: who hears whom, who reaches the gateway."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from innervate.analysis.headline import Headline
from innervate.analysis.ways import NOWHERE
from innervate.networks.mesh.analysis.headline import headline
from innervate.networks.mesh.analysis.reach import Choices, Ways, ways
from innervate.networks.mesh.view.elsewhere import elsewhere, hand_on, without_it
from innervate.web.live_map import Link, Map, Place, Status
from innervate.web.live_scene import Drawn, Spot
from innervate.web.live_state import State
from innervate.web.live_view import LiveView

SAID = {"predict": "is about to cross the fence", "cross": "has crossed the fence",
        "lost": "is lost", "clear": "is inside again"}  # fmt: skip
LEVELS = {"clear": "good"}
LATE_S = 5.0  # alarms that are older when they are seen are told with their age


class MeshMap(Map):
    """Nodes and who of them hears whom."""

    # The places of nodes by the numbers that they know each other by.
    by_number: Mapping[int, Place]

    def key(self, what: Link | Place) -> tuple[Any, ...]:
        """Two nodes hear each other, or not; the paths of a link come and go."""
        return what[:2]

    def find_links(self, told: Mapping[int, Status]) -> list[Link]:
        """Neighbours that hear each other, at least one way."""
        self.by_number = places = self.numbered(told)
        ports: dict[tuple[Place, Place], tuple[int, ...]] = {}
        for i, one in told.items():
            for near in one["neighbours"]:
                if near["node"] in places:
                    ports[Place(i, -1), places[near["node"]]] = tuple(near["ports"])
        pairs = {(min(pair), max(pair)) for pair in ports if pair[0] != pair[1]}
        return [Link(a, b, ports.get((a, b), ()), ports.get((b, a), ())) for a, b in pairs]


class MeshState(State):
    """Which nodes reach their gateway."""

    def look(self) -> tuple[int, int, int]:
        """Find everybody's way anew: (how many have none, of these are astray, could have one)."""
        self.ways = self._find_ways()
        self.hop, self.depth = self.ways.hop, self.ways.depth
        self.without = self.ways.without & self.answers | self.out
        found = self.without, self.ways.astray & ~self.out, self.ways.served & ~self.out
        none, astray, could = (int(np.count_nonzero(who)) for who in found)
        return none, astray, could

    def judge(self) -> Headline:
        """The headline by the ways that `look` found; who is off is called silent."""
        return headline(self.ways, absent="silent", elsewhere=self.elsewhere, revoked=self.out)

    def _find_ways(self) -> Ways:
        """Who reaches its gateway, by what the nodes say of each other."""
        places, count = self.map.places, len(self.map.places)
        numbered = self.map.numbered(self.told)
        said = [self.told.get(place.node, {}) for place in places]
        assert isinstance(self.map, MeshMap)
        here = {*self.map.by_number, *numbered}
        self.elsewhere = elsewhere(self.told.values(), here, len(here) == count)
        more = bool(self.elsewhere.nodes)
        place_of: dict[Any, int] = dict.fromkeys(self.elsewhere.nodes, count)
        place_of |= {name: self.map.number[at] for name, at in numbered.items()}
        on = np.array([place.node in self.told for place in places] + [True] * more, np.bool_)
        said += [{}] * more
        onward = [
            [place_of[who] for who in one.get("onward", ()) if who in place_of] for one in said
        ]
        wide = max(1, *map(len, onward))
        links = self._links(more)
        near = np.zeros((count + more, count + more), np.bool_)
        for at, one in enumerate(said):
            to = [place_of.get(other["node"], at) for other in one.get("neighbours", ())]
            near[at, to] = True
        if more:
            near[count] = links[count]
        known = Choices(
            gateway=np.array([place_of.get(one.get("gateway"), NOWHERE) for one in said]),
            named=np.array([row + [NOWHERE] * (wide - len(row)) for row in onward]),
            neighbours=near,
            goes_back=all(one.get("gives_back", True) for one in said),
        )
        leads = np.array([one.get("role") == "gateway" for one in said], np.bool_)
        if not more:
            return ways(known, links, on, ~on, leads)
        leads[count] = self.elsewhere.leads
        hand_on(known, links, leads)
        return without_it(ways(known, links, on, ~on, leads))

    def _links(self, more: bool) -> Any:
        """Who is joined with whom by links that are up; `more`: those elsewhere are the last."""
        links = np.pad(self.live(), (0, int(more)))
        for at, place in enumerate(self.map.places if more else ()):
            links[at, -1] = links[-1, at] = any(
                near["node"] in self.elsewhere.nodes
                and not near.get("suspect")
                and self.carries(place, near.get("ports", ()))
                for near in self.word(place, "neighbours", ())
            )
        return links

    def more(self) -> dict[str, Any]:
        """Ways, and who has none though links could give one."""
        return {
            "parent": self.hop,
            "depth": self.depth,
            "way": self.ways.lacks,
            "leads": self.ways.leads.astype(np.int64),
            "apart": int((self.ways.cut_off & ~self.out).sum()),
            **self._robots(),
        }

    def _robots(self) -> dict[str, Any]:
        """Which robots are outside, as they say, and about whom an alarm holds, as monitors say."""
        outside = [
            int(self.word(place, "robot", {}).get("fence") == "outside")
            for place in self.map.places
        ]
        raised = [0] * len(outside)
        assert isinstance(self.map, MeshMap)
        for robot, alarm in newest_alarms(self.told).items():
            place = self.map.by_number.get(robot)
            if place is not None:
                raised[self.map.number[place]] = int(alarm["kind"] != "clear")
        return {"outside": outside, "alarm": raised}


class MeshLiveView(LiveView):
    """What the page shows of nodes of a mesh that are processes."""

    map = MeshMap
    state = MeshState

    def __init__(self) -> None:
        self._told: set[tuple[Any, ...]] = set()  # alarms that the log has

    def role(self, one: Status) -> str:
        """A robot is shown as one, unless it is the gateway."""
        role = super().role(one)
        return "robot" if role == "node" and "robot" in one else role

    def moved(self, told: Mapping[int, Status], known: Drawn) -> dict[int, Spot]:
        """Where robots say that they are, metres, y down."""
        x, y = known.origin_m
        at = {i: one["robot"]["at_cm"] for i, one in told.items() if "robot" in one}
        return {
            i: (round(x + place[0] / 100, 2), round(y - place[1] / 100, 2))
            for i, place in at.items()
            if place is not None
        }

    def news(self, told: Mapping[int, Status], name: Callable[[int], str]) -> list[tuple[str, str]]:
        """Alarms as monitors received them, the oldest first."""
        names = {one["number"]: name(i) for i, one in told.items()}
        found = []
        for i, one in told.items():
            for alarm in one.get("alarms", ()):
                key = tuple(alarm[part] for part in ("reporter", "robot", "kind", "number"))
                if key not in self._told:
                    self._told.add(key)
                    found.append((alarm["ago_s"], name(i), alarm))
        found.sort(key=lambda one: -one[0])
        return [
            (_alarm_words(ago_s, monitor, alarm, names), LEVELS.get(alarm["kind"], "bad"))
            for ago_s, monitor, alarm in found
        ]

    def drawn(self, plan: Any) -> Drawn:
        """Nodes where the scenario has them, and the fence."""
        from innervate.networks.mesh.view.scene import Field

        scene = Field(plan).scene()
        names = [f"n{i}" for i in range(plan.nodes)]
        return Drawn(
            name=plan.scenario.name,
            places={
                name: (one["x"], one["y"]) for name, one in zip(names, scene["nodes"], strict=True)
            },
            labels={name: own for name, own in zip(names, plan.names, strict=True) if name != own},
            fence=scene["fence"],
            metres=bool(scene["metres"]),
            origin_m=(plan.origin_cm[0] / 100, -plan.origin_cm[1] / 100),
        )


def newest_alarms(told: Mapping[int, Status]) -> dict[int, Status]:
    """By robot what was said of it last, to any monitor."""
    said = [alarm for one in told.values() for alarm in one.get("alarms", ())]
    said.sort(key=lambda alarm: -float(alarm["ago_s"]))
    return {int(alarm["robot"]): alarm for alarm in said}


def _alarm_words(
    ago_s: float, monitor: str, alarm: Mapping[str, Any], names: Mapping[int, str]
) -> str:
    robot = names.get(alarm["robot"], f"n{alarm['robot']}")
    said = SAID.get(alarm["kind"], "raised an alarm")
    who = alarm["reporter"]
    witness = "" if who == alarm["robot"] else f", says {names.get(who, f'n{who}')}"
    before = f", {ago_s:.0f} s ago" if ago_s > LATE_S else ""
    return f"alarm at {monitor}: robot {robot} {said}{witness}{before}"
