"""Seals what leaves a node and opens what comes in; see docs/decisions/0028-nobody-pretends.md."""

from collections import Counter
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, NamedTuple

from innervate.live.contact import ANOTHER, REVOKED, TWIN, Contact
from innervate.live.engine import clock_us
from innervate.live.group import GroupContact
from innervate.live.identity import Identity, Revoked, read_revoked
from innervate.live.keyring import LIFE_BYTES, About, Keyring, Proven, is_same_end
from innervate.live.links import Path
from innervate.live.machine import machine
from innervate.live.state import State
from innervate.network import networks
from innervate.wire import seal

LIVES = 8  # starts of a node that are remembered
TWIN_US = 1_000_000  # frames of a life that is over may still come for so long
TELL_US = 10_000_000  # twins are told of each other so often
CERTIFICATES = 8  # are named one by one in a line of the log
TWINS_US = 120_000_000  # ... and forgotten when nobody noted them for so long


class Opened(NamedTuple):
    """A sealed frame that is genuine and was not taken before.

    Attributes:
        frame: its bytes.
        sender: who sealed it.
        counter: its number.
        window: notes it once it is taken.
    """

    frame: bytes
    sender: int
    counter: int
    window: seal.Window


def ring_of(kind: str, keys: dict[int, bytes], use: int, own: Identity | None = None) -> Keyring:
    """What a node of a kind of network proves itself with; no other kind takes its frames.

    Args:
        kind: of network.
        keys: keys by number, 0 .. 15; handshakes may begin with any of them.
        use: which one our own begin with.
        own: the node's identity; then the keys are its own.
    """
    return Keyring(networks()[kind].key_kind, keys, use, own)


