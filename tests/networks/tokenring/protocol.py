"""A token goes round: in on port W, held for a while, out on port E; node 0 mends its loss."""

from innervate.dialect.arith import MASK16, MASK30
from innervate.dialect.outbox import deliver, report, send, set_timer

TOKEN = 1
EAST = 1
HELD = 0
LOST = 1
TIMERS = 2
REPORT_MADE = 1  # a lap


def on_start(node, params, now, cause, out):
    """Switch on; node 0 makes the token a little later."""
    node.lap = 0
    node.passed = 0
    if node.number == 0:
        set_timer(out, LOST, (now + params.hold_us) & MASK30)


def on_frame(node, params, now, port, frame, out):
    """The token came; node 0 drops one that is behind the newest."""
    if node.number == 0 and frame.lap != node.lap:
        return
    node.lap = frame.lap
    copy = out.frame[deliver(out, TOKEN)]
    copy.kind = TOKEN
    copy.lap = frame.lap
    copy.made_at = frame.made_at
    for i in range(2):
        copy.load[i] = frame.load[i]
    set_timer(out, HELD, (now + params.hold_us) & MASK30)


def on_timer(node, params, now, timer, out):
    """Hand the token on; node 0 numbers it, and makes a new one if it does not come back."""
    if node.number == 0:
        node.lap = (node.lap + 1) & MASK16
        set_timer(out, LOST, (now + params.lost_us) & MASK30)
        if timer == LOST:
            report(out, REPORT_MADE, node.lap, 0)
    node.passed = node.passed + 1
    token = out.frame[send(out, EAST, 0, 0)]
    token.kind = TOKEN
    token.lap = node.lap
    token.made_at = node.made_at
    for i in range(2):
        token.load[i] = node.load[i]


def on_input(node, params, now, kind, item, out):
    """What the tokens that we hand on carry from now on."""
    node.made_at = item.made_at
    for i in range(2):
        node.load[i] = item.load[i]
