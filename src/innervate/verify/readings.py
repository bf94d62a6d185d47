"""Whether a handler does the same whatever its clock reads, as an exploration takes it to do.

An explored call is made at a reading near 0. Of the first calls of each handler two more are made,
one of them with the clock, and all moments that the node keeps, moved on by half a turn or so.
"""

from typing import Any

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, SEND, SET_TIMER
from innervate.verify.values import moved, put, values

CALLS = 500  # of each handler
ON_US = (1 << 29) + 123_457


class Readings:
    """Looks at calls.

    Attributes:
        apart: handlers that do something else at another reading.
    """

    def __init__(self, net: Any) -> None:
        self.net = net
        self.calls: dict[str, int] = {}
        self.apart: set[str] = set()

    def look(self, known: Any, who: str, handler: Any, now: int, *what: Any) -> None:
        """Call a handler of a node with these values twice; all is as before but the node."""
        name, net = handler.__name__, self.net
        self.calls[name] = self.calls.get(name, 0) + 1
        if self.calls[name] > CALLS or name in self.apart:
            return
        declared, made = net.fields.FRAME, list(net.draws.made)
        given = [(one, values(one, declared)) for one in what if not isinstance(one, int)]
        found: list[Any] = []
        first: dict[str, Any] = {}
        for on in (0, ON_US):
            put(net.node, net.fields.STATE, known)
            self._move(on)
            net.draws.made = list(made)
            wrong = net.handle(who, handler, (now + on) & MASK30, *what)
            if on:
                self._move_what_differs(first)
            first = {name: getattr(net.node, name) for name in net.clocks}
            found.append(wrong or self._left((now + on) & MASK30))
            for one, kept in given:
                put(one, declared, kept)
        net.draws.made = made
        if found[0] != found[1]:
            self.apart.add(name)

    def words(self) -> str:
        """What was not tried, behind what was explored; "" nothing."""
        if not self.apart:
            return ""
        handlers = " and ".join(sorted(self.apart))
        does = "does" if len(self.apart) == 1 else "do"
        return f"; what {handlers} {does} depends on what the clock reads, which was not tried"

    def _move(self, on: int) -> None:
        for name in self.net.clocks:
            setattr(self.net.node, name, moved(getattr(self.net.node, name), on))

    def _move_what_differs(self, first: dict[str, Any]) -> None:
        """Move moments back, but those that a handler sets to a number, whatever the time is."""
        fixed = {name: at for name, at in first.items() if getattr(self.net.node, name) == at}
        self._move(-ON_US)
        for name, at in fixed.items():
            setattr(self.net.node, name, at)

    def _left(self, now: int) -> Any:
        """The node and what it put out, moments as far as they are from now."""
        net, done = self.net, list[Any]()
        for act, frame in zip(net.out.action[: net.out.count[0]], net.out.frame, strict=False):
            if act.kind == SET_TIMER:
                done.append((act.kind, act.a, (act.b - now) & MASK30))
            elif act.kind in (SEND, DELIVER):
                done.append((act.kind, act.a, act.b, values(frame, net.fields.FRAME)))
        return values(net.node, net.fields.STATE), done
