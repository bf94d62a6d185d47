"""Contact on a path where all hear all: sessions in pairs, and a key of each node for what it says.

A node seals once for everybody, under a key that it gives each member in their session. Members
could seal with it, too: with identities each frame is signed besides.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import TYPE_CHECKING

from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
from cryptography.hazmat.primitives.ciphers.aead import ChaCha20Poly1305

from innervate.live.contact import ALIVE, ANSWER, HELD_US, IDLE_S, KNOCKS, Contact
from innervate.live.engine import clock_us
from innervate.live.identity import SIGNATURE_BYTES, is_signed
from innervate.live.keyring import ANYBODY, KEY_BYTES, About, Proven
from innervate.live.links import Path
from innervate.live.machine import machine
from innervate.live.noise import nonce
from innervate.live.session import COUNTERS, Session
from innervate.wire import seal

if TYPE_CHECKING:
    from innervate.live.keys import Sealer

CALL_US = 5_000_000  # so often a node says that it is there, once the first calls are over
CALLS = 4  # first calls, one with each wait
SEEK_US = 1_000_000  # a stranger's frame makes us ask so often at most
EPOCH_BITS = 16
GREETING = struct.Struct(">HI32s")  # epoch of our key, our next counter under it, the key
EPOCHS = 2  # keys of a member: frames under the older one may come late


class Heard:
    """A member's key, and what was taken under it: nothing that it said before we knew it."""

    def __init__(self, who: Proven, key: bytes, counter: int) -> None:
        self.who = who
        self.cipher = ChaCha20Poly1305(key)
        self.window = seal.Window(counter - 1)


class GroupContact(Contact):
    """What the node of a sealer knows of the members of a group, on the group's path."""

    most_knocks = 4 * KNOCKS  # many members may come at once
    rest_s = IDLE_S  # there is always somebody to call

    def __init__(self, sealer: Sealer, path: Path) -> None:
        super().__init__(sealer, path)
        self._called_at = 0
        self._calls = 0
        self._sought_at = -SEEK_US
        self._heard: dict[tuple[int, int], Heard] = {}
        identity = sealer.ring.identity
        self._signing = Ed25519PrivateKey.from_private_bytes(identity.signing) if identity else None
        self.renew()

    def _known(self) -> dict[int, int]:
        """Besides our indices the keys of members, and the least counter under each."""
        known = {number << 16 | epoch: heard.window.least
                 for (number, epoch), heard in self._heard.items()}  # fmt: skip
        return known | super()._known()

    def _anybody(self) -> list[tuple[int, int]]:
        """What is sealed for a group may be of a member that we do not know yet."""
        return [*super()._anybody(), (seal.GROUP, seal.GROUP)]

    def renew(self) -> None:
        """Another key for what we say, of which nobody knows who is not told from now on."""
        chance = machine().chance
        self._epoch = chance.getrandbits(EPOCH_BITS)
        self._key = chance.randbytes(KEY_BYTES)
        self._cipher = ChaCha20Poly1305(self._key)
        self._counter = 0

    def greeting(self, kind: int) -> bytes:
        """Our key, and how far we are with it, go with "are you there" and "I am"."""
        if kind not in (ALIVE, ANSWER):
            return b""
        return GREETING.pack(self._epoch, self._counter, self._key)

    def control(self, session: Session, data: bytes) -> None:
        """A member's key comes with what it says."""
        if data[:1] in (bytes((ALIVE,)), bytes((ANSWER,))) and len(data) == 1 + GREETING.size:
            self._learn(session.who, *GREETING.unpack_from(data, 1))
        super().control(session, data)

    def _learn(self, who: Proven, epoch: int, counter: int, key: bytes) -> None:
        known = self._heard.get((who.number, epoch))
        if known is not None and known.who.life == who.life:
            return
        self._heard[who.number, epoch] = Heard(who, key, counter)
        of = [place for place in self._heard if place[0] == who.number]
        for place in of[:-EPOCHS]:
            del self._heard[place]

    def close(self, data: bytes) -> bytes | None:
        """Seal a frame for all members; None = there is none yet, and it waits a little."""
        if not self.sessions or self._counter >= COUNTERS:
            self._held.append((clock_us() + HELD_US, data))
            self.sealer.counts["held: no session yet"] += 1
            return None
        counter, own = self._counter, self.sealer.sender << 16 | self._epoch
        self._counter = counter + 1
        head = seal.header(seal.GROUP, own, counter)
        if self._signing is not None:
            data += self._signing.sign(head + data)
        return head + self._cipher.encrypt(nonce(counter), data, head)

    def open_group(self, place: int, counter: int, data: bytes) -> tuple[bytes, Heard] | str:
        """What a member says to all, and whose key it is; or why it is not taken."""
        number, epoch = place >> 16, place & 0xFFFF
        if number == self.sealer.sender:
            return "our own"
        heard = self._heard.get((number, epoch))
        if heard is None:
            self._seek(number)
            return "unknown sender"
        if not heard.window.is_new(counter):
            return "replayed"
        head = data[: seal.HEADER_BYTES]
        try:
            plain = heard.cipher.decrypt(nonce(counter), data[seal.HEADER_BYTES :], head)
        except InvalidTag:
            return "wrong key or damaged"
        if heard.who.signing:
            plain, signature = plain[:-SIGNATURE_BYTES], plain[-SIGNATURE_BYTES:]
            if not is_signed(heard.who.signing, signature, head + plain):
                return "signed by another than it is from"
        return plain, heard

    def _seek(self, number: int) -> None:
        """A member whom we do not know, perhaps: ask, now and then."""
        self.knocks.note()
        now = clock_us()
        if now - self._sought_at >= SEEK_US and self._timer is not None:
            self._sought_at = now
            self.ask(number)

    def is_for_us(self, about: About) -> bool:
        """A call to all is answered with a question of ours, if it is of somebody new."""
        if about.to == ANYBODY:
            known = self.sessions.get(about.number)
            is_new = not known or known[0].who.life != about.life
            if is_new and (about.number != self.sealer.sender or self.knocks.may_ask()):
                self.ask(about.number)
        return about.to == self.sealer.sender

    def _wants_session(self, now: int) -> bool:
        """Ask members whose sessions are worn or of an old key; then whether to call all."""
        for session in self.all_sessions():
            if session.who.number in self._due or session.is_worn(now):
                self.ask(session.who.number)
        if self._counter > COUNTERS // 2:
            self.renew()
            for session in self.all_sessions():
                self.tell(session, ALIVE)
        if self._calls < CALLS or now - self._called_at >= CALL_US:
            self._calls += 1
            self._called_at = now
            return True
        return False

    def forget(self, session: Session) -> None:
        """Nothing is taken of a member without a session."""
        super().forget(session)
        if session.who.number not in self.sessions:
            for place in [place for place in self._heard if place[0] == session.who.number]:
                del self._heard[place]

    def put_out(self, is_out: Callable[[Proven], bool]) -> bool:
        """Those that are out know our key: the others are told another one."""
        are_some = super().put_out(is_out)
        if are_some:
            self.renew()
            for session in self.all_sessions():
                self.tell(session, ALIVE)
        return are_some
