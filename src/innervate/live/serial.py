"""Serial ports: frames between zeros (COBS), raw 8N1; a pty is a serial port, too."""

import asyncio
import errno
from contextlib import suppress

from innervate.live.errors import LiveError
from innervate.live.links import FORGOTTEN_MAX, Link, Path, Receiver
from innervate.live.machine import SerialPort, machine
from innervate.live.serial_port import is_speed
from innervate.wire import cobs

READ_BYTES = 4096
FRAME_MAX = 512  # bytes of a frame, sealed
WAITING_MAX = 16_384  # bytes that the line could not take yet; then frames are dropped
REOPEN_S = 0.25
END = b"\0"  # of a frame


class SerialLink(Link):
    """One serial port with a node at its other end; its path comes back when it is plugged in.

    Args:
        device: like /dev/ttyUSB0.
        baud: bits per second, one the system knows: 115200 to 4000000.
        port: port number of the path.
        far: the device at the other end, where both are on this machine; "" not known.
    """

    frame_max = FRAME_MAX

    def __init__(self, device: str, baud: int, port: int = 0, far: str = "") -> None:
        self.device = device
        self.baud = baud
        self.path = SerialPath(self, f"serial {device}", port)
        if far:
            self.path.name, self.path.own = f"serial {device} to {far}", f"serial {far} to {device}"
            self.path.ends = (device, far)
        self.paths = [self.path]
        self.path.up = False
        self._port: SerialPort | None = None
        self._receive: Receiver | None = None
        self._decoder = cobs.Decoder(FRAME_MAX)
        self._waiting = bytearray()
        self._again: asyncio.TimerHandle | None = None
        self._closed = False

    async def open(self, receive: Receiver) -> None:
        """Open the port, or wait until it is plugged in; a wrong speed is the user's mistake."""
        if not is_speed(self.baud):
            raise LiveError(f"{self.device}: this system has no {self.baud} baud; try 115200")
        self._receive = receive
        self._closed = False
        self._try_open()

    def close(self) -> None:
        """Close the port, and do not open it again."""
        self._closed = True
        if self._again is not None:
            self._again.cancel()
        self._drop()

    def forget(self) -> None:
        """Throw away the bytes that wait at the port, and those that wait for it."""
        if self._port is None:
            return
        with suppress(OSError):
            for _ in range(FORGOTTEN_MAX):
                if not self._port.read(READ_BYTES):
                    break
        self._decoder = cobs.Decoder(FRAME_MAX)
        if self._waiting:
            self._waiting[:] = END  # of a frame that may have begun

    def write(self, data: bytes) -> bool:
        """Put bytes on the line, or behind those that wait; False if there is no room."""
        if self._waiting:
            if len(self._waiting) > WAITING_MAX:
                return False
            self._waiting += data
            return True
        assert self._port is not None
        try:
            count = self._port.write(data)
        except BlockingIOError:
            count = 0
        except OSError:
            self._lost()
            return False
        if count < len(data):
            self._waiting += data[count:]
            asyncio.get_running_loop().add_writer(self._port.fileno(), self._writable)
        return True

    def _try_open(self) -> None:
        try:
            self._port = machine().open_serial(self.device, self.baud)
        except OSError as error:
            none = error.errno == errno.ENOTTY
            why = "no serial port" if none else error.strerror or "cannot be opened"
            self.path.trouble = f"{self.device}: {why}; trying again"
            self._later()
            return
        self.path.trouble = ""
        self._decoder = cobs.Decoder(FRAME_MAX)
        self.path.up = True
        asyncio.get_running_loop().add_reader(self._port.fileno(), self._readable)

    def _later(self) -> None:
        if not self._closed:
            loop = asyncio.get_running_loop()
            self._again = loop.call_later(REOPEN_S, self._try_open)

    def _lost(self) -> None:
        """Unplugged: try until it is back."""
        self.path.counters["unplugged"] += 1
        self._drop()
        self._later()

    def _drop(self) -> None:
        port, self._port = self._port, None
        if port is None:
            return
        with suppress(RuntimeError):  # the loop may be closed already
            loop = asyncio.get_running_loop()
            loop.remove_reader(port.fileno())
            loop.remove_writer(port.fileno())
        with suppress(OSError):
            port.close()
        self._waiting.clear()
        self.path.up = False

    def _readable(self) -> None:
        assert self._port is not None
        try:
            data = self._port.read(READ_BYTES)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._lost()
            return
        decoder = self._decoder
        before = decoder.dropped
        frames = decoder.feed(data)
        self.path.counters["dropped: framing"] += decoder.dropped - before
        assert self._receive is not None
        for frame in frames:
            if decoder is self._decoder:  # else what was read is to be forgotten
                self._receive(self.path, frame)

    def _writable(self) -> None:
        assert self._port is not None
        try:
            count = self._port.write(self._waiting)
        except BlockingIOError:
            return
        except OSError:
            self._lost()
            return
        del self._waiting[:count]
        if not self._waiting:
            asyncio.get_running_loop().remove_writer(self._port.fileno())


class SerialPath(Path):
    """The one path of a serial port."""

    def __init__(self, link: SerialLink, name: str, port: int) -> None:
        super().__init__(name, port)
        self.link = link

    def send(self, data: bytes) -> None:
        """Put a frame on the line."""
        if not self.up:
            self.counters["unsent: unplugged"] += 1
        elif self.link.write(cobs.encode(data)):
            self.sent(data)
        else:
            self.counters["unsent: full"] += 1
