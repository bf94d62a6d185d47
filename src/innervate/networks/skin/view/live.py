"""A running skin on the page: its cells, the PC by its ports, who sends to whom."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from innervate.analysis.headline import Headline, every
from innervate.analysis.ways import NOWHERE, Numbers, follow, reach
from innervate.networks.skin.analysis.headline import SkinFacts, skin_headline
from innervate.web.errors import Refused
from innervate.web.live_map import Map, Status
from innervate.web.live_scene import Drawn
from innervate.web.live_state import State, Told
from innervate.web.live_view import Ask, Label, LiveView
from innervate.web.messages import Give, number

PC = "pc"  # what `live up` calls it
LOAD_FULL = 66  # cells whose samples fill a link, at 250 Hz each


class SkinMap(Map):
    """Cells, then the PC's interface ports."""

    def is_split(self, one: Status) -> bool:
        """The PC is drawn by its ports."""
        return one.get("role") == "sink"


class SkinState(State):
    """Which cells have a way to the PC."""

    def look(self) -> tuple[int, int, int]:
        """Find everybody's way anew: (how many have none, of these are astray, could have one)."""
        where = self.map
        count = len(where.places)
        none = np.zeros(count, np.bool_)
        self.hop, leaves = self._parents()
        live, roots = self.live(), self._ports()
        root, depth = follow(
            np.where(live[np.arange(count), np.maximum(self.hop, 0)], self.hop, NOWHERE),
            roots | leaves,
        )
        # Of a way that goes on by nodes that do not run here neither port nor length is known.
        self._beyond = (root != NOWHERE) & leaves[root] & ~self.out
        lost = (root == NOWHERE) & self.answers & ~self._is_port()
        self.root, self.depth = (np.where(self._beyond, NOWHERE, one) for one in (root, depth))
        if not where.links:  # cables unknown: what cells say has to do
            lost = np.array([self.word(place, "parent", 0) is None for place in where.places])
        lost |= self.out & ~self._is_port()  # whatever they believe themselves
        joined = reach(live, roots | self.hears_beyond()) if where.links else ~none
        here = reach(live, roots) if where.links else ~self.hears_beyond()
        self._facts = self._skin_facts(lost, joined, here)
        left = (self.node_up == 1) & joined & ~self._is_port()
        self.without = lost
        found = lost, lost & joined & ~self.out, left & ~self.out
        without, astray, could = (int(np.count_nonzero(who)) for who in found)
        return without, astray, could

    def judge(self) -> Headline:
        """The headline by the ways and loads that `look` found."""
        return skin_headline(self._facts, self.map.names.__getitem__)

    def _skin_facts(self, lost: Any, joined: Any, here: Any) -> SkinFacts:
        """What cells say of their ways; `joined`: cables can join them with the PC, `here`: do."""
        places = self.map.places
        is_cell = np.array([place.port < 0 for place in places], np.bool_)
        told = self.answers & ~self.out
        apart = told & (~joined | np.array(self.cut_off, np.bool_))
        ports = self.answers[~is_cell]

        def of(flags: Any) -> list[int]:
            found: list[int] = np.flatnonzero(is_cell & flags).tolist()
            return found

        return SkinFacts(
            cells=int(np.count_nonzero(is_cell)),
            silent=of(~self.answers),
            out=of(self.out),
            cut_off=of(apart),
            seeking=of(told & lost & ~apart),
            pc_off=bool(len(ports)) and not ports.any(),
            pc_out=bool(self.out[~is_cell].any()),
            beyond=of(self._beyond),
            served=sum(sum(one.get("cells", ())) for one in self.told.values()),
            of_cells=next((n for one in self.told.values() if (n := one.get("of_cells"))), None),
            afar=of(told & lost & ~apart & ~here),
        )

    def _ports(self) -> Any:
        """Where a skin's ways lead: the PC's ports."""
        return self._is_port() & (self.node_up == 1)

    def _is_port(self) -> Any:
        return np.array([place.port >= 0 for place in self.map.places], np.bool_)

    def _parents(self) -> tuple[Numbers, Any]:
        """Per place of a skin the one that its cell sends to, and if that does not run here."""
        number, beyond = self.map.number, self.paths_beyond
        found = np.full(len(self.map.places), NOWHERE, np.int64)
        leaves = np.zeros(len(self.map.places), np.bool_)
        across = {}
        for link in self.map.links:
            across.update({(link.a, path): link.b for path in link.paths_a})
            across.update({(link.b, path): link.a for path in link.paths_b})
        for at, place in enumerate(self.map.places):
            if place.port < 0:
                ports = {port["port"]: port.get("path") for port in self.word(place, "ports", ())}
                path = ports.get(self.word(place, "parent", None))
                to = None if path is None else across.get((place, path))
                found[at] = NOWHERE if to is None else number[to]
                leaves[at] = (place, path) in beyond
        return found, leaves

    def more(self) -> dict[str, Any]:
        """Ways, the port that each cell's way leads to, load."""
        places = self.map.places
        port = [place.port for place in places]
        load = np.array([self.word(place, "load", 0) for place in places]) / LOAD_FULL
        return {
            "parent": self.hop,
            "depth": self.depth,
            "port": np.where(self.root == NOWHERE, NOWHERE, np.take(port, self.root)),
            "beyond": self._beyond.astype(np.int64),
            "load": np.minimum(load, 1.0).round(3),
            "told": [NOWHERE if (n := self.word(place, "command", None)) is None else n
                     for place in places],
        }  # fmt: skip


