"""Running nodes as a source: asked over their status sockets, cut by telling their drivers."""

import math
import time
from collections import Counter
from pathlib import Path
from typing import Any

from innervate import __version__
from innervate.kernel.words import some
from innervate.live import status
from innervate.network import known
from innervate.web import live_known
from innervate.web.errors import Refused, WatchError
from innervate.web.history import LOSS, RETURN, SERIES, Logbook
from innervate.web.live_map import Link, Place, Status
from innervate.web.live_poll import Poller
from innervate.web.live_scene import Spot, drawn
from innervate.web.live_state import State
from innervate.web.live_view import LiveView
from innervate.web.messages import Command, Cut, Give, Heal, Kill, Revive, number
from innervate.web.recovery import Recovery
from innervate.web.source import Source

POLL_S = 0.2
SOON_S = 0.05  # while somebody has no way
EXPECTED_S = 2.0  # so soon what is asked for is seen
CALM_US = 5_000_000  # so long without a line of a kind, and the next is news again
SLOW = 2  # who gives no answer so often in a row does not answer any more
STATUS = {"do": "status"}


def find(names: list[str]) -> list[Path]:
    """The sockets of nodes by name or path; without names, of all nodes of this user.

    Of a folder in which node files lie it is all of their nodes, also those that have ended.

    Raises:
        LiveError: one of them is not there.
        WatchError: none is there.
    """
    here = status.where()
    found = [status.find(name) for name in names] if names else status.sockets()
    if found and not names:
        found = sorted([*found, *live_known.missing(here, found)], key=status.in_order)
    if not found:
        where = f"no node runs here (folder {here})"
        raise WatchError(f"{where}; start some with: innervate live up SCENARIO")
    return found


