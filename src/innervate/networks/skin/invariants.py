"""Invariants of the protocols that the simulator and the explorer both assert."""

from innervate.dialect.arith import later
from innervate.networks.skin.protocol.constants import NONE


def is_worse(cell, parent):
    """True if the feasible distance of `cell` is strictly worse than that of `parent`.

    A parent that forgot its own (a restart, FD_HOLD) may stand until it has a route again: it
    takes none before its children have given it up.
    """
    if parent.fd_known == 0:
        return parent.parent == NONE
    if cell.fd_known == 0 or later(parent.fd_sq, cell.fd_sq):
        return True
    return cell.fd_sq == parent.fd_sq and cell.fd_dist > parent.fd_dist
