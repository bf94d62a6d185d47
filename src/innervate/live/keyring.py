"""What a node proves itself with: keys that all have, or an identity of its own."""

import hmac
import struct
from hashlib import blake2s
from pathlib import Path
from typing import NamedTuple

from innervate.live import identity as identities
from innervate.live import noise
from innervate.live.errors import LiveError
from innervate.live.identity import Identity, Revoked
from innervate.live.machine import machine

KEY_BYTES = 32
MAC_BYTES = 16
LIFE_BYTES = 8
ANYBODY = 0xFFFF  # a first message that is for whoever hears it
ABOUT = struct.Struct(">HH8sI")  # number, for whom, life, index; then both ends, a certificate
PROLOGUE = b"innervate 2 network "
SHARED = 0  # the number of an identity's shared key


def read_key(text: str, folder: Path) -> bytes:
    """A key from 64 hexadecimal digits, or from a file that holds them ("file:NAME").

    Raises:
        LiveError: it is no key, or the file cannot be read.
    """
    if text.startswith("file:"):
        path = folder / text[5:]
        try:
            text = machine().read_text(path).strip()
        except (OSError, UnicodeDecodeError) as error:
            why = getattr(error, "strerror", None) or "no text"
            raise LiveError(f"{path}: the key cannot be read: {why}") from None
    try:
        key = bytes.fromhex(text)
    except ValueError:
        key = b""
    if len(key) != KEY_BYTES:
        raise LiveError("a key is 64 hexadecimal digits; make one with: openssl rand -hex 32")
    return key


class About(NamedTuple):
    """What a node says of itself in a handshake.

    Attributes:
        number: its own.
        to: whom it speaks to; ANYBODY = whoever is there.
        life: drawn at its start.
        handle: the index under which it wants frames of this session.
        own: the address of its end of the path, "" = not known.
        far: that of the other end.
        certificate: of its identity; b"" = it has none, or does not show it yet.
    """

    number: int
    to: int
    life: bytes
    handle: int
    own: str
    far: str
    certificate: bytes = b""

    def encode(self) -> bytes:
        """As it stands in a message."""
        ends = b"".join(bytes((len(end),)) + end for end in
                        (text.encode()[:255] for text in (self.own, self.far)))  # fmt: skip
        return ABOUT.pack(self.number, self.to, self.life, self.handle) + ends + self.certificate


def read_about(data: bytes) -> About:
    """What somebody says of himself; noise.Broken if it is cut short."""
    try:
        number, to, life, index = ABOUT.unpack_from(data)
        at, ends = ABOUT.size, []
        for _ in range(2):
            size = data[at]
            ends.append(data[at + 1 : at + 1 + size].decode())
            at += 1 + size
    except (struct.error, IndexError, UnicodeDecodeError):
        raise noise.Broken from None
    return About(number, to, life, index, ends[0], ends[1], data[at:])


def is_same_end(claimed: str, known: str) -> bool:
    """True if two names of one end of a path can both be right; "" and any address: not known."""
    if not claimed or not known or claimed == known:
        return True
    (host, _, port), (other, _, another) = claimed.rpartition(":"), known.rpartition(":")
    return port == another and not {host, other}.isdisjoint(("0.0.0.0", "[::]"))


class Proven(NamedTuple):
    """Who is at the far end of a session.

    Attributes:
        number: the node's.
        life: of this start of its process.
        key: number of the network's key by which it was proved.
        serial: of its certificate; 0 = it has none.
        signing: its public key of signatures; b"" = it has none.
    """

    number: int
    life: bytes
    key: int
    serial: int = 0
    signing: bytes = b""


class Keyring:
    """The keys of one node.

    Args:
        kind: number of the network; those of one are never taken for another's.
        keys: keys by number that the whole network has; with an identity they are its own.
        use: which one is used for handshakes that begin here.
        identity: of this node.

    Attributes:
        revoked: which certificates are put out.
    """

    def __init__(
        self, kind: int, keys: dict[int, bytes], use: int, identity: Identity | None = None
    ) -> None:
        self._prologue = PROLOGUE + bytes((kind,))
        self.identity = identity
        self.revoked = Revoked()
        self.pattern = noise.IDENTITY if identity else noise.NETWORK
        self.static = identity.exchange if identity else b""
        self.certificate = identity.certificate if identity else b""
        self.load({SHARED: identity.shared} if identity else keys, SHARED if identity else use)

    def load(self, keys: dict[int, bytes], use: int) -> None:
        """Other keys from now on."""
        self.keys, self.use = dict(keys), use
        self._begun = {number: noise.Symmetric(self.pattern, self._prologue, key)
                       for number, key in keys.items()}  # fmt: skip
        self._mac_keys = {number: blake2s(b"innervate mac", key=key).digest()
                          for number, key in keys.items()}  # fmt: skip

    def handshake(self, key: int, is_initiator: bool) -> noise.Handshake:
        """One side of a handshake under a key, at its beginning."""
        draw = machine().chance.randbytes
        return noise.Handshake(self.pattern, self._begun[key], is_initiator, draw, self.static)

    def close(self, key: int, data: bytes) -> bytes:
        """A message with the mark behind it that only those make who have the key."""
        return data + self._mac(key, data)

    def is_marked(self, key: int, data: bytes) -> bool:
        """True if a message has that mark: all that is done for strangers."""
        return hmac.compare_digest(self._mac(key, data[:-MAC_BYTES]), data[-MAC_BYTES:])

    def prove(self, about: About, key: int, static: bytes) -> Proven:
        """Who is at the far end of a handshake that was finished.

        Raises:
            ValueError: the authority does not know him by this number, or has put him out.
        """
        if self.identity is None:
            return Proven(about.number, about.life, key)
        authority = self.identity.authority
        serial, signing = identities.check(authority, about.number, static, about.certificate)
        if serial in self.revoked.serials:
            raise ValueError("revoked")
        return Proven(about.number, about.life, key, serial, signing)

    def _mac(self, key: int, data: bytes) -> bytes:
        return blake2s(data, key=self._mac_keys[key], digest_size=MAC_BYTES).digest()
