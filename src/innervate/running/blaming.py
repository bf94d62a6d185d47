"""Where in a folder's files a run breaks: a compiled run cannot say it, so it is run again plain.

In a watched plain run states note the line that put a value out of its range, and an index that is
below 0, which compiled code would take as somebody else's memory, is an error.
"""

import re
import sys
from bdb import BdbQuit
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

from innervate import folders
from innervate.dialect.plain import Row
from innervate.network import Network
from innervate.running.sent import Sent, Told, telling
from innervate.sim.driver import InvariantBroken, Simulation

TRIAL_EVENTS = 5_000
TRIAL_NODES = 2_000
AGAIN_EVENTS = 300_000  # of a compiled run that broke later than that nobody waits for a plain one
_IN_FILE = re.compile(r'File "([^"]+)", line (\d+)')
_tried: set[Network] = set()

Notes = dict[tuple[int, str], tuple[str, int]]


class Watched:
    """Watches nodes and outbox of a plain simulation, not yet begun, of a network from a folder."""

    def __init__(self, running: Simulation, network: Network) -> None:
        assert network.folder is not None
        self.folder = network.folder
        self.notes: Notes = {}
        self.overflow: tuple[str, int] | None = None
        world = running.world
        states = world.cells if hasattr(world, "cells") else world.stations
        self._ranges = {
            name: (low, high) for name, _length, low, high, *_ in network.fields.STATE
        }  # fmt: skip
        self.states = states
        kind = telling(states[0], self._field_set)
        for number, state in enumerate(states):
            for name, length, *_ in network.fields.STATE:
                if length:
                    told = partial(self._in_row_set, number, name)
                    setattr(state, name, _Row(getattr(state, name), told))
                    getattr(state, name).name = name
            state.__class__ = kind
        self._numbers = {id(state): number for number, state in enumerate(states)}
        self.sent = Sent(world, network, self.here)
        out = world.out._replace(count=self.sent.count, overflow=Told([0], self._overflow_set))
        running.world, self.sent.out = world._replace(out=out), out

    def _field_set(self, state: Any, name: str, value: Any) -> None:
        if not isinstance(value, list):
            self._in_row_set(self._numbers[id(state)], name, 0, value)

    def _in_row_set(self, number: int, name: str, _place: int, value: int) -> None:
        low, high = self._ranges.get(name, (value, value))
        if not low <= value <= high:
            self.note(number, name)

    def _overflow_set(self, _place: int, value: int) -> None:
        if value and self.overflow is None:
            self.overflow = self.here()

    def note(self, number: int, name: str) -> None:
        """A field of a node is out of its range from this line on."""
        self.notes[number, name] = self.here()

    def here(self) -> tuple[str, int]:
        """The innermost line of the folder that is being run."""
        frame = sys._getframe(1)
        while frame.f_back is not None:
            if Path(frame.f_code.co_filename).is_relative_to(self.folder):
                break
            frame = frame.f_back
        return folders.shown(Path(frame.f_code.co_filename)), frame.f_lineno

    def words(self, said: str) -> str:
        """The line that made what is broken, and what is."""
        if self.overflow is not None:
            path, line = self.overflow
            return f"{path}:{line}: more actions than the outbox holds; raise OUTBOX. {said}"
        for number, state in enumerate(self.states):
            for name, (low, high) in self._ranges.items():
                value = getattr(state, name)
                if not all(low <= one <= high for one in _all(value)):
                    path, line = self.notes.get((number, name), ("", 0))
                    if path:
                        return f"{path}:{line}: {name} is {value}, declared {low} to {high}. {said}"
        return f"{self.sent.words}. {said}" if self.sent.words else said


class _Row(Row, Told):  # type: ignore[misc]
    """An array field of a state."""


def _all(value: Any) -> list[int]:
    return value if isinstance(value, list) else [value]


@contextmanager
def blaming(network: Network, watch: Watched | None = None) -> Iterator[None]:
    """What goes wrong in a folder's code is told by its file and line.

    Raises:
        NetworkError: in place of any error that comes by a file of the folder.
    """
    try:
        yield
    except (InvariantBroken, folders.NetworkError) as error:
        if watch is None:
            raise
        raise folders.NetworkError(watch.words(str(error))) from None
    except BdbQuit:  # a person has left the debugger
        raise KeyboardInterrupt from None
    except Exception as error:
        assert network.folder is not None
        words = folders.blamed(error, network.folder) or _compiling(error, network.folder)
        if not words:
            raise
        raise folders.NetworkError(words) from None


def _compiling(error: Exception, folder: Path) -> str:
    """Where a compiler says that it stopped."""
    if not type(error).__module__.startswith("numba"):
        return ""
    places = [one for one in _IN_FILE.findall(str(error)) if Path(one[0]).is_relative_to(folder)]
    if not places:
        return ""
    path, line = places[-1]
    told = [text.strip() for text in str(error).splitlines()]
    what = next((one for one in told if one and "Failed in" not in one and "File " not in one), "")
    return f"{folders.shown(Path(path))}:{line}: cannot be compiled: {what}"


def try_plain(network: Network, plan: Any, **kept: bool) -> None:
    """Run the beginning of a plan plain, once for each network, before it is compiled.

    Raises:
        NetworkError: it breaks; the file and line.
    """
    if network in _tried or _size(plan) > TRIAL_NODES:
        return
    _play(network, plan, TRIAL_EVENTS, kept)
    _tried.add(network)


def again(
    network: Network, plan: Any, handled: int, error: InvariantBroken, **kept: bool
) -> NoReturn:
    """Say where a compiled run broke, by a plain one.

    Raises:
        NetworkError: always, with the line if it is found.
    """
    if handled <= AGAIN_EVENTS and _size(plan) <= TRIAL_NODES:
        _play(network, plan, AGAIN_EVENTS, kept)
    raise folders.NetworkError(str(error)) from None


def _play(network: Network, plan: Any, events: int, kept: dict[str, bool]) -> None:
    running: Simulation = network.simulation(plan, plain=True, **kept)
    watch = Watched(running, network)
    with blaming(network, watch):
        running.advance(plan.duration_us, events)


def _size(plan: Any) -> int:
    return plan.graph.cells if hasattr(plan, "graph") else int(plan.nodes)
