"""Which names a server answers to: a name that a page of somebody else's leads here is not ours."""

import ipaddress
import socket


class OwnNames:
    """The names of this machine, and the name or address that a server was told to bind to."""

    def __init__(self, host: str) -> None:
        own = socket.gethostname().lower()
        self._names = {"localhost", host.lower(), own, f"{own}.local"}

    def hold(self, header: str) -> bool:
        """True if the header Host of a request is an address, or a name of ours."""
        name = _without_port(header)
        if name in self._names:
            return True
        try:
            ipaddress.ip_address(name.strip("[]"))
        except ValueError:
            return False
        return True


def _without_port(host: str) -> str:
    name = host.lower()
    if name.startswith("["):
        return name.partition("]")[0] + "]"
    return name.partition(":")[0]
