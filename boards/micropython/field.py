"""A node of a network over a field on a board: what it sends leaves by all of its lines.

A line is a radio modem that everybody near hears, or goes to one neighbour each.
"""

import node
from driver import URGENT, Node

ALL = 65535  # dialect/access.py: whom a frame is for that is for all
LOUD = -50  # dBm: of every frame, as a line does not say


class FieldNode(Node):
    """A node that is told when its own frames have ended, if its protocol wants to know."""

    unended = 0  # own frames that it was not told of yet

    def carry(self, act, frame):
        """Send a frame, by all lines."""
        for port in self.ports:
            if port:
                self.put(port, act, frame)
        self.unended += not act.c & URGENT

    def take(self, number, frame):
        """A frame was heard, on whatever line; one that is for another node is not for us."""
        if getattr(frame, "to", ALL) not in (ALL, self.number):
            return
        if hasattr(frame, "rssi"):
            frame.rssi = LOUD
        super().take(0, frame)

    def poll(self):
        """Look at lines and timers once; to be called for ever, at least every millisecond."""
        super().poll()
        for _ in range(self.unended):
            if any(port and (port.rest or port.waiting) for port in self.ports):
                return
            self.unended -= 1
            if hasattr(node, "on_sent"):
                node.on_sent(self.state, self.params, self.now(), 1, self.out)
            elif hasattr(node, "on_carrier"):
                node.on_carrier(self.state, self.params, self.now(), 0, 0, self.out)
            self.drain()
