"""How a declared protocol breaks, in sentences: what happened, and which fields it changed."""

import traceback
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from innervate import dialect, folders, verify
from innervate.verify.cases import Story
from innervate.verify.states import State, Step

MOST = 6  # changes that a sentence has room for
DRAWN = {"rng", "choice", "asked"}  # a generator's own
ERRORS = (ArithmeticError, AttributeError, IndexError, NameError, TypeError, ValueError)

# What a state was first reached from, and how; None where it is the start, and nothing was drawn.
Before = Mapping[State, tuple[State | None, str] | None]


def story_of(net: Any, before: Before, state: State, title: str, last: Step | None = None) -> Story:
    """The way to a state, and what breaks in it, or in the last step from it."""
    steps = [(last.words, state, last.state)] if last else []
    here: State | None = state
    while here is not None and (made := before[here]) is not None:
        earlier, words = made
        steps.append((words, earlier or here, here))
        here = earlier
    steps.reverse()
    told = [sentence(net, *step) for step in steps]
    return Story(title, told, events=[words for words, _, _ in steps])


def sentence(net: Any, words: str, earlier: State, later: State) -> str:
    """An event, and what it changed."""
    found = []
    for number, (was, now) in enumerate(zip(earlier.nodes, later.nodes, strict=True)):
        label = net.graph.label(number)
        whose = "" if label in words.split() else f"{label} "
        found += [whose + one for one in _changes(net, was.values, now.values)]
    if len(found) > MOST:
        found[MOST:] = [f"{len(found) - MOST} more"]
    return f"{words}: {', '.join(found)}." if found else f"{words}."


def _changes(net: Any, was: tuple[Any, ...], now: tuple[Any, ...]) -> Iterator[str]:
    """Fields with their values before and after; moments pass by themselves."""
    for (name, length, *_), a, b in zip(net.fields.STATE, was, now, strict=True):
        if name in net.clocks or name in DRAWN:
            continue
        pairs = zip(a, b, strict=True) if length else [(a, b)]
        for place, (before, after) in enumerate(pairs):
            if before != after:
                yield f"{name}{f'[{place}]' if length else ''} {before} to {after}"


def past_words(past: Mapping[tuple[str, int], int]) -> str:
    """Timers that were set for what is past, behind what was explored; "" none."""
    return "".join(f"; {handler} sets timer {timer} up to {us:,} us in the past, it is due at once"
                   for (handler, timer), us in past.items())  # fmt: skip


def where(error: BaseException) -> str:
    """An error in a protocol or an invariant: its file and line, and what is wrong."""
    places = traceback.extract_tb(error.__traceback__)
    homes = [Path(room.__path__[0]) for room in (dialect, verify)]
    last = [one for one in places
            if not any(Path(one.filename).is_relative_to(home) for home in homes)][-1]  # fmt: skip
    what = f"{type(error).__name__}: {error}"
    if isinstance(error, AttributeError) and error.name:
        what = f"{error.name} is no field that fields.py declares"
    return f"{folders.shown(Path(last.filename))}:{last.lineno}: {what}"


def first_broken(rules: dict[str, Any], *given: Any) -> str:
    """What the first rule says that does not hold, or where it cannot be looked at."""
    for title, holds in rules.items():
        try:
            if not holds(*given):
                return title
        except ERRORS as error:
            return f"an invariant cannot be looked at: {where(error)}"
    return ""
