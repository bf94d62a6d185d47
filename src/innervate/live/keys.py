"""Keys of a network: frames are sealed with ChaCha20-Poly1305, and no frame is taken twice."""

from __future__ import annotations

import time
from collections import Counter
from pathlib import Path

from innervate.live.errors import LiveError
from innervate.live.state import State
from innervate.wire import seal

KEY_BYTES = 32
AHEAD = 1 << 20  # counters reserved at once: the file is written that seldom
PER_MS = 16
KINDS = {"mesh": 1, "skin": 2, "radio": 3}


def read_key(text: str, folder: Path) -> bytes:
    """A key from 64 hexadecimal digits, or from a file that holds them ("file:NAME").

    Raises:
        LiveError: it is no key, or the file cannot be read.
    """
    if text.startswith("file:"):
        path = folder / text[5:]
        try:
            text = path.read_text().strip()
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


class Sealer:
    """Seals what leaves and opens what comes in.

    Args:
        kind: "mesh", "skin" or "radio"; frames of one are never taken for another's.
        sender: own number, 0 .. 65535.
        keys: keys by number, 0 .. 15; what comes in may be sealed with any of them.
        use: which one seals what leaves.
        state: keeps the counters over a restart.

    Attributes:
        dropped: frames that were not taken, by reason.
        keys: those that are accepted now.
        use: which one seals what leaves.
    """

    def __init__(
        self, kind: str, sender: int, keys: dict[int, bytes], use: int, state: State
    ) -> None:
        self.kind = KINDS[kind]
        self.sender = sender
        self.state = state
        self.dropped: Counter[str] = Counter()
        self.windows: dict[int, seal.Window] = {}
        # A lost file does no harm while the clock is right: counters never fall behind it.
        self.counter = max(state.counter, int(time.time() * 1000) * PER_MS)
        for number, highest in state.seen.items():
            self.windows[number] = seal.Window(highest)
        self.load_keys(keys, use)

    def load_keys(self, keys: dict[int, bytes], use: int) -> None:
        """Other keys from now on: counters and windows stay."""
        from cryptography.hazmat.primitives.ciphers.aead import ChaCha20Poly1305

        self._ciphers = {number: ChaCha20Poly1305(key) for number, key in keys.items()}
        self.keys = dict(keys)
        self.use = use

    def close(self, data: bytes) -> bytes:
        """Seal a frame: 25 bytes longer."""
        if self.counter >= self.state.counter:
            self._reserve()
        counter = self.counter
        self.counter = counter + 1
        head = seal.header(self.use, self.sender, counter)
        nonce = seal.nonce(self.kind, self.sender, counter)
        return head + self._ciphers[self.use].encrypt(nonce, data, head)

    def open(self, data: bytes) -> bytes | None:
        """The frame in sealed bytes; None if it is not genuine or was seen before (counted)."""
        if not seal.is_sealed(data):
            return self._drop("not sealed")
        parts = seal.fields(data)
        if parts is None:
            return self._drop("sealed: length")
        number, sender, counter = parts
        cipher = self._ciphers.get(number)
        if cipher is None:
            return self._drop("sealed: unknown key")
        if sender == self.sender:
            return self._drop("sealed: our own")
        window = self.windows.get(sender)
        if window is not None and not window.is_new(counter):
            return self._drop("sealed: replayed")
        from cryptography.exceptions import InvalidTag

        head = data[: seal.HEADER_BYTES]
        try:
            frame = cipher.decrypt(
                seal.nonce(self.kind, sender, counter), data[seal.HEADER_BYTES :], head
            )
        except InvalidTag:
            return self._drop("sealed: wrong key or damaged")
        if window is None:
            window = self.windows[sender] = seal.Window()
        window.take(counter)
        return frame

    def note(self, clean: bool) -> None:
        """Put into the state what is to be kept: at a clean end no counter is skipped.

        What was seen since can be replayed once if the node is then killed: write now and then.
        """
        if clean:
            self.state.counter = self.counter
        self.state.seen = {sender: window.highest for sender, window in self.windows.items()}

    def _drop(self, reason: str) -> bytes | None:
        self.dropped[reason] += 1
        return None

    def _reserve(self) -> None:
        self.state.counter = self.counter + AHEAD
        self.note(False)
        self.state.write()
