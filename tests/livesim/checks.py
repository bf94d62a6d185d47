"""What must hold whatever happens; looked at all the time."""

import random
from collections import Counter
from itertools import islice
from unittest import mock

from cryptography.hazmat.primitives.ciphers.aead import ChaCha20Poly1305

from innervate.dialect.arith import later
from innervate.live import group, noise, session
from innervate.live.receipts import DELIVERED, EXPIRED, FINAL, REFUSED

ITEMS_MOST = 60_000  # objects that a node may hold, however long it runs


class Nonces:
    """No nonce is used twice under a key, by whatever life of whatever process, for whatever.

    While this is entered all that is encrypted goes through here; under a key it rises.
    """

    def __init__(self, world):
        self.world = world
        self._last = {}  # key: the newest nonce
        self._rooms = [mock.patch.object(room, "ChaCha20Poly1305", self._cipher)
                       for room in (group, noise, session)]  # fmt: skip

    def __enter__(self):
        for room in self._rooms:
            room.start()
        return self

    def __exit__(self, *_):
        for room in self._rooms:
            room.stop()

    def _cipher(self, key):
        return Cipher(self, key)

    def used(self, key, nonce):
        counter = int.from_bytes(nonce[4:], "little")
        if counter <= self._last.get(key, -1):
            self.world.fail(f"nonce {counter} was used before")
        self._last[key] = counter


class Cipher:
    """The cipher, watched."""

    def __init__(self, nonces, key):
        self._nonces, self._key = nonces, key
        self._own = ChaCha20Poly1305(key)
        self.decrypt = self._own.decrypt

    def encrypt(self, nonce, data, more):
        self._nonces.used(self._key, nonce)
        return self._own.encrypt(nonce, data, more)


def takes_once(world, taken, life):
    """A process takes what is sealed once, whoever sends it again, and however often.

    Users would not see it: the router and the inbox know copies, too. `taken`: names of those who
    took it, by datagram; others are not looked at.
    """
    sealer, last = life.node.sealer, [b""]
    if sealer is None:
        return

    def opened(path, data, real=sealer.open):
        last[0] = data
        return real(path, data)

    def noted(one, real=sealer.take):
        names = taken.get(last[0])
        if names is not None:
            if life.name in names:
                world.fail(f"{life.name}: takes frame {one.counter} of {one.sender} once more")
            names.add(life.name)
        real(one)

    sealer.open, sealer.take = opened, noted


class Sent:
    """A message and what became of it."""

    __slots__ = ("at", "dest", "handed", "ident", "in_order", "life", "payload", "place",
                 "priority", "receipt", "sender")  # fmt: skip

    def __init__(self, ident, sender, life, dest, payload):
        self.ident, self.sender, self.life, self.dest = ident, sender, life, dest
        self.payload = payload
        self.handed = []  # (who, which life of it)
        self.receipt = None
        self.at = life.world.now
        self.place = 0  # in its stream
        self.in_order = self.priority = False


