"""What pages colour nodes by, besides their fields."""

from .constants import INFINITE


def depth(node, params):
    """How far a node says that it is from the root, in transmissions; -1 if it has no way."""
    return -1 if node.rank == INFINITE else node.rank / params.step - 1


SHOWS = {"distance to the root": ("transmissions", depth)}
