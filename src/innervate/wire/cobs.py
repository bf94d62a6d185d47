"""Frames on a serial line: consistent overhead byte stuffing (Cheshire and Baker 1999).

A frame goes out without zeros and a zero behind it, so that a receiver finds the next frame again
whatever it has missed. The cost is a byte for every 254, and the zero.
"""

BLOCK = 254  # most bytes between two codes


def encode(data: bytes | bytearray | memoryview) -> bytes:
    """What goes out on the line for a frame, the zero behind it included."""
    out = bytearray(1)
    code_at = 0
    for byte in data:
        if len(out) - code_at > BLOCK:  # a full block: its code stands for no zero
            out[code_at] = BLOCK + 1
            code_at = len(out)
            out.append(0)
        if byte == 0:
            out[code_at] = len(out) - code_at
            code_at = len(out)
            out.append(0)
        else:
            out.append(byte)
    out[code_at] = len(out) - code_at
    out.append(0)
    return bytes(out)


class Decoder:
    """Finds frames in the bytes of a line, however they are cut up; any bytes at all will do.

    Attributes:
        limit: frames of more bytes than this are dropped.
        dropped: how many pieces between zeros were too long or no frame.
    """

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.dropped = 0
        self._buffer = bytearray()
        self._left = 0  # bytes of the present block still to come
        self._zero = False  # a zero stands between this block and the next
        self._bad = False
        self._fresh = True  # nothing since the last zero

    def feed(self, data: bytes | bytearray | memoryview) -> list:  # type: ignore[type-arg]
        """Take received bytes: the frames, as bytes, that they complete; an empty one counts."""
        frames = []
        for byte in data:
            if byte != 0:
                self._take(byte)
                continue
            if self._bad or self._left:
                self.dropped += 1
            elif not self._fresh:
                frames.append(bytes(self._buffer))
            self._buffer = bytearray()
            self._left = 0
            self._zero = self._bad = False
            self._fresh = True
        return frames

    def _take(self, byte: int) -> None:
        self._fresh = False
        if self._bad:
            return
        if self._left:
            self._left -= 1
            self._buffer.append(byte)
        else:
            if self._zero:
                self._buffer.append(0)
            self._left = byte - 1
            self._zero = byte <= BLOCK
        if len(self._buffer) > self.limit:
            self._bad = True
            self._buffer = bytearray()
