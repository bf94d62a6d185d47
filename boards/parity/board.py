"""What a MicroPython under Node.js runs: a node that is played a transcript, in 16 KiB.

`node` has the protocol, `records` its records, `layouts` what the transcript consists of; all are
made for the occasion by boards/parity/nodejs.py. This interpreter frees memory only between two
calls from JavaScript: what a call leaves behind has to fit besides.
"""

import gc

from feed import char
from outbox import Outbox
from replay import Player, number, read_record

player = None
peak = 0


def used():
    """How much of the heap is in use."""
    return gc.mem_alloc()


def add_state():
    """A node's state."""
    global player
    import records

    player = records.State()
    del records.State.__init__  # not needed again


def add_rest():
    """Its parameters and outbox."""
    global player
    import layouts
    import records

    player = player, records.Params(), Outbox(records.Frame, layouts.ROOM)
    if layouts.PARAMS:
        del records.Params.__init__


def read():
    """The transcript's next number; JavaScript has the characters."""
    return number(char)


def open_transcript():
    """Ready for the first step."""
    global player
    import layouts
    import node
    import records

    state, params, out = player
    read_record(params, layouts.PARAMS, read)
    handlers = (node.on_start, node.on_frame, node.on_timer, node.on_input)
    handlers += (getattr(node, "on_carrier", None), getattr(node, "on_sent", None))
    who = (state, None, params) if layouts.HAS_GATE else (state, params)
    frame = records.Frame()
    item = records.Item() if hasattr(records, "Item") else frame
    player = Player(handlers, who, frame, item, out, layouts, read)


def step():
    """Play a call; False at the end."""
    global peak
    marks = player.step()
    if marks is None:
        return False
    print(marks[0], marks[1])
    peak = max(peak, gc.mem_alloc())
    gc.collect()
    return True


def most():
    """The most of the heap that was in use, with what a call leaves behind."""
    return peak


def left():
    """Take pieces of 64 bytes until there are none; about how many bytes that were."""
    chain = None
    count = 0
    try:
        while True:
            chain = (chain, bytearray(64))
            count += 96  # with the heads of both
    except MemoryError:
        return count
