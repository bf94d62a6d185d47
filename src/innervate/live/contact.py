"""First contact with whoever is at the far end of a path, and the sessions that come of it.

A node asks who is there until somebody proves to be; it answers whoever asks with proof of its
own. On a path to one neighbour all that leaves is sealed in the newest session.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING

from innervate.live.engine import clock_us
from innervate.live.keyring import ANYBODY, MAC_BYTES, About, Proven, read_about
from innervate.live.knocks import ANSWERED, Knocks
from innervate.live.links import Path
from innervate.live.machine import machine
from innervate.live.noise import KEY_BYTES, Broken, Handshake
from innervate.live.session import COUNTERS, REKEY_US, Answer, Session
from innervate.wire import seal

if TYPE_CHECKING:
    from innervate.live.keys import Sealer

WAIT_S = 0.05  # until one asks again, doubling
WAIT_MAX_S = 1.0
IDLE_S = 0.5  # between looks at a session that is well
PROOF_US = 2_000_000  # a session in which nothing was heard for so long never came about
DOUBT_US = 2_000_000  # nothing was heard while we send: ask in the session, which costs little ...
SILENT_US = 3_000_000  # ... then with a handshake: the neighbour may have lost the session
OLD_US = 3 * REKEY_US  # an older session is not taken any more
ASKED = 4  # of our questions may be answered late
ANSWERS = 8  # of ours are remembered
KNOCKS = 64  # of strangers in 50 ms are heard
SESSIONS = 3  # of a neighbour: frames of an older one may come late
HELD = 8  # frames wait for the first session
HELD_US = 100_000
ALIVE, ANSWER = 0, 1  # control frames: "are you there", "I am"
REVOKED = 2
TWIN = 3
ANOTHER = "another with our number"


class Contact:
    """What the node of a sealer knows of the far end of a path to one neighbour.

    Attributes:
        sessions: those that were proved, by the number of who is there; the newest first.
        knocks: what strangers' messages may cost.
    """

    most_knocks = KNOCKS
    rest_s = 10.0  # between looks while nothing is sent or heard

    def __init__(self, sealer: Sealer, path: Path) -> None:
        self.sealer, self.path = sealer, path
        self.sessions: dict[int, list[Session]] = {}
        self.knocks = Knocks(self.most_knocks, self.listen)
        self._current: Session | None = None
        self._by_index: dict[int, Session] = {}
        self._asked: dict[int, tuple[Handshake, int]] = {}
        self._answered: dict[bytes, Answer] = {}
        self._held: deque[tuple[int, bytes]] = deque(maxlen=HELD)
        self._timer: asyncio.TimerHandle | None = None
        self._wait_s = WAIT_S
        self._sent_at = 0  # first frame since something was heard, us
        self._rests = False  # nothing was sent or heard since the last look
        self._due: set[int] = set()  # neighbours who are to prove themselves with another key

    def start(self) -> None:
        """Ask who is there, from the loop's next turn on."""
        self._rests = False
        self._timer = asyncio.get_running_loop().call_later(0, self.beat)

    def stop(self) -> None:
        """Ask no more who is there."""
        self.knocks.stop()
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def renew_all(self) -> None:
        """Have all sessions made anew; they are taken until that is done."""
        self._due.update(self.sessions)
        self.ask_at_once()

    def ask_at_once(self) -> None:
        """Ask now, and often at first."""
        if self._timer is not None:
            self._timer.cancel()
            self._wait_s = WAIT_S
            self.start()

    def beat(self) -> None:
        """Look after the newest session; ask if there is none, or it is old or silent."""
        now, wait_s = clock_us(), IDLE_S
        for session in list(self._by_index.values()):
            if now - session.made_at > OLD_US:
                self.forget(session)
            elif session.proof and not session.heard_at:
                if now - session.made_at > PROOF_US:
                    self.forget(session)
                else:
                    self._prove(session)
                    wait_s = WAIT_S
        is_asking = self._wants_session(now)
        if is_asking:
            self.ask(ANYBODY)
            wait_s = self._wait_s * (0.75 + machine().chance.random() / 2)
            self._wait_s = min(2 * self._wait_s, WAIT_MAX_S)
        elif self._current and 0 < self._sent_at < now - DOUBT_US:
            self.tell(self._current, ALIVE)
        elif self._rests and not self._sent_at and wait_s == IDLE_S:
            wait_s = self.rest_s
        self._rests = not is_asking and wait_s >= IDLE_S
        self.listen()
        self._timer = asyncio.get_running_loop().call_later(wait_s, self.beat)

    def _stir(self) -> None:
        """Something is sent or heard: look again soon."""
        if self._rests and self._timer is not None:
            self._timer.cancel()
            self._timer = asyncio.get_running_loop().call_later(IDLE_S, self.beat)
        self._rests = False

    def listen(self) -> None:
        """Say to the path what is taken: nobody has to read the rest."""
        self.path.let_in(self._anybody() if self.knocks.is_open else (), self._known())

    def _anybody(self) -> list[tuple[int, int]]:
        """Ranges of first bytes that are heard from strangers: once somebody is there, calls alone.

        Before, what is not sealed or under another key is heard, too, so that people can be told.
        """
        if not self.sessions:
            return [(0, seal.MARK - 1), (seal.FIRST, 0xFF)]
        return [(seal.FIRST + key, seal.FIRST + key) for key in self.sealer.ring.keys]

    def in_clear(self) -> None:
        """Something came that was not sealed."""
        if not self.sessions:
            self.knocks.note()

    def _known(self) -> dict[int, int]:
        """Indices under which we were to be told something, and the least counter of each."""
        known = dict.fromkeys(self._asked, 0)
        known |= {answer.handle: 0 for answer in self._answered.values() if answer.handshake}
        return known | {index: one.window.least for index, one in self._by_index.items()}

    def _wants_session(self, now: int) -> bool:
        is_silent = self._sent_at > 0 and now - self._sent_at > SILENT_US
        return not self._current or bool(self._due) or is_silent or self._current.is_worn(now)

    def ask(self, whom: int) -> None:
        """Begin a handshake with somebody, or with anybody."""
        index = self._draw_index()
        ring = self.sealer.ring
        handshake = ring.handshake(ring.use, True)
        message = handshake.write(self._about(whom, index).encode())
        self._asked[index] = (handshake, ring.use)
        if len(self._asked) > ASKED:
            del self._asked[next(iter(self._asked))]
        self.sealer.counts["handshakes begun"] += 1
        self.listen()
        self.send(ring.close(ring.use, bytes((seal.FIRST + ring.use,)) + message))

    def close(self, data: bytes) -> bytes | None:
        """Seal a frame; None = nobody is there yet, and it waits a little."""
        session = self._current
        if session is None or session.counter >= COUNTERS:
            self._held.append((clock_us() + HELD_US, data))
            self.sealer.counts["held: no session yet"] += 1
            return None
        if not self._sent_at:
            self._sent_at = clock_us()
        self._stir()
        return session.close(data)

    def send(self, data: bytes) -> None:
        """Put bytes on the path."""
        if self.path.carries:
            self.path.send(data)

    def take(self, data: bytes) -> str:
        """A message of a handshake came: why it is not taken; "" = it is."""
        kind = data[0]
        try:
            if kind == seal.SECOND:
                return self._second(data)
            if kind == seal.THIRD:
                return self._third(data)
            if not self.knocks.is_open:
                return "too many first messages"
            self.knocks.note()
            return self._first(data, kind - seal.FIRST)
        except Broken:
            return "wrong key or damaged"

    def session_of(self, index: int) -> Session | None:
        """The session that frames with this index are of."""
        return self._by_index.get(index)

    def heard(self, session: Session) -> None:
        """Something genuine came in a session."""
        is_first = not session.heard_at
        session.heard_at, self._sent_at = clock_us(), 0
        if is_first and not session.is_initiator:
            self._up(session)
        self._stir()

    def control(self, session: Session, data: bytes) -> None:
        """The neighbour says something below the protocol."""
        kind, body = data[0] if data else -1, data[1:]
        if kind == ALIVE:
            self.tell(session, ANSWER)
        elif kind == REVOKED:
            self.sealer.revoke(body)
        elif kind == TWIN and body != self.sealer.life:
            self.sealer.note_twin(self.sealer.sender, f"node {session.who.number} hears both")

    def tell(self, session: Session, kind: int, body: bytes = b"") -> None:
        """Say something below the protocol."""
        if session.counter < COUNTERS:
            self.send(session.close(bytes((kind,)) + self.greeting(kind) + body, seal.CONTROL))

    def greeting(self, kind: int) -> bytes:
        """What goes with "are you there" and "I am"."""
        return b""

    def forget(self, session: Session) -> None:
        """Nothing is taken in this session any more."""
        self._by_index.pop(session.own, None)
        known = self.sessions.get(session.who.number, [])
        if session in known:
            known.remove(session)
            if not known:
                del self.sessions[session.who.number]
        if session is self._current:
            left = [one for several in self.sessions.values() for one in several]
            self._current = max(left, key=lambda one: one.made_at, default=None)

    def put_out(self, is_out: Callable[[Proven], bool]) -> bool:
        """Forget every session with those of whom that is true, and ask anew; True = there were."""
        gone = [session for session in self._by_index.values() if is_out(session.who)]
        for session in gone:
            self.forget(session)
        if gone or not self.sessions:
            self._answered.clear()
            self._asked.clear()
            self.ask_at_once()
        return bool(gone)

    def all_sessions(self) -> list[Session]:
        """The newest session with each neighbour."""
        return [several[0] for several in self.sessions.values()]

    def _first(self, data: bytes, key: int) -> str:
        ring = self.sealer.ring
        if key not in ring.keys:
            return "unknown key"
        if len(data) < 1 + KEY_BYTES + MAC_BYTES or not ring.is_marked(key, data):
            return "wrong key or damaged"
        known = self._answered.get(data[1 : 1 + KEY_BYTES])
        if known is not None:
            self.send(known.reply)
            return ""
        self.knocks.note(ANSWERED)
        handshake = ring.handshake(key, False)
        about = read_about(handshake.read(data[1:-MAC_BYTES]))
        why = self.sealer.objection(about, self.path)
        if (why and why != ANOTHER) or not self.is_for_us(about):
            return why
        index = self._draw_index()
        own = self._about(about.number, index, ring.certificate)
        message = bytes((seal.SECOND,)) + about.handle.to_bytes(4, "big")
        reply = ring.close(key, message + handshake.write(own.encode()))
        if why:  # or a recording of a call of ours: only who can answer is another
            self.send(reply)
            if self.knocks.may_ask():
                self.ask(self.sealer.sender)
            return why
        if handshake.is_done:
            who = ring.prove(about, key, b"")
            self._by_index[index] = Session(index, about.handle, handshake.split(), who, False)
        waiting = None if handshake.is_done else handshake
        self._remember(data[1 : 1 + KEY_BYTES], Answer(reply, index, waiting, about, key))
        self.listen()
        self.send(reply)
        return ""

    def is_for_us(self, about: About) -> bool:
        """True if a first message is to be answered."""
        return True

    def _remember(self, ephemeral: bytes, answer: Answer) -> None:
        self._answered[ephemeral] = answer
        if len(self._answered) > ANSWERS:
            oldest = self._answered.pop(next(iter(self._answered)))
            session = self._by_index.get(oldest.handle)
            if session is not None and not session.heard_at:
                del self._by_index[oldest.handle]

    def _second(self, data: bytes) -> str:
        index, ring = int.from_bytes(data[1:5], "big"), self.sealer.ring
        if index not in self._asked:
            return "" if index in self._by_index or self.path.is_group else "no such handshake"
        handshake, key = self._asked[index]
        if key not in ring.keys or not ring.is_marked(key, data):
            return "wrong key or damaged"
        del self._asked[index]
        about = read_about(handshake.read(data[5:-MAC_BYTES]))
        try:
            who = ring.prove(about, key, handshake.far_static)
        except ValueError as error:
            return str(error)
        why = self.sealer.objection(about, self.path)
        if why == ANOTHER:
            self.sealer.note_twin(self.sealer.sender, f"it is on {self.path.name}")
        if why:
            return why
        proof = b""
        if not handshake.is_done:
            own = self._about(about.number, index, ring.certificate)
            message = bytes((seal.THIRD,)) + about.handle.to_bytes(4, "big")
            proof = ring.close(key, message + handshake.write(own.encode()))
        session = Session(index, about.handle, handshake.split(), who, True)
        session.proof = proof or b"\0"
        self._by_index[index] = session
        self._prove(session)
        self._up(session)
        return ""

    def _prove(self, session: Session) -> None:
        """The last message, and a question in the session that shows that it came about."""
        if len(session.proof) > 1:
            self.send(session.proof)
        self.tell(session, ALIVE)

    def _third(self, data: bytes) -> str:
        index, ring = int.from_bytes(data[1:5], "big"), self.sealer.ring
        if index in self._by_index:
            return ""  # said again
        found = [(ephemeral, answer) for ephemeral, answer in self._answered.items()
                 if answer.handle == index]  # fmt: skip
        if not found or found[0][1].handshake is None:
            return "" if self.path.is_group else "no such handshake"
        ephemeral, answer = found[0]
        if answer.key not in ring.keys or not ring.is_marked(answer.key, data):
            return "wrong key or damaged"
        self._answered[ephemeral] = answer._replace(handshake=None)
        handshake = answer.handshake
        assert handshake is not None
        about = read_about(handshake.read(data[5:-MAC_BYTES]))
        if about[:4] != (answer.about.number, self.sealer.sender, *answer.about[2:4]):
            return "another than who asked"
        try:
            who = ring.prove(about, answer.key, handshake.far_static)
        except ValueError as error:
            return str(error)
        session = Session(index, about.handle, handshake.split(), who, False)
        self._by_index[index] = session
        self.heard(session)
        return ""

    def _up(self, session: Session) -> None:
        """A session was proved: from now on it is used."""
        now, who = clock_us(), session.who
        known = self.sessions.setdefault(who.number, [])
        known.insert(0, session)
        for old in known[SESSIONS:]:
            self.forget(old)
        self._current = session
        self._due.discard(who.number)
        self._wait_s, self._sent_at = WAIT_S, 0
        self.sealer.note_life(who)
        self.sealer.counts["handshakes"] += 1
        revoked = self.sealer.ring.revoked
        if revoked.data:
            self.tell(session, REVOKED, revoked.data)
        held, self._held = self._held, deque(maxlen=HELD)
        for due, data in held:
            if due >= now:
                sealed = self.close(data)
                if sealed is not None:
                    self.send(sealed)

    def _about(self, to: int, index: int, certificate: bytes = b"") -> About:
        own, far = self.path.bound_ends()
        return About(self.sealer.sender, to, self.sealer.life, index, own, far, certificate)

    def _draw_index(self) -> int:
        while True:
            index: int = machine().chance.getrandbits(32)
            if index not in self._by_index and index not in self._asked:
                return index