class Messages:
    """Messages: at most once, delivered means handed up, told what became of them, in order.

    Args:
        stage: with the `world`, and `quiet_since`: since when all is whole, ns; None = it is not.
        ends_s: within that time every message has its end, once all is whole.
    """

    def __init__(self, stage, ends_s):
        self.stage, self.world = stage, stage.world
        self.ends_s = ends_s
        self.sent = {}
        self.open = {}
        self.states = Counter()
        self.again = 0  # handed up once more by another life of the recipient
        self._count = 0
        self._newest = {}
        self._numbers = {}  # by sender: life and number of its newest packet, what its disk refused

    def new(self, sender, life, dest, length):
        """A message that nobody has sent yet; its payload says which one it is."""
        self._count += 1
        payload = self._count.to_bytes(5, "big") + random.Random(self._count).randbytes(length - 5)
        return Sent(self._count, sender, life, dest, payload)

    def accepted(self, sent):
        """It was handed to a node, and has a receipt now."""
        self.sent[sent.ident] = sent
        if sent.receipt is not None and sent.receipt.state != REFUSED:
            self.open[sent.ident] = sent
        elif sent.receipt is not None:
            self.states[REFUSED] += 1

    def handed_up(self, who, life, sender, payload, in_order):
        """A node gives a message to its user."""
        if not life.alive:
            return
        sent = self.sent.get(int.from_bytes(payload[:5], "big"))
        if sent is None or sent.payload != payload or sent.sender != sender:
            self.world.fail(
                f"{life.name}: from {sender} came {payload[:90].hex()}, which nobody sent"
            )
            return
        if sent.dest not in (who, 255):
            self.world.fail(f"{life.name}: has message {sent.ident}, which is for {sent.dest}")
        if (who, life.number) in sent.handed:
            self.world.fail(f"{life.name}: has message {sent.ident} twice")
        self.again += any(one == who for one, _ in sent.handed)
        sent.handed.append((who, life.number))
        if in_order and sent.in_order:
            self._in_turn(who, life, sent)

    def _in_turn(self, who, life, sent):
        key = (who, life.number, sent.sender, sent.priority)
        place = (sent.life.number, sent.place)
        if place <= self._newest.get(key, (0, 0)):
            self.world.fail(f"{life.name}: message {sent.ident} of {sent.life.name} after its turn")
        self._newest[key] = place

    def _look_at_number(self, sent):
        """Numbers go on over a restart, where the disk could keep them."""
        seq, refused = sent.receipt.seq, sent.life.host.disk.refused
        old, newest, before = self._numbers.get(sent.sender, (sent.life, -1, 0))
        lives = sent.life.number - old.number  # eight restarts may lead half way round
        is_kept = refused == before and not old.node.state.failed
        if 0 < lives < 8 and newest >= 0 and is_kept and not later(seq, newest):
            self.world.fail(f"{sent.life.name}: packet {seq} after {newest} of {old.name}")
        if old is not sent.life or newest < 0 or later(seq, newest):
            self._numbers[sent.sender] = (sent.life, seq, refused)

    def look(self):
        """What became of those that are under way."""
        now = self.world.now
        for ident, sent in list(self.open.items()):
            state = sent.receipt.state
            if sent.receipt.seq >= 0:
                self._look_at_number(sent)
            if state == DELIVERED and not sent.handed:
                self.world.fail(
                    f"message {ident} from {sent.life.name} to {sent.dest} is delivered, "
                    "but was never handed up"
                )
            if state in FINAL:
                self.states[state] += 1
                self.states["expired but handed up"] += state == EXPIRED and bool(sent.handed)
                del self.open[ident]
            elif not sent.life.alive:
                self.states["sender gone"] += 1
                del self.open[ident]
            elif self.stage.quiet_since is not None and now > self.ends_s * 1e9 + max(
                sent.at, self.stage.quiet_since
            ):
                self.world.fail(f"message {ident} from {sent.life.name} to {sent.dest} has no end")

    def forget(self):
        """Those that had their end long ago."""
        old = self.world.now - 600 * 1_000_000_000
        for ident, one in list(islice(self.sent.items(), 20)):
            if one.at < old and ident not in self.open:
                del self.sent[ident]


def items_of(thing):
    """How many objects hang from this one: containers and plain objects."""
    seen, count, waiting = set(), 0, [thing]
    while waiting:
        one = waiting.pop()
        if id(one) in seen:
            continue
        seen.add(id(one))
        count += 1
        if isinstance(one, dict):
            waiting += [*one.keys(), *one.values()]
        elif isinstance(one, (list, tuple, set, frozenset)) or type(one).__name__ == "deque":
            if one and isinstance(next(iter(one)), (int, float)):
                count += len(one)
            else:
                waiting += one
        elif type(one).__module__.startswith("innervate"):
            waiting += vars(one).values() if hasattr(one, "__dict__") else ()
    return count
