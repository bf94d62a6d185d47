"""Interrupting long work without losing what is done."""

from __future__ import annotations

import signal
import threading
from typing import Any


class Stop:
    """Turns Ctrl-C into a request to stop after the present slice, where a signal can be caught."""

    def __init__(self) -> None:
        self.asked = False
        self._catches = threading.current_thread() is threading.main_thread()
        self._before: Any = None

    def __enter__(self) -> Stop:
        if self._catches:
            self._before = signal.signal(signal.SIGINT, self._ask)
        return self

    def __exit__(self, *_: object) -> None:
        if self._catches:
            signal.signal(signal.SIGINT, self._before)

    def _ask(self, _number: int, _frame: object) -> None:
        self.asked = True
