"""The `machine` that main.py finds under Node.js: UARTs that are serial ports of the PC."""

import host


class UART:
    """What of machine.UART a cell uses; `number` counts the devices given to cell.mjs."""

    def __init__(self, number, **options):
        self.number = number

    def any(self):
        """How many bytes can be read."""
        return host.waiting(self.number)

    def readinto(self, buffer):
        """Read what there is; how many bytes that were."""
        count = min(len(buffer), host.waiting(self.number))
        for i in range(count):
            buffer[i] = host.take(self.number)
        return count

    def write(self, data):
        """Write what the line takes; how many bytes that were."""
        for byte in data:
            host.put(self.number, byte)
        return host.flush(self.number)


def idle():
    """Wait a millisecond: a busy loop of a board is a busy core of a PC."""
    host.rest()
