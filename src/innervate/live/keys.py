"""Keys of a network: frames are sealed with ChaCha20-Poly1305, and no frame is taken twice."""

from __future__ import annotations

from collections import Counter
from hashlib import blake2s
from pathlib import Path
from typing import NamedTuple

from innervate.live.errors import LiveError
from innervate.live.machine import machine
from innervate.live.state import State
from innervate.network import networks
from innervate.wire import seal

KEY_BYTES = 32
AHEAD = 1 << 18  # counters that the file reserves: 16 s of the clock, 26,000 frames/s between saves
PER_MS = 16
KEYS_KEPT = 16  # keys whose windows are kept, those that are no longer accepted included


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


def mark_of(key: bytes) -> str:
    """What the state's file calls a key: tells keys apart and nothing about them."""
    return blake2s(b"innervate windows", key=key, digest_size=8).hexdigest()


class Opened(NamedTuple):
    """A sealed frame that is genuine and was not taken before.

    Attributes:
        frame: its bytes.
        sender: who sealed it.
        mark: the key's.
        counter: its number under that key.
    """

    frame: bytes
    sender: int
    mark: str
    counter: int


class Sealer:
    """Seals what leaves and opens what comes in.

    Args:
        kind: of network; frames of one are never taken for another's.
        sender: own number, 0 .. 65535.
        keys: keys by number, 0 .. 15; what comes in may be sealed with any of them.
        use: which one seals what leaves.
        state: keeps the counters over a restart.

    Attributes:
        dropped: frames that were not taken, by reason.
        keys: those that are accepted now.
        use: which one seals what leaves.
        windows: which counters were taken, by the key's mark and the sender: whoever takes up
            one key's numbers takes up no other's.
    """

    def __init__(
        self, kind: str, sender: int, keys: dict[int, bytes], use: int, state: State
    ) -> None:
        self.kind = networks()[kind].key_kind
        self.sender = sender
        self.state = state
        self.dropped: Counter[str] = Counter()
        self.windows: dict[str, dict[int, seal.Window]] = {
            mark: _windows(seen) for mark, seen in state.seen.items()
        }
        # Without a file no counter comes twice while the clock is right: they never fall behind it.
        self.counter = max(state.counter, machine().time_ns() // 1_000_000 * PER_MS)
        if self.counter + AHEAD > seal.COUNTER_MAX:
            raise LiveError(
                f"{state.path or 'clock'}: no counters are left for seals; set the clock, remove "
                "the file, and give the network another key"
            )
        self.load_keys(keys, use)
        for mark in self._marks.values():  # an old file does not say which key it was
            for number, window in _windows(state.seen_before).items():
                self.windows[mark].setdefault(number, window)

    def load_keys(self, keys: dict[int, bytes], use: int) -> None:
        """Other keys from now on: our counter goes on, and each key has windows of its own.

        Those of keys that are no longer accepted are kept for a while: they may come back.
        """
        from cryptography.hazmat.primitives.ciphers.aead import ChaCha20Poly1305

        self._ciphers = {number: ChaCha20Poly1305(key) for number, key in keys.items()}
        self._marks = {number: mark_of(key) for number, key in keys.items()}
        self.keys = dict(keys)
        self.use = use
        for mark in self._marks.values():
            self.windows[mark] = self.windows.pop(mark, {})  # the newest last
        while len(self.windows) > max(KEYS_KEPT, len(keys)):
            del self.windows[next(iter(self.windows))]

    def close(self, data: bytes) -> bytes:
        """Seal a frame: 25 bytes longer."""
        if self.counter >= self.state.counter:
            self._reserve()
        counter = self.counter
        self.counter = counter + 1
        head = seal.header(self.use, self.sender, counter)
        nonce = seal.nonce(self.kind, self.sender, counter)
        return head + self._ciphers[self.use].encrypt(nonce, data, head)

    def open(self, data: bytes) -> Opened | None:
        """The frame in sealed bytes; None if it is not genuine or was taken before (counted).

        It counts as taken only when `take` is told so.
        """
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
        mark = self._marks[number]
        window = self.windows[mark].get(sender)
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
        return Opened(frame, sender, mark, counter)

    def take(self, opened: Opened) -> None:
        """A frame is taken, and no copy of it will be."""
        windows = self.windows[opened.mark]
        if opened.sender not in windows:
            windows[opened.sender] = seal.Window()
        windows[opened.sender].take(opened.counter)

    def note(self, clean: bool) -> None:
        """Put into the state what is to be kept: counters that come next, at a clean end none.

        What was seen since can be replayed once if the node is then killed: write now and then.
        """
        if clean:
            self.state.counter = self.counter
        elif self.state.counter - self.counter < AHEAD // 2:
            self.state.counter = self.counter + AHEAD
        self.state.seen = {
            mark: {sender: window.highest for sender, window in windows.items()}
            for mark, windows in self.windows.items()
        }

    def _drop(self, reason: str) -> Opened | None:
        self.dropped[reason] += 1
        return None

    def _reserve(self) -> None:
        """The file reserves the counters that come next; where it cannot be written, we go on.

        A node that is silent helps nobody, and no counter comes twice unless it is then killed and
        the clock set back.
        """
        self.note(False)
        self.state.write()


def _windows(seen: dict[int, int]) -> dict[int, seal.Window]:
    """Windows in which nothing up to the newest counter of each sender is new."""
    return {sender: seal.Window(highest) for sender, highest in seen.items()}
