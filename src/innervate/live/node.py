"""A live node: a protocol on an engine, the paths its frames take, and what is known of them."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Callable
from typing import IO, TYPE_CHECKING, Any

from innervate.dialect.arith import HALF30
from innervate.live.engine import NEVER, Engine, Stack, clock_us
from innervate.live.errors import LiveError
from innervate.live.links import APART, REACH, Link, Path
from innervate.live.machine import IDLE_STATES, machine
from innervate.live.nodefile import PYTHON, C
from innervate.live.receipts import STOPPED, Receipt
from innervate.live.state import State
from innervate.live.streams import Arrivals, Stream
from innervate.live.warm import Warmth

if TYPE_CHECKING:  # it brings ciphers with it, which only nodes with keys need
    from innervate.live.keys import Sealer

CUT = "cable cut"  # as captures of simulations call it
# When (ns since 1970), which port, True = it left, its bytes, why it was dropped ("" = it was not).
# Without bytes: what happened to the path, "event: cut".
Tap = Callable[[int, int, bool, bytes, str], None]
# Answers a request that only some nodes understand.
Answerer = Callable[[dict[str, Any]], dict[str, Any]]


class LiveNode:
    """One running node. Subclasses know what its user says and hears.

    Args:
        name: as shown to people.
        stack: its protocol.
        links: what carries its frames; their paths are numbered through from 0.
        sealer: seals and opens frames; None = they go in the clear.
        state: what is kept over a restart.

    Attributes:
        paths: all paths, by port.
        reports: how often the protocol reported what, by code.
        outcomes: what became of what its user said, and how much came in for him, by words.
        arrivals: what came in for its user.
        taps: who is told of every frame, as it leaves and comes in.
        callers: how often callers of the node's process could not be let in, and why.
        engine_of: makes what runs the stack; an `Engine` unless somebody runs it elsewhere.
        is_stopped: True = it ran, and does not any more.
        ended: is told why, if what runs the stack ends by itself; then nothing moves any more.
        not_in_c: why its protocol does not run as C; "" = it does.
        is_awake: True = the machine's processors do not sleep while it runs.
        is_warm: True = it rehearses what a frame takes: see warm.py.
        requests: what may be asked of it on its status socket besides what all nodes answer.
    """

    is_stopped = False
    is_awake = is_warm = False
    _is_open = False
    _wakefulness: IO[bytes] | None = None
    _warmth: Warmth | None = None

    def __init__(
        self,
        name: str,
        stack: Stack,
        links: list[Link],
        sealer: Sealer | None = None,
        state: State | None = None,
    ) -> None:
        self.name = name
        self.stack = stack
        self.links = links
        self.sealer = sealer
        self.state = state or State(None)
        self.paths: list[Path] = [path for link in links for path in link.paths]
        self.reports: Counter[int] = Counter()
        self.outcomes: Counter[str] = Counter()
        self.arrivals: Arrivals[Any] = Arrivals()
        self.taps: list[Tap] = []
        self.callers: Counter[str] = Counter()
        self.requests = self.own_requests()
        self.not_in_c = "not asked for"
        self.engine_of: Callable[..., Engine] = Engine
        self.engine: Engine | None = None
        self.ended: Callable[[str], None] = lambda why: machine().say(f"{name}: {why}")
        self.started_at = clock_us()

    def own_requests(self) -> dict[str, Answerer]:
        """What nodes of this kind may be asked, and who answers."""
        return {}

    async def start(self) -> None:
        """Open the links and switch the protocol on; where that fails all is closed again.

        Raises:
            LiveError: a link cannot be opened as written, or the node runs already; it goes on.
        """
        if not self.idle():
            raise LiveError(f"{self.name}: runs already; stop it before it is started anew")
        self.is_stopped = False
        try:
            await self._find_links()
            await self._switch_on()
        except BaseException:
            await self.stop()
            self.engine = None
            raise

    async def _find_links(self) -> None:
        """Nothing is heard or said until all are found."""
        found = await asyncio.gather(*(link.find() for link in self.links), return_exceptions=True)
        if wrong := next((one for one in found if one is not None), None):
            raise wrong
        if self.is_stopped:
            raise LiveError(f"{self.name}: was stopped before it was started")

    async def _switch_on(self) -> None:
        self.engine = self.engine_of(
            self.stack, self._transmit, self._deliver, self._note_report, self._settled
        )
        self.engine.ended = lambda why: self.ended(why)
        self.engine.late_us, self.engine.late = HALF30, self._was_held_up
        if self.is_awake:
            self._keep_awake()
        for link in self.links:
            await link.open(self._receive)
        self._is_open = True
        self.save()
        self.state.check_place()
        if self.sealer is not None:
            self.sealer.start(self.paths)
        if self.is_warm:
            self._keep_warm(self.engine)
        self.engine.start(0 if self.state.fresh else 1)

    async def stop(self) -> None:
        """Stop at once, as if switched off; `drain` first to get rid of what is under way."""
        self.is_stopped = True
        if self.engine is not None:
            self.engine.stop()
        if self.sealer is not None:
            self.sealer.stop()
        for link in self.links:
            link.close()
        if self._warmth is not None:
            self._warmth.stop()
        if self._wakefulness is not None:
            self._wakefulness.close()
        self._warmth = self._wakefulness = None
        if self._is_open:  # else another may run that keeps its state there
            self._is_open = False
            self.save()

    def _was_held_up(self, late_us: int) -> None:
        """The process did not run for so long: the protocol begins anew.

        Its clock, which wraps, would take old times for new ones, and what waits was sent to who
        it was then.
        """
        why = f"did not run for {late_us / 1e6:.0f} s"
        machine().say(f"{self.name}: {why}; begins anew, and what was under way has expired")
        self.outcomes["begun anew: did not run for long"] += 1
        for link in self.links:
            link.forget()
        self._give_up(f"the node {why}")
        self.running().start(1)

    def _give_up(self, why: str) -> None:
        """The protocol forgets what was under way: its user may wait for that."""

    def _keep_awake(self) -> None:
        try:
            self._wakefulness = machine().keep_awake()
        except OSError as error:
            raise LiveError(
                f"awake = true: {IDLE_STATES}: {error.strerror}; let this user write to it, "
                "or take the line out"
            ) from None

    def _keep_warm(self, engine: Engine) -> None:
        try:
            self._warmth = Warmth(engine.rehearse)
        except OSError as error:
            self.is_warm = False
            why = f"warm = true: no socket to itself: {error.strerror}"
            machine().say(f"{self.name}: {why}; goes on without")

    def idle(self) -> str:
        """Why nothing can be handed down now; "" if it can."""
        if self.engine is None:
            return "node not started"
        return STOPPED if self.is_stopped else ""

    def running(self) -> Engine:
        """What runs the protocol; ValueError if nothing does."""
        if self.engine is None or self.is_stopped:
            raise ValueError(f"{self.idle()}; start it first: await node.start(), or async with it")
        return self.engine

    def save(self) -> None:
        """Write what is kept over a restart."""
        self.state.write()

    async def __aenter__(self) -> LiveNode:
        await self.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.stop()

    def path_at(self, port: int) -> Path:
        """A path by its number; ValueError if there is none."""
        if not 0 <= port < len(self.paths):
            raise ValueError(f"no port {port}; this node has 0 to {len(self.paths) - 1}")
        return self.paths[port]

    def change(self, port: int, what: str, loss: float = 0.0) -> Path:
        """Cut, restore or loosen ("loose": `loss` of what comes in is lost) a path; the path.

        "apart" and "near" say that who is at its far end has left or is back: it carries nothing
        while it is cut or he is away.

        Raises:
            ValueError: there is no such path, or no such share.
        """
        path = self.path_at(port)
        if not 0 <= loss <= 1:
            raise ValueError(f"loss must be 0 to 1, the share that is lost, not {loss:g}")
        if what in REACH:
            path.away = what == APART
        else:
            path.cut, path.loss = what == "cut", loss
        self._tell(machine().time_ns(), port, False, b"", f"event: {what}")
        return path

    def _receive(self, path: Path, data: bytes) -> None:
        if not path.carries:
            self._tell(machine().time_ns() if self.taps else 0, path.port, False, data, CUT)
            return
        if path.loss and machine().chance.random() < path.loss:
            return
        path.counters["received"] += 1
        path.counters["received bytes"] += len(data)
        at_ns = machine().time_ns() if self.taps else 0
        opened = None
        if self.sealer is not None:
            refused = self.sealer.refused
            opened = self.sealer.open(path, data)
            if opened is None:  # or it was said below the protocol
                if self.sealer.refused > refused:
                    self._tell(at_ns, path.port, False, data, "seal")
                return
            data = opened.frame
        assert self.engine is not None
        why = self.engine.read(data, None if opened is None else opened.sender)
        if not why:
            if opened is not None and self.sealer is not None:
                self.sealer.take(opened)
            path.heard_at = at = clock_us()
            self.engine.receive(path.port, at)
        if self.taps:
            self._tell(at_ns, path.port, False, data, why)

    def _transmit(self, port: int, frame: Any, attempt: int, flags: int) -> None:
        ports = self.stack.ports_of(port, frame, attempt)
        paths = self.paths if ports is None else [self.paths[i] for i in ports]
        self._leave(paths, self.stack.encode(frame))

    def _leave(self, paths: list[Path], bare: bytes) -> None:
        """A frame goes out, sealed if there are keys."""
        for path in paths:
            at_ns = machine().time_ns() if self.taps else 0  # before anybody can have received it
            data = bare if self.sealer is None else self.sealer.close(path, bare)
            if data is not None and path.carries:
                path.send(data)
            if self.taps:
                self._tell(at_ns, path.port, True, bare, "" if path.carries else CUT)

    def _tell(self, at_ns: int, port: int, out: bool, data: bytes, why: str) -> None:
        """Tell those who asked of a frame, in the clear."""
        for tap in self.taps:
            tap(at_ns, port, out, data, why)

    def send_request(self, request: dict[str, Any]) -> Receipt | None:
        """Send a message as a request says; None = this node knows no messages.

        Raises:
            ValueError: it cannot be sent so.
        """
        return None

    def streams(self, request: dict[str, Any]) -> list[Stream]:
        """What somebody who listens is told of, and how.

        Raises:
            ValueError: nothing comes in here for people.
        """
        raise ValueError("nothing comes in here for people")

    async def drain(self, limit_s: float) -> bool:
        """Wait until nothing of ours is under way, at most `limit_s` seconds: True if so."""
        return True

    def troubles(self) -> dict[str, str]:
        """What its user should mend, a line each, by a name for each."""
        named = {path.trouble: path.name for path in reversed(self.paths) if path.trouble}
        return {name: text for text, name in named.items()}  # what many paths have, by the first

    def counters(self) -> Counter[str]:
        """What happened how often: handler calls, frames dropped by reason, outcomes."""
        total: Counter[str] = Counter() if self.engine is None else Counter(self.engine.counters)
        if self.sealer is not None:
            total.update({f"dropped: {why}": n for why, n in self.sealer.dropped.items()})
            total.update(self.sealer.counts)
        strangers = sum(getattr(link, "strangers", 0) for link in self.links)
        if strangers:
            total["dropped: from a stranger"] = strangers
        unread = sum(link.unread() for link in self.links)
        if unread:
            total["dropped by the system: not for this node, or no room"] = unread
        if self.state.failed:
            total["state not written"] = self.state.failed
        return total + self.callers + self.outcomes

    def status(self) -> dict[str, Any]:
        """What is known here: paths, counters, and what the protocol says of itself."""
        now = clock_us()
        paths = [_path_status(path, now, self.stack.silent_us) for path in self.paths]
        return {
            "name": self.name,
            "up_s": round((clock_us() - self.started_at) / 1e6, 1),
            "sealed": self.sealer is not None,
            "engine": PYTHON if self.not_in_c else C,
            "keys": None if self.sealer is None else self.sealer.status(),
            "state": self.state.status(),
            "paths": paths,
            "broken": [path["name"] for path in paths if path["broken"]],
            "counters": dict(sorted(self.counters().items())),
            **self.stack.status(clock_us()),
        }

    def _note_report(self, code: int, a: int, b: int) -> None:
        self.reports[code] += 1
        self._reported(code, a, b)

    def _deliver(self, kind: int, frame: Any) -> None:
        """The protocol has something for its user; the record is used again."""

    def _reported(self, code: int, a: int, b: int) -> None:
        """The protocol says what happened."""

    def _settled(self) -> None:
        """The outbox is empty: the user may be called."""
        self.arrivals.hand_up()


def is_broken(path: Path, now: int, most_us: int) -> bool:
    """True if the path cannot be used, or nothing was heard on it for so long, or ever."""
    if not path.up or most_us == NEVER:
        return not path.up
    return not path.heard_at or now - path.heard_at > most_us


def _path_status(path: Path, now: int, most_us: int) -> dict[str, Any]:
    silent_us = now - path.heard_at if path.heard_at else None
    return {
        "name": path.name,
        "own": path.own,
        **({"far": path.far} if path.far else {}),
        "port": path.port,
        "up": path.up and path.carries,
        "heard_s": None if silent_us is None else round(silent_us / 1e6, 3),
        "broken": is_broken(path, now, most_us),
        "counters": dict(sorted(path.counters.items())),
    }
