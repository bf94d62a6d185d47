"""Commands from the PC down to the cells, over the children of every cell [skin II-A].

A cell knows its children, and not who is behind them: a command for one cell goes to all of them
as well, and ends where it is for. Routes change while it is under way. A cell therefore takes a
command from any neighbour, hands it down once, and knows the last WINDOW numbers again; a command
that went too far is given up, whatever was forgotten.
"""

from innervate.protocol.arith import MASK16
from innervate.protocol.outbox import deliver, report, send
from innervate.protocol.skin_words import (
    COMMAND,
    DROP_AGAIN,
    DROP_TOO_FAR,
    EVERYBODY,
    ONE,
    PORTS,
    REPORT_DROP,
)

WINDOW = 24


def copy_command(to, frm):
    """Copy a command, but for how far it went."""
    to.kind = COMMAND
    to.cell = frm.cell
    to.number = frm.number
    to.code = frm.code
    to.value = frm.value
    to.made_at = frm.made_at


def on_command(cell, params, port, frame, out):
    """A command came in on a port: for us, for our children, or for both."""
    if not take_first(cell, frame.number):
        report(out, REPORT_DROP, DROP_AGAIN, 0)
        return
    if frame.cell == EVERYBODY or frame.cell == cell.number:
        mine = out.frame[deliver(out, COMMAND)]
        copy_command(mine, frame)
        mine.hops = frame.hops
    if frame.cell == cell.number:
        return
    if frame.hops >= params.max_depth:
        report(out, REPORT_DROP, DROP_TOO_FAR, 0)
        return
    for p in range(PORTS):
        if p != port and cell.child[p] and cell.pf[p] < ONE:
            onward = out.frame[send(out, p, 0, 0)]
            copy_command(onward, frame)
            onward.hops = frame.hops + 1


def take_first(cell, number):
    """1 if this command was not here before; it was from now on.

    A number behind the window is no old one, none lives that long: the PC has started anew.
    """
    ahead = (number - cell.last_command) & MASK16
    behind = (cell.last_command - number) & MASK16
    if cell.commands and behind < WINDOW:
        bit = 1 << behind
        if cell.commands & bit:
            return False
        cell.commands = cell.commands | bit
        return True
    if cell.commands and ahead < WINDOW:
        kept = cell.commands & ((1 << (WINDOW - ahead)) - 1)
        cell.commands = (kept << ahead) | 1
    else:
        cell.commands = 1
    cell.last_command = number
    return True
