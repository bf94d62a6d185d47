"""A session: what two neighbours seal for each other on one path, with keys of their own."""

from typing import NamedTuple

from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import ChaCha20Poly1305

from innervate.live.engine import clock_us
from innervate.live.keyring import About, Proven
from innervate.live.noise import Handshake, nonce
from innervate.wire import seal

COUNTERS = seal.COUNTER_MAX - 1000  # then nothing is sealed any more
REKEY_US = 600_000_000


class Session:
    """Seals for one neighbour, and opens what it sealed for us.

    Args:
        own: the index under which we want its frames.
        far: the one under which it wants ours.
        keys: of what we send, and of what we receive.
        who: who it is.
        is_initiator: the handshake began here.

    Attributes:
        made_at: when it was, us.
        heard_at: when something in it came in last, us; 0 = nothing yet.
        proof: the message that ends the handshake; sent again until something is heard.
        counter: of the next frame.
        window: which of its frames were taken.
    """

    def __init__(
        self, own: int, far: int, keys: tuple[bytes, bytes], who: Proven, is_initiator: bool
    ) -> None:
        self.own, self.far, self.who = own, far, who
        self.made_at, self.is_initiator = clock_us(), is_initiator
        self.heard_at = 0
        self.proof = b""
        self.counter = 0
        self.window = seal.Window()
        self._out, self._in = map(ChaCha20Poly1305, keys)

    def close(self, data: bytes, kind: int = seal.FRAME) -> bytes:
        """Seal a frame, 25 bytes longer."""
        counter = self.counter
        assert counter < COUNTERS
        self.counter = counter + 1
        head = seal.header(kind, self.far, counter)
        return head + self._out.encrypt(nonce(counter), data, head)

    def open(self, counter: int, data: bytes) -> bytes | None:
        """What was sealed; None = not by him, or not for this session."""
        head = data[: seal.HEADER_BYTES]
        try:
            return self._in.decrypt(nonce(counter), data[seal.HEADER_BYTES :], head)
        except InvalidTag:
            return None

    def is_worn(self, now: int) -> bool:
        """True if a new one should take its place; who began this one asks for it first."""
        late = REKEY_US if self.is_initiator else REKEY_US * 6 // 5
        return now - self.made_at > late or self.counter > COUNTERS // 2


class Answer(NamedTuple):
    """What was answered to a first message: the same again if it is repeated."""

    reply: bytes
    handle: int
    handshake: Handshake | None
    about: About
    key: int
