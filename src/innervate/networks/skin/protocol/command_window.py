"""Which commands of the PC were here before [skin II-A].

Routes change while a command goes down, so that it may come from several neighbours: a cell takes
it from any, and hands it down once (skin.py).
"""

from innervate.dialect.arith import MASK16

WINDOW = 24


def accept_command(cell, number):
    """1 if this command was not here before; it was from now on.

    A number behind the window is no old one, none lives that long: the PC has started anew. The
    first that a cell hears is its newest, so that one just behind it does not look like that.
    """
    behind = (cell.last_command - number) & MASK16
    if behind < WINDOW and cell.commands:
        bit = 1 << behind
        if cell.commands & bit:
            return False
        cell.commands = cell.commands | bit
        return True
    ahead = (number - cell.last_command) & MASK16
    kept = 0
    if ahead < WINDOW:
        kept = (cell.commands & ((1 << (WINDOW - ahead)) - 1)) << ahead
    cell.commands = kept | 1
    cell.last_command = number
    return True
