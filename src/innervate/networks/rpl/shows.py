"""What pages colour nodes by, besides their fields."""

from typing import Any

from innervate.networks.rpl.protocol.constants import INFINITE


def depth(node: Any, params: Any) -> float:
    """How far a node says that it is from the root, in transmissions; -1 if it has no way."""
    return -1.0 if node.rank == INFINITE else float(node.rank / params.step - 1)


SHOWS = {"distance to the root": ("transmissions", depth)}
