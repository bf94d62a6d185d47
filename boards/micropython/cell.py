"""A cell of the skin on a board: the protocol's four ports are four UARTs."""

import time

import records
from driver import MASK30, Node

from innervate.networks.skin import frames as skin

SAMPLE = 1
TIMERS = 2
ROOM = 12  # most actions of one call: four broken ports, a new parent, four beacons, a timer
MOVED = 1  # a report: another parent


class Cell(Node):
    """A cell.

    Args:
        number: in its data frames, 0 to 65535; every cell has another.
        uarts: four, in order W, E, up, down; None for a free socket.
        seed: 1 to 1_072_496_638, different on every cell, not near each other (rng.py).
        sense: called with a frame to fill with what the sensors say; None = no sensors.
        sample_us: between two samples.
        ticks_us: the clock, us, wrapping at a multiple of 2^30.
        obey: called with a frame's code and value for every command of the PC; None = nobody obeys.
    """

    def __init__(
        self, number, uarts, seed, sense=None, sample_us=0, ticks_us=time.ticks_us, obey=None
    ):
        receive = obey and (lambda frame: obey(frame.dist, frame.proximity))
        super().__init__(number, uarts, seed, skin, TIMERS, ROOM, ticks_us, receive)
        self.sense = sense
        self.sample_us = sample_us
        self.sample = records.Frame()  # what the sensors say
        self.sampled = self.now()

    @property
    def moves(self):
        """How often it has found another parent."""
        return self.reports.get(MOVED, 0)

    def start(self, cause=1):
        """Switch on; 1 waits some periods, until neighbours that know us from before give us up.

        0 takes the first route that is heard: only where all cells are switched on at once.
        """
        super().start(cause)

    def poll(self):
        """Look at ports, timers and sensors once; to be called for ever, every millisecond."""
        super().poll()
        now = self.now()
        if self.sample_us and (now - self.sampled) & MASK30 >= self.sample_us:
            self.sampled = now
            if self.sense:
                self.sense(self.sample)
            self.give(SAMPLE, self.sample)
