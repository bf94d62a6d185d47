"""What runs on a board: the roles of all networks (see `innervate/live/board.py`)."""

from __future__ import annotations

import sys

from innervate.folders import NetworkError
from innervate.live.board import Role, roles_of
from innervate.network import networks


def roles() -> dict[str, Role]:
    """All roles by name."""
    return {role.name: role for network in networks().values() for role in roles_of(network)}


def roles_or_told() -> dict[str, Role] | None:
    """All roles; None where INNERVATE_NETWORKS names what is no network, which is told."""
    try:
        return roles()
    except NetworkError as error:
        print(error, file=sys.stderr)
        return None


def kind_of(role: Role) -> str:
    """The network whose role it is."""
    return next(name for name, network in networks().items() if role in roles_of(network))
