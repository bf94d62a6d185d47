"""A serial port of this machine, as the system knows it."""

import os
import termios


class Port:
    """A serial port: 8 bits, no parity, no flow control, nothing translated.

    Args:
        device: like /dev/ttyUSB0.
        baud: bits per second, one the system knows.

    Raises:
        OSError: it is not there, or no serial port.
    """

    def __init__(self, device: str, baud: int) -> None:
        self._fd = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        try:
            _set_raw(self._fd, baud)
        except termios.error as error:
            os.close(self._fd)
            raise OSError(*error.args) from None
        except OSError:
            os.close(self._fd)
            raise

    def fileno(self) -> int:
        """The system's number of it."""
        return self._fd

    def read(self, count: int) -> bytes:
        """At most so many bytes: see machine.SerialPort."""
        return os.read(self._fd, count)

    def write(self, data: bytes | bytearray) -> int:
        """How many of these bytes went: see machine.SerialPort."""
        return os.write(self._fd, data)

    def close(self) -> None:
        """Give the port back to the system."""
        os.close(self._fd)


def is_speed(baud: int) -> bool:
    """True if the system knows this speed."""
    return getattr(termios, f"B{baud}", None) is not None


def _set_raw(fd: int, baud: int) -> None:
    speed = getattr(termios, f"B{baud}")
    mode = termios.tcgetattr(fd)
    mode[0] = 0
    mode[1] = 0
    mode[2] = termios.CS8 | termios.CREAD | termios.CLOCAL
    mode[3] = 0
    mode[4] = mode[5] = speed
    mode[6][termios.VMIN] = 0
    mode[6][termios.VTIME] = 0
    termios.tcsetattr(fd, termios.TCSANOW, mode)
