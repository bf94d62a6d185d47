"""SIGHUP asks a node to read its file again, and ends a process that does not listen for it yet."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager

HANGUP = {signal.SIGHUP}


def hold() -> None:
    """From now on it waits; processes that are started now have it wait from the beginning."""
    signal.pthread_sigmask(signal.SIG_BLOCK, HANGUP)


def let_in() -> None:
    """It comes in again, also one that has waited."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, HANGUP)


@contextmanager
def held() -> Iterator[None]:
    """Start nodes in here, and nobody can hang up on them before they listen for it."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, HANGUP)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
