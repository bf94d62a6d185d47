"""What the board does when it is switched on: be a cell of the skin. Fit the pins to yours."""

import machine
from cell import Cell

NUMBER = 1  # who we are; every cell has another
BAUD = 1_000_000
# (UART, options) of W, E, up, down; None for a free socket.
UARTS = (
    (1, {}),
    (2, {}),
    None,
    None,
)
SAMPLE_US = 20_000


def sense(frame):
    """Put what the sensors say into a frame: proximity, force (mN), temperature, accel."""
    frame.proximity = 0


def obey(code, value):
    """Do what the PC commands; what code and value mean is yours."""


def opened(wanted):
    """A UART that never waits."""
    if wanted is None:
        return None
    number, options = wanted
    return machine.UART(number, baudrate=BAUD, timeout=0, timeout_char=0, rxbuf=256, **options)


# Mixed, as generators that begin near each other draw alike; 0 and the fixed point are no states.
seed = (NUMBER + 1) * 334_214_459 % 1_072_496_638 + 1
cell = Cell(NUMBER, [opened(wanted) for wanted in UARTS], seed, sense, SAMPLE_US, obey=obey)
cell.start()
while True:
    cell.poll()
    machine.idle()  # until something happens