class Live(Source):
    """Nodes that run now, by their status sockets.

    Raises:
        WatchError: none of them answers, or they are of different kinds.
    """

    def __init__(self, sockets: list[Path]) -> None:
        super().__init__()
        self._names = [path.stem for path in sockets]
        self._poller = Poller(sockets)
        self._began = time.monotonic()
        self._told: dict[int, Status] = {}
        self._missed: Counter[int] = Counter()  # how often in a row a node gave no answer
        self._asked_for: dict[Any, float] = {}  # what is cut or put back from here: until when
        self._last: dict[int, Status] = {}  # the newest word of those that do not answer, too
        self._never: set[int] = set()
        self._log = Logbook(self.history, CALM_US)
        self._next = 0.0
        self._counters: Counter[str] = Counter()
        self._counted_us = 0
        self._recovery: Recovery | None = None
        self._poll()
        if not self._told:
            raise WatchError(f"{sockets[0]}: no node answers here; are they still running?")
        kinds = {str(one["kind"]) for one in self._told.values()}
        if len(kinds) > 1:
            raise WatchError(f"{' and '.join(sorted(kinds))} nodes: name those of one network")
        self._kind = min(kinds)
        self._view: LiveView = known(self._kind).live_view()
        self._never = self._unheard(sockets)  # who has not answered yet
        for i in sorted(self._never):
            self._log.often("none", 0, f"{self._names[i]}: nobody answers at its socket", "bad")
        self._map = self._view.map(self._last)
        self._drawn = drawn(sockets, self._kind)
        self._places: list[Spot] | None = None  # of the newest scene, where a scenario has them
        self._off: set[Place] = set()  # cut off whole, from here
        self._state: State = self._view.state(self._map, self._told)
        self.can = self._possible()

    def _unheard(self, sockets: list[Path]) -> set[int]:
        """Those who do not answer; they are on the map as what their files say of them."""
        silent = {path: i for i, path in enumerate(sockets) if i not in self._told}
        stand_in = live_known.silent(self._view, list(self._last.values()), list(silent))
        self._last |= {silent[path]: one for path, one in stand_in.items()}
        return set(silent.values())

    def scene(self) -> dict[str, Any]:
        """Who answered, and who is linked with whom as they say."""
        known = self._drawn
        names = [self._label(place) for place in self._map.places]
        self._places = self._as_drawn(names)
        as_drawn = self._places is not None
        places = self._places or self._map.spread().round(3).tolist()
        nodes = []
        for at, (place, (x, y)) in enumerate(zip(self._map.places, places, strict=True)):
            node = {
                "id": at,
                "label": names[at],
                "also": known.labels.get(names[at], ""),
                "x": x,
                "y": y,
                "role": self._role(place),
            }
            nodes.append({**node, "port": place.port} if place.port >= 0 else node)
        numbers = self._map.number
        links = [
            {"id": at, "a": numbers[link.a], "b": numbers[link.b]}
            for at, link in enumerate(self._map.links)
        ]
        lost = self._view.lost
        series = [
            {"id": "unconnected", "label": lost[0], "unit": lost[1]},
            {"id": "frames", "label": "frames received, all nodes", "unit": "per s"},
            {"id": "dropped", "label": "frames dropped, all nodes", "unit": "per s"},
        ]
        return {
            "kind": self._kind, "name": known.name,
            "source": "live", "version": __version__,
            "can": list(self.can), "duration_s": None, "t_s": self._now_us() / 1e6,
            "nodes": nodes, "links": links, "series": series,
            "fence": known.fence if as_drawn else None,
            **self._view.scene(self._kind),
            "metres": as_drawn and known.metres,
            "ports": sum(place.port >= 0 for place in self._map.places),
        }  # fmt: skip

    def _as_drawn(self, names: list[str]) -> list[Spot] | None:
        """The scenario's places of all that are on the map; None if it does not have them all."""
        known = self._drawn.places
        return [known[name] for name in names] if known.keys() >= {*names} else None

    def _moved(self) -> dict[str, Any]:
        """The field with everybody's place, where some say that they are elsewhere now."""
        if self._places is None or not self._drawn.metres:
            return {}
        moved = self._view.moved(self._told, self._drawn)
        if not moved:
            return {}
        spots = zip(self._map.places, self._places, strict=True)
        return {"position": [list(moved.get(place.node, spot)) for place, spot in spots]}

    def _label(self, place: Place) -> str:
        name = self._names[place.node]
        return f"{name}.{place.port}" if place.port >= 0 else name

    def _role(self, place: Place) -> str:
        if place.port >= 0:
            return "port"
        return self._view.role(self._last[place.node])

    def _now_us(self) -> int:
        return round((time.monotonic() - self._began) * 1e6)

    def work(self) -> float:
        """Ask all nodes, if it is time."""
        now = time.monotonic()
        if now < self._next:
            return self._next - now
        self._poll()
        fresh = self._view.map(self._last, self._map)
        if (fresh.places, fresh.links) != (self._map.places, self._map.links):
            self._map = fresh
            self.can = self._possible()
            self.scenes += 1
        self._look()
        waits = self._recovery is not None and self._recovery.recovered_ms is None
        self._next = now + (SOON_S if waits or self._view.is_quick else POLL_S)
        return max(0.0, self._next - time.monotonic())

    def _poll(self) -> None:
        """Ask everybody; say who went and who came back.

        Who is only slow is taken at the word before, once.
        """
        before, told = self._told, self._poller.ask_all(STATUS)
        at_us = self._now_us()
        self._missed = Counter({i: self._missed[i] + 1 for i in before.keys() - told.keys()})
        for i, times in self._missed.items():
            if times < SLOW and not self._poller.is_gone(i):
                told[i] = before[i]
        self._told = told
        went = sorted(before.keys() - told.keys())
        if went:
            names = [self._names[i] for i in went]
            do = "does" if len(went) == 1 else "do"
            self._log.often("went", at_us, f"{some(names)} {do} not answer any more", "bad", LOSS)
        for i in sorted(told.keys() - before.keys()):
            if i in self._last:
                again = "" if i in self._never else " again"
                text, mark = f"{self._names[i]} answers{again}", RETURN if again else ""
                self._log.often("came", at_us, text, "good", mark)
                self._never.discard(i)
        self._last = {**self._last, **told}
        if went:
            silent = len(self._last) - len(told)
            alone = f"{self._names[went[0]]} does not answer any more"
            cause = alone if silent == 1 else f"{silent} nodes do not answer any more"
            self._lose(self._state, cause)

    def _compare(self, before: State) -> None:
        """What was cut or put back since `before`, and not from here, is said."""
        changes: list[tuple[Link | Place, bool]] = [
            *before.changed_links(self._state),
            *before.changed_places(self._state),
        ]
        cut: list[Link | Place] = []
        back: list[Link | Place] = []
        for what, up in changes:
            if self._asked_for.pop(self._map.key(what), 0.0) < time.monotonic():
                (back if up else cut).append(what)
        for what in cut:
            self._log.often("cut", self._now_us(), self._words(what, False), mark=LOSS)
        for what in back:
            self._log.often("back", self._now_us(), self._words(what, True), mark=RETURN)
        causes = [self._words(what, False) for what in cut]
        if out := sorted(self._state.put_out - before.put_out):
            causes.append(f"{some([self._names[i] for i in out])} put out: revoked")
            self._log.say(self._now_us(), causes[-1], mark=LOSS)
        if causes:
            self._lose(before, causes[0], len(causes) - 1)

    def _words(self, what: Link | Place, up: bool) -> str:
        """What became of a link, or of a station on its channel."""
        if isinstance(what, Place):
            return f"{self._label(what)} {'let back' if up else 'cut off'}"
        names = f"{self._label(what.a)} - {self._label(what.b)}"
        return f"link {names} {'put back' if up else 'cut'}"

    def _look(self) -> None:
        """Take in what everybody said: who has a way again, a point of the plots."""
        before, self._state = self._state, self._view.state(self._map, self._told, self._off)
        self._compare(before)
        self._recover()
        self._view.note(self._state, self._now_us(), self._told)
        for text, level in self._view.news(self._told, self._names.__getitem__):
            self._log.often("news", self._now_us(), text, level)
        at_us, lost = self._now_us(), self._state.unconnected
        total = self._frames()
        took_s = max(1e-3, (at_us - self._counted_us) / 1e6)
        point: dict[str, float | None] = {
            name: round(max(0, total[name] - self._counters[name]) / took_s, 1) for name in total
        }
        if self._counted_us and (self._told or before.told):  # then a gap begins
            point = {"unconnected": float(lost), **point}
            self.history.add(SERIES, at_us, point if self._told else dict.fromkeys(point))
        self._counters, self._counted_us = total, at_us

    def _recover(self) -> None:
        """Note when everybody who can have a way has one again; nothing if nobody answers."""
        recovery, state = self._recovery, self._state
        if recovery is None or not self._view.has_ways or not self._told:
            return
        at_us = self._now_us()
        recovery.cut_off(state.apart)
        were_none, recovery.nobody = recovery.nobody, not state.left
        after_ms = round((at_us - recovery.at_us) / 1e3, 1)
        if recovery.detected_ms is None and state.lacking:
            recovery.detected_ms = after_ms
        if recovery.recovered_ms is None and not state.lacking and state.left:
            kept = recovery.detected_ms is None and not were_none
            recovery.recovered_ms = 0.0 if kept else after_ms
            how = "kept its way" if kept else f"has a way again after {int(after_ms + 0.5)} ms"
            who = f"every node{'' if len(self._told) == len(self._last) else ' that answers'}"
            others = state.without_words()
            who = f"{who} but {others}" if others else who
            self._log.say(at_us, f"{who} {how}, as they say", "info" if others else "good")

    def _lose(self, before: State, cause: str, more: int = 0) -> None:
        """Something was taken away, and so many others with it: a recovery begins."""
        self._recovery = Recovery(cause, self._now_us(), more=more, before=before.apart)

    def _frames(self) -> Counter[str]:
        """Frames received and dropped, by everybody so far."""
        total = Counter({"frames": 0, "dropped": 0})
        for one in self._last.values():
            for path in one.get("paths", ()):
                total["frames"] += path["counters"].get("received", 0)
            for what, count in one["counters"].items():
                if what.startswith("dropped"):
                    total["dropped"] += count
        return total

    def fields(self) -> dict[str, Any]:
        """The state as it was told last."""
        recovery, headline = self._recovery, self._state.headline()
        t_s = math.ceil(self._now_us() / 1e5) / 10  # in steps, so that what is idle is told seldom
        return {
            "t_s": t_s,
            "paused": False,
            "speed": 1.0,
            "at_end": False,
            **self._state.fields(),
            **self._moved(),
            "headline": headline.shown(),
            "since_cut_s": None if recovery is None else round(t_s - recovery.at_us / 1e6, 6),
            "recovery": None if recovery is None else recovery.shown(),
        }

    def _possible(self) -> tuple[str, ...]:
        nodes = ("kill", "revive") if any(one.get("paths") for one in self._last.values()) else ()
        links = ("cut", "heal") if self._map.links else ()
        return (*links, *nodes, *self._view.can(self._last))

    def _ask(self, node: int, request: dict[str, Any]) -> dict[str, Any] | None:
        return self._poller.ask({node: request}).get(node)

    def _is_done(self, node: int, request: dict[str, Any]) -> bool:
        """True if a node says that it has done what it was asked."""
        answer = self._ask(node, request)
        return answer is not None and "error" not in answer

    def do(self, command: Command) -> dict[str, Any] | None:
        """Have drivers drop what comes over a link, or over all paths of a node; or take it again.

        Nodes go on running: what is cut off is not killed, and comes back by the same way.
        """
        if isinstance(command, Kill | Revive):
            place = self._map.places[number("node", command.node, len(self._map.places))]
            self._plug(place, isinstance(command, Revive))
        elif isinstance(command, Cut | Heal):
            self._cable(command)
        elif isinstance(command, Give) and "command" in self.can:
            said = self._view.give(command, self._map, self._last, self._label, self._ask)
            self._log.say(self._now_us(), said)
        else:
            raise Refused("not possible here")
        self._next = 0.0
        return None

    def _plug(self, place: Place, back: bool) -> None:
        """Cut a node off, or let it back, by all of its paths; a port of the PC has one."""
        label, at = self._label(place), self._map.number[place]
        if place.node not in self._told:
            raise Refused(f"{label} does not answer; start it again where it ran")
        if bool(self._state.node_up[at]) == back:
            raise Refused(f"{label} is not cut off" if back else f"{label} is cut off already")
        paths = [int(path["port"]) for path in self._told[place.node]["paths"]]
        for path in [place.port] if place.port >= 0 else paths:
            request = {"do": "restore" if back else "cut", "port": path}
            if not self._is_done(place.node, request):
                raise Refused(f"{label} could not be told; does it still run?")
        (self._off.discard if back else self._off.add)(place)
        self._ask_for(place, *(link for link in self._map.links if place in (link.a, link.b)))
        self._note(self._words(place, back), back)

    def _ask_for(self, *those: Link | Place) -> None:
        """What happens to those now was done from here."""
        until = time.monotonic() + EXPECTED_S
        self._asked_for.update((self._map.key(what), until) for what in those)

    def _note(self, cause: str, heals: bool) -> None:
        if not heals:
            self._lose(self._state, cause)
        self._log.say(self._now_us(), cause, mark=RETURN if heals else LOSS)

    def _cable(self, command: Cut | Heal) -> None:
        at = number("link", command.link, len(self._map.links))
        heal, link = isinstance(command, Heal), self._map.links[at]
        if bool(self._state.link_up[at]) == heal:
            raise Refused("this link is not cut" if heal else "this link carries nothing already")
        ends = [(link.a, link.paths_a), (link.b, link.paths_b)]
        told = 0
        for place, paths in ends:
            for path in paths:
                if self._is_shared(place, path):
                    raise Refused(f"{self._label(place)} hears others on the same path, too")
                request = {"do": "restore" if heal else "cut", "port": path}
                told += self._is_done(place.node, request)
        if not told:
            raise Refused("neither end could be told; do they still run?")
        self._ask_for(link)
        self._note(self._words(link, heal), heal)

    def _is_shared(self, place: Place, path: int) -> bool:
        """True if a path leads to several neighbours: a group, or the air."""
        near = self._last[place.node].get("neighbours", ())
        return sum(path in one["ports"] for one in near) > 1

    def close(self) -> None:
        """Stop asking the nodes how they are."""
        self._poller.close()
