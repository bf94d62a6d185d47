"""What the board does when it is switched on: be a node of a network. Fit the pins to yours."""

import layouts
import machine
from carrier import Node

from innervate.wire.frames import Codec

NUMBER = 1  # who we are; every node has another
BAUD = 1_000_000
# (UART, options) of every port, in the protocol's order; None for a free socket. Over a field of
# every line: of a radio modem that everybody near hears, or to a neighbour.
UARTS = (
    (1, {}),
    (2, {}),
    None,
    None,
)


def received(frame):
    """Take what the network delivers to this node."""


def opened(wanted):
    """A UART that never waits."""
    if wanted is None:
        return None
    number, options = wanted
    return machine.UART(number, baudrate=BAUD, timeout=0, timeout_char=0, rxbuf=256, **options)


# Mixed, as generators that begin near each other draw alike; 0 and the fixed point are no states.
seed = (NUMBER + 1) * 334_214_459 % 1_072_496_638 + 1
wire = Codec(layouts.LAYOUTS, layouts.KIND_BITS)
ports = [opened(wanted) for wanted in UARTS]
node = Node(NUMBER, ports, seed, wire, layouts.TIMERS, layouts.ROOM, receive=received)
node.start()
while True:
    node.poll()
    machine.idle()  # until something happens