class Sealer:
    """What a node has to do with keys.

    Args:
        ring: what it proves itself with, see `ring_of`.
        sender: own number, 0 .. 65535.
        state: keeps the list of revoked nodes over a restart.
        nodes: how many numbers there are; None = any.

    Attributes:
        dropped: frames that were not taken, by reason.
        counts: handshakes, and frames that waited for one.
        life: what this start is told apart by from others.
        refused: how many frames were not taken.
        twins: numbers that more than one node has, with who says so.
        has_bound_ends: both ends of a path have to agree on their addresses.
    """

    def __init__(
        self, ring: Keyring, sender: int, state: State | None = None, nodes: int | None = None
    ) -> None:
        self.ring, identity = ring, ring.identity
        self.sender, self.nodes = sender, nodes
        self.state = state or State(None)
        self.life = machine().chance.randbytes(LIFE_BYTES)
        self.dropped: Counter[str] = Counter()
        self.counts: Counter[str] = Counter()
        self.twins: dict[int, str] = {}
        self._noted: dict[int, int] = {}  # when a twin was noted last
        self.refused = 0
        self.has_bound_ends = True
        self.said: Callable[[str, str], None] = lambda _matter, _text: None
        self._contacts: dict[int, Contact] = {}
        self._lives: dict[int, list[bytes]] = {}  # of each neighbour, the newest first
        self._since: dict[int, int] = {}  # when its newest was first heard, us
        self._told_at: dict[int, int] = {}
        if identity is not None and self.state.revoked:
            try:
                self.ring.revoked = read_revoked(identity.authority, self.state.revoked)
            except ValueError:
                self.state.revoked = b""  # another authority's, of before

    def start(self, paths: Iterable[Path]) -> None:
        """Ask on every path who is there."""
        for path in paths:
            made = (GroupContact if path.is_group else Contact)(self, path)
            self._contacts[path.port] = made
            path.moved = partial(made.put_out, lambda _: True)  # ends have to agree anew
            made.start()

    def stop(self) -> None:
        """Ask no more who is there."""
        for contact in self._contacts.values():
            contact.stop()

    def load_keys(self, keys: dict[int, bytes], use: int) -> None:
        """Other keys from now on; sessions that were made by those that are gone end."""
        gone = self.ring.keys.keys() - keys.keys()
        changed = use != self.ring.use
        self.ring.load(keys, use)
        for contact in self._contacts.values():
            if gone:
                contact.put_out(lambda who: who.key in gone)
            elif changed:
                contact.renew_all()
            contact.listen()

    def close(self, path: Path, data: bytes) -> bytes | None:
        """Seal a frame for a path; None = it waits until somebody has proved to be there."""
        return self._contacts[path.port].close(data)

    def open(self, path: Path, data: bytes) -> Opened | None:
        """The frame in sealed bytes; None if there is none to be taken, for whatever reason.

        It counts as taken only when `take` is told so.
        """
        contact = self._contacts.get(path.port)
        if contact is None:
            return self._drop("sealed: not started")
        if not seal.is_sealed(data):
            contact.in_clear()
            return self._drop("not sealed")
        if data[0] in (seal.SECOND, seal.THIRD) or data[0] >= seal.FIRST:
            why = contact.take(data)
            self.counts["handshake messages"] += not why
            return self._drop(f"sealed: {why}") if why else None
        parts = seal.fields(data)
        if parts is None:
            return self._drop("sealed: length")
        kind, index, counter = parts
        if kind == seal.GROUP:
            return self._open_group(contact, index, counter, data)
        session = contact.session_of(index)
        if session is None:
            if path.is_group:  # others' handshakes and what they say in pairs
                self.counts["for other members"] += 1
                return None
            return self._drop("sealed: no such session")
        if not session.window.is_new(counter):
            return self._drop("sealed: replayed")
        frame = session.open(counter, data)
        if frame is None:
            return self._drop("sealed: wrong key or damaged")
        contact.heard(session)
        self._look_for_twin(session.who)
        if kind == seal.CONTROL:
            session.window.take(counter)
            self.counts["control frames"] += 1
            contact.control(session, frame)
            return None
        return Opened(frame, session.who.number, counter, session.window)

    def _open_group(self, contact: Contact, place: int, counter: int, data: bytes) -> Opened | None:
        if not isinstance(contact, GroupContact):
            return self._drop("sealed: for a group")
        found = contact.open_group(place, counter, data)
        if isinstance(found, str):
            return self._drop(f"sealed: {found}")
        frame, heard = found
        self._look_for_twin(heard.who)
        return Opened(frame, heard.who.number, counter, heard.window)

    def take(self, opened: Opened) -> None:
        """A frame is taken, and no copy of it will be."""
        opened.window.take(opened.counter)

    def objection(self, about: About, path: Path) -> str:
        """Why somebody cannot be who he says in a handshake; "" if he can."""
        if about.number == self.sender:
            return "our own" if about.life == self.life else ANOTHER
        if self.nodes is not None and about.number >= self.nodes:
            return "from no node of ours"
        own, far = path.bound_ends()
        if self.has_bound_ends and not (
            is_same_end(about.own, far) and is_same_end(about.far, own)
        ):
            return "from another place"
        return ""

    def note_life(self, who: Proven) -> None:
        """A node has proved to be there, in this life."""
        lives = self._lives.setdefault(who.number, [])
        if lives and lives[0] == who.life:
            return
        if who.life in lives:  # it was over: two of them take turns
            lives.remove(who.life)
            self.note_twin(who.number, "both are heard here")
        lives.insert(0, who.life)
        del lives[LIVES:]
        self._since[who.number] = clock_us()

    def _look_for_twin(self, who: Proven) -> None:
        """What comes from an older life of a node, long after a newer one began, is another's."""
        lives = self._lives.get(who.number)
        if not lives or lives[0] == who.life:
            return
        now = clock_us()
        if now - self._since[who.number] < TWIN_US:
            return
        self.note_twin(who.number, "both are heard here")
        if now - self._told_at.get(who.number, -TELL_US) >= TELL_US:
            self._told_at[who.number] = now
            for contact in self._contacts.values():
                for session in contact.sessions.get(who.number, []):
                    other = lives[0] if session.who.life != lives[0] else who.life
                    contact.tell(session, TWIN, other)

    def note_twin(self, number: int, where: str) -> None:
        """Two nodes have one number: count it, and say so."""
        self.counts["two nodes with one number"] += 1
        self.twins[number] = where
        self._noted[number] = clock_us()
        whose = "our number" if number == self.sender else "one number"
        self.said("twin", f"two nodes have {whose}, {number}: {where}; give one of them another")

    def revoke(self, data: bytes) -> bool:
        """Take over a newer list of revoked nodes, and hand it on; False = it is none or not newer.

        What is not signed is dropped and counted.
        """
        identity, old = self.ring.identity, self.ring.revoked
        if identity is None or data == old.data:
            return False
        try:
            new = read_revoked(identity.authority, data)
        except ValueError:
            self._drop("sealed: a list that our authority has not signed")
            return False
        if new.version <= old.version:
            return False
        self._put_out(new)
        return True

    def _put_out(self, new: Revoked) -> None:
        fresh = sorted(new.serials - self.ring.revoked.serials)
        self.ring.revoked = new
        self.state.revoked = new.data
        self.state.write()
        what = f"put out: {self._certificates(fresh)}"
        if self.ring.identity is not None and self.ring.identity.serial in new.serials:
            what = "this node's identity is put out"
        self.said(f"revoked by list {new.version}", f"{what}, list {new.version}")
        for contact in self._contacts.values():
            for session in contact.all_sessions():
                contact.tell(session, REVOKED, new.data)
            contact.put_out(lambda who: who.serial in new.serials)

    def _certificates(self, serials: list[int]) -> str:
        """Some certificates, with the numbers of those that are neighbours."""
        there = [one for contact in self._contacts.values() for one in contact.all_sessions()]
        near = {session.who.serial: session.who.number for session in there}
        named = [f"certificate {serial}" + (f" of node {near[serial]}" if serial in near else "")
                 for serial in serials[:CERTIFICATES]]  # fmt: skip
        more = len(serials) - CERTIFICATES
        return ", ".join(named) + (f" and {more} more" if more > 0 else "")

    def status(self) -> dict[str, Any]:
        """Which key handshakes begin with, which are accepted; with an identity, its own."""
        told: dict[str, Any] = {"use": self.ring.use, "accepted": sorted(self.ring.keys)}
        if self.ring.identity is not None:
            revoked = self.ring.revoked
            told["identity"] = {"serial": self.ring.identity.serial, "list": revoked.version,
                                "revoked": sorted(revoked.serials)}  # fmt: skip
        still = clock_us() - TWINS_US
        if twins := {str(number): where for number, where in self.twins.items()
                     if self._noted[number] > still}:  # fmt: skip
            told["twins"] = twins
        return told

    def _drop(self, reason: str) -> Opened | None:
        self.refused += 1
        self.dropped[reason] += 1
        return None