class SkinLiveView(LiveView):
    """What the page shows of cells and a PC that are processes."""

    map = SkinMap
    state = SkinState
    lost = ("cells without a way", "cells")

    def __init__(self) -> None:
        self._under_way: dict[int, int | None] = {}  # commands from here, and for which cell

    def drawn(self, plan: Any) -> Drawn:
        """Cells where the honeycomb has them, interface ports beside."""
        from innervate.networks.skin.live.deployment import cell_names
        from innervate.networks.skin.view.scene import places

        graph = plan.graph
        names = cell_names(graph)
        ports = [f"pc.{i}" for i in range(graph.interfaces)]
        found = [(float(x), float(y)) for x, y in places(graph).round(3).tolist()]
        return Drawn(
            name=plan.scenario.name,
            places=dict(zip([*names, *ports], found, strict=True)),
            labels={name: graph.label(i) for i, name in enumerate(names)},
        )

    def unknown(self, told: list[Status], names: list[str]) -> list[Status]:
        """The PC is among those that do not answer if it is called so, or runs nowhere else.

        It does run elsewhere while a cell has a way, or hears somebody who is none of these.
        """
        found = [one | {"role": "cell"} for one in super().unknown(told, names)]
        if not names or any(one.get("role") == "sink" for one in told):
            return found
        cells = dict(enumerate(told))
        state = self.state(self.map(cells), cells)
        away = state.hears_beyond().any() or any(one.get("parent") is not None for one in told)
        if PC in names or not away:
            at = names.index(PC) if PC in names else 0
            found[at] |= {"role": "sink", "paths": [{"port": 0, "name": "", "counters": {}}]}
        return found

    def can(self, last: Mapping[int, Status]) -> tuple[str, ...]:
        """A PC sends commands down."""
        return ("command",) if _pc(last) is not None else ()

    def give(self, command: Give, where: Map, last: Told, label: Label, ask: Ask) -> str:
        """Have the PC send a command down."""
        pc, cell, whom = _pc(last), None, "all cells"
        assert pc is not None
        if command.node is not None:
            place = where.places[number("node", command.node, len(where.places))]
            if place.port >= 0:
                raise Refused("this is a port of the PC; commands are for cells")
            cell, whom = int(last[place.node]["number"]), label(place)
        request = {"do": "command", "code": command.code, "value": command.value, "cell": cell}
        answer = ask(pc, request)
        if answer is None or "error" in answer:
            raise Refused(f"the PC did not take it: {(answer or {}).get('error', 'no answer')}")
        if not answer["ports"]:
            raise Refused("no cell has the PC as its parent: nobody hands it down")
        self._under_way[answer["number"]] = cell
        return f"command {answer['number']} sent to {whom}"

    def news(self, told: Mapping[int, Status], name: Callable[[int], str]) -> list[tuple[str, str]]:
        """Commands that were given here and have come."""
        cells = {one["number"]: i for i, one in told.items() if one.get("role") == "cell"}
        has = {number: told[i].get("command") for number, i in cells.items()}
        found = []
        for given, cell in list(self._under_way.items()):
            whom = [cell] if cell is not None else list(has)
            if whom and all(has.get(one) == given for one in whom):
                del self._under_way[given]
                who = name(cells[cell]) if cell is not None else every(len(whom), "cell")
                found.append((f"command {given} came to {who}", "good"))
        return found


def _pc(last: Mapping[int, Status]) -> int | None:
    """Which node is the PC."""
    found = (i for i, one in last.items() if one.get("role") == "sink")
    return next(found, None)
