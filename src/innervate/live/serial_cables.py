"""Serial cables between processes of one machine: two ptys each, joined by this process."""

import os
import selectors
import threading
import tty
from contextlib import suppress

READ_BYTES = 4096


class Cables:
    """A number of cables; each end is a serial port that a node can open.

    Args:
        count: cables.

    Attributes:
        devices: the serial ports: cable k has 2k and 2k + 1.
        cut: cables that carry nothing now.
        carried: bytes carried so far, per cable.
    """

    def __init__(self, count: int) -> None:
        self.cut: set[int] = set()
        self.carried = [0] * count
        self._masters: list[int] = []
        self._slaves: list[int] = []
        self.devices: list[str] = []
        self._end = os.pipe()
        self._thread = threading.Thread(target=self._run, daemon=True)
        for _ in range(2 * count):
            master, slave = os.openpty()
            tty.setraw(slave)
            os.set_blocking(master, False)
            self._masters.append(master)
            self._slaves.append(slave)  # held open: a node may close and open its end
            self.devices.append(os.ttyname(slave))

    def start(self) -> None:
        """Carry bytes from now on, in a thread: whoever starts processes would hold them up."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread that carries bytes, and close all ports."""
        os.write(self._end[1], b".")
        if self._thread.is_alive():
            self._thread.join()
        for fd in (*self._masters, *self._slaves, *self._end):
            os.close(fd)

    def _run(self) -> None:
        with selectors.DefaultSelector() as selector:
            selector.register(self._end[0], selectors.EVENT_READ)
            for end, master in enumerate(self._masters):
                selector.register(master, selectors.EVENT_READ, end)
            while True:
                for key, _ in selector.select():
                    if key.data is None:
                        return
                    self._carry(key.data)

    def _carry(self, end: int) -> None:
        try:
            data = os.read(self._masters[end], READ_BYTES)
        except OSError:
            return
        cable = end // 2
        if cable not in self.cut:
            self.carried[cable] += len(data)
            with suppress(OSError):  # the other side does not read: as a full line, bytes are lost
                os.write(self._masters[end ^ 1], data)
