"""Interrupting long work without losing what is done."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_waiting: list[Stop] = []  # those that catch Ctrl-C now
_deaf: list[bool] = []  # work is under way in which nobody looks whether a stop was asked for


def _is_main() -> bool:
    return threading.current_thread() is threading.main_thread()


@contextmanager
def ends_at_once() -> Iterator[None]:
    """Work that is no use in part, as compiling is: Ctrl-C ends it where it is, or before it.

    Raises:
        KeyboardInterrupt: a `Stop` was asked for before it began, or is asked for meanwhile.
    """
    if not _is_main():
        yield
        return
    if any(stop.asked for stop in _waiting):
        raise KeyboardInterrupt
    _deaf.append(True)
    try:
        yield
    finally:
        _deaf.pop()


class Stop:
    """Turns Ctrl-C into a request to stop after the present slice, where a signal can be caught.

    One within `ends_at_once`, and a second one, are as without it: KeyboardInterrupt.
    """

    def __init__(self) -> None:
        self.asked = False
        self._catches = _is_main()
        self._before: Any = None

    def __enter__(self) -> Stop:
        if self._catches:
            self._before = signal.signal(signal.SIGINT, self._ask)
            _waiting.append(self)
        return self

    def __exit__(self, *_: object) -> None:
        if self._catches:
            _waiting.remove(self)
            signal.signal(signal.SIGINT, self._before)

    def _ask(self, _number: int, _frame: object) -> None:
        if _deaf or self.asked:
            raise KeyboardInterrupt
        self.asked = True
