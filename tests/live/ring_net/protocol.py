"""A token goes round: in on port W, held for a while, out on port E; node 0 mends its loss."""

from innervate.dialect.arith import MASK16, MASK30
from innervate.dialect.outbox import deliver, send, set_timer

TOKEN = 1
EAST = 1
HELD, LOST = 0, 1
TIMERS = 2


def on_start(node, params, now, cause, out):
    """Switch on; node 0 makes the token a little later."""
    if node.number == 0:
        set_timer(out, LOST, (now + params.hold_us) & MASK30)


def on_frame(node, params, now, port, frame, out):
    """The token came; one that is behind the newest is a second one and is dropped."""
    if node.number == 0 and frame.lap != node.lap:
        return
    node.lap = frame.lap
    i = deliver(out, TOKEN)
    copy = out.frame[i]
    copy.kind = TOKEN
    copy.lap = frame.lap
    copy.load = frame.load
    set_timer(out, HELD, (now + params.hold_us) & MASK30)


def on_timer(node, params, now, timer, out):
    """Hand the token on; node 0 numbers it, and makes a new one if it does not come back."""
    if node.number == 0:
        node.lap = (node.lap + 1) & MASK16
        set_timer(out, LOST, (now + params.lost_us) & MASK30)
    node.passed = (node.passed + 1) & MASK16
    i = send(out, EAST, 0, 0)
    token = out.frame[i]
    token.kind = TOKEN
    token.lap = node.lap
    token.load = node.load


def on_input(node, params, now, kind, item, out):
    """What the tokens that we hand on carry from now on."""
    node.load = item.load
