"""An outbox with few frames: made when a handler first asks for one, used again after `clear`.

It is what dialect/outbox.py describes; a list of frames as long as that of actions would take
most of a small board's memory.
"""

NONE = 255


class Action:
    """What a handler wants done."""

    def __init__(self):
        self.kind = self.a = self.b = self.c = 0


class Frames:
    """frame[i] belongs to action[i]."""

    def __init__(self, make, limit):
        self.make = make
        self.at = bytearray([NONE] * limit)
        self.made = []
        self.used = 0

    def __getitem__(self, i):
        place = self.at[i]
        if place == NONE:
            place = self.at[i] = self.used
            self.used = place + 1
            if place == len(self.made):
                self.made.append(self.make())
        return self.made[place]


class Outbox:
    """Room for `limit` actions, at most 254; `make` makes a frame."""

    def __init__(self, make, limit):
        self.count = [0]
        self.limit = [limit]
        self.overflow = [0]
        self.action = [Action() for _ in range(limit)]
        self.frame = Frames(make, limit)

    def clear(self):
        """Everything is carried out."""
        frames = self.frame
        for i in range(self.count[0]):
            frames.at[i] = NONE
        frames.used = 0
        self.count[0] = 0
