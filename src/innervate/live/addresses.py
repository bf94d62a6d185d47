"""Addresses of UDP as the system has them, as files write them, and names that stand for some."""

import asyncio
import re
import socket
from contextlib import suppress
from threading import Thread
from typing import Any

Address = tuple[Any, ...]  # (host, port); of IPv6 (host, port, 0, number of the interface or 0)
Peer = tuple[str, int]  # as a file has it: the host is a name, or an address without brackets
ANY = ("0.0.0.0", "::")


def family_of(host: str) -> socket.AddressFamily:
    """That of an address; of a name IPv4."""
    return socket.AF_INET6 if ":" in host else socket.AF_INET


def known(peer: Peer) -> Address | None:
    """The address that a file says; None if it is to be looked up."""
    family = family_of(peer[0])
    try:
        host = socket.inet_ntop(family, socket.inet_pton(family, peer[0]))
    except OSError:  # a name, or an interface is named
        return None
    return (host, peer[1], 0, 0) if family == socket.AF_INET6 else (host, peer[1])


def text(address: Address) -> str:
    """An address as both ends call it, each of which has a name of its own for an interface."""
    return without_interface(as_written(address[:2]))


def as_written(peer: Peer) -> str:
    """An address or a name with its port, and its interface, as a file has it."""
    return f"[{peer[0]}]:{peer[1]}" if ":" in peer[0] else f"{peer[0]}:{peer[1]}"


def without_interface(name: str) -> str:
    """What an address or a path is called, without our name for the interface."""
    return re.sub(r"%[^]]*", "", name)


async def look_up(host: str, port: int, family: int) -> list[Address]:
    """The addresses of a name, asked in a thread that nobody waits for at the end.

    Raises:
        OSError: there is none, or the interface that is named is not there.
    """
    loop = asyncio.get_running_loop()
    answer: asyncio.Future[list[Address]] = loop.create_future()

    def settle(found: list[Address] | OSError) -> None:
        if answer.cancelled():
            return
        if isinstance(found, OSError):
            answer.set_exception(found)
        else:
            answer.set_result(found)

    def ask() -> None:
        found: list[Address] | OSError
        try:
            told = socket.getaddrinfo(host, port, family, socket.SOCK_DGRAM)
            found = [(str(one[4][0]).partition("%")[0], *one[4][1:]) for one in told]
        except OSError as error:
            found = error
        except ValueError as error:  # no such name can be
            found = OSError(str(error))
        with suppress(RuntimeError):  # the loop is closed: nobody asks any more
            loop.call_soon_threadsafe(settle, found)

    try:
        Thread(target=ask, daemon=True).start()
    except RuntimeError as error:
        raise OSError(str(error)) from None
    return await answer
