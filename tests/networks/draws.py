"""What stands for a generator of random numbers where a test sets what is drawn."""


class Draw:
    """Draws the least or the most, and whatever is as likely as its share says."""

    def __init__(self, place, share):
        self.place, self.share = place, share

    def randint(self, low, high):
        return (low, high)[self.place]

    uniform = randint

    def randrange(self, count):
        return (0, count - 1)[self.place]

    def choice(self, values):
        return values[-self.place]

    def sample(self, values, count):
        return list(values)[:count] if not self.place else list(values)[-count:][::-1]

    def random(self):
        return self.share
