"""Plays recorded calls on a node and tells what came of each; runs on boards and on the PC.

A transcript is a row of whole numbers per call: handler, clock, then what it is given. `read`
returns the next number. What came of a call are two hashes below 2^30: of every declared field of
the state, and of the outbox with what its frames have on the wire.
"""

START = 0
FRAME = 1
TIMER = 2
INPUT = 3
CARRIER = 4
SENT = 5
END = 6

SEND = 1
DELIVER = 3

MASK30 = 1073741823


def fold(mark, word):
    """A hash with one more word in it."""
    mark = (mark ^ word) & MASK30
    return 32730 * (mark & 32767) + (mark >> 15)


def fold_field(mark, value):
    """The same for a number, or all of an array's."""
    if isinstance(value, int):
        return fold(mark, value)
    for word in value:
        mark = (mark ^ word) & MASK30
        mark = 32730 * (mark & 32767) + (mark >> 15)
    return mark


def fold_state(state, names):
    """Hash of a state: its fields in order of declaration."""
    mark = 1
    for name in names:
        mark = fold_field(mark, getattr(state, name))
    return mark


def fold_frame(mark, frame, fields):
    """The same for what a frame has on the wire; fields are name, how many, name, how many ..."""
    mark = fold(mark, frame.kind)
    for k in range(0, len(fields), 2):
        value = getattr(frame, fields[k])
        many = fields[k + 1]
        if many == 0:
            mark = fold(mark, value)
        else:
            if not isinstance(many, int):
                many = getattr(frame, many)
            for i in range(many):
                mark = fold(mark, value[i])
    return mark


def fold_out(out, kinds):
    """Hash of an outbox."""
    mark = fold(1, out.overflow[0])
    for i in range(out.count[0]):
        act = out.action[i]
        mark = fold(fold(fold(fold(mark, act.kind), act.a), act.b), act.c)
        if kinds and (act.kind == SEND or act.kind == DELIVER):
            frame = out.frame[i]
            mark = fold_frame(mark, frame, kinds[frame.kind])
    return mark


def read_record(record, fields, read):
    """Set a record's fields (name, how many, name, how many ...) to what comes next."""
    for k in range(0, len(fields), 2):
        many = fields[k + 1]
        if many == 0:
            setattr(record, fields[k], read())
        else:
            if not isinstance(many, int):
                many = getattr(record, many)
            value = getattr(record, fields[k])
            for i in range(many):
                value[i] = read()


class Player:
    """A node that is played calls.

    handlers are the six functions, None for what a protocol has not; who is what they are given
    first: state first, params last.
    layouts has NAMES of the state's fields, what a received frame (HEARD) and an input (GIVEN)
    consist of, and by KINDS what of a frame is sent. frame and item are what they are read into.
    """

    def __init__(self, handlers, who, frame, item, out, layouts, read):
        self.handlers, self.who, self.layouts = handlers, who, layouts
        self.frame, self.item, self.out = frame, item, out
        self.read = read

    def step(self):
        """Play the next call: hashes of state and outbox, or None at the end."""
        read = self.read
        handler = read()
        if handler == END:
            return None
        now = read()
        given = self.given(handler)
        self.handlers[handler](*self.who, now, *given, self.out)
        marks = fold_state(self.who[0], self.layouts.NAMES), fold_out(self.out, self.layouts.KINDS)
        self.out.clear()
        return marks

    def given(self, handler):
        """What the handler is given between clock and outbox."""
        read = self.read
        if handler == START:
            self.change()
            return (read(),)
        if handler == FRAME:
            port = read()
            read_record(self.frame, self.layouts.HEARD, read)
            return port, self.frame
        if handler in (TIMER, SENT):
            return (read(),)
        if handler == INPUT:
            kind = read()
            read_record(self.item, self.layouts.GIVEN, read)
            return kind, self.item
        return read(), read()

    def change(self):
        """Before a start: set what the driver has set."""
        read = self.read
        for _ in range(read()):
            name = self.layouts.NAMES[read()]
            i = read()
            if i < 0:
                setattr(self.who[0], name, read())
            else:
                getattr(self.who[0], name)[i] = read()


def number(char):
    """The next whole number from characters: 5 bits each from the lowest on, 32 = more follow."""
    value = shift = 0
    while True:
        code = char() - 64
        value |= (code & 31) << shift
        shift += 5
        if code < 32:
            return -(value >> 1) - 1 if value & 1 else value >> 1
