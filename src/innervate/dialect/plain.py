"""Plain classes from field declarations: what live nodes, boards and unit tests run on."""


class Row(list):
    """An array field whose places are counted from 0: Python's last one, [-1], is none in C."""

    __slots__ = ()
    name = ""  # of the field, for what is said

    def _check(self, place):
        if isinstance(place, int) and place < 0:
            raise IndexError(f"{self.name}[{place}]: an index is 0 to {len(self) - 1}")

    def __getitem__(self, place):
        """The value at a place, from 0 on."""
        self._check(place)
        return super().__getitem__(place)

    def __setitem__(self, place, value):
        """Put a value at a place, from 0 on."""
        self._check(place)
        super().__setitem__(place, value)


def make(name, *declarations, ports=0, array=list):
    """A class whose instances have the declared fields, each at the value in range nearest 0.

    `ports` is the length of the fields declared as "ports" long; `array` makes those of several.
    """
    fields = [field for declaration in declarations for field in declaration]
    starts = []
    for field, length, low, high, _unit, _meaning in fields:
        count = ports if length == "ports" else length
        starts.append((field, count, min(max(0, low), high)))

    def init(self):
        for field, count, start in starts:
            setattr(self, field, array([start] * count) if count else start)

    return type(name, (), {"__init__": init, "__slots__": tuple(field[0] for field in fields)})


class Outbox:
    """A plain outbox with room for `limit` actions (see outbox.py)."""

    def __init__(self, frame_class, limit):
        self.count = [0]
        self.limit = [limit]
        self.overflow = [0]
        self.action = [_Action() for _ in range(limit)]
        self.frame = [frame_class() for _ in range(limit)]


class _Action:
    __slots__ = ("a", "b", "c", "kind")

    def __init__(self):
        self.kind = self.a = self.b = self.c = 0
