"""What `innervate verify` is handed by a network, case by case, and what all cases have in common.

A network's part `verify` is a module with `explorations(network, options)`: all that is asked for,
each a function that explores it and returns a `Case`; if it takes long to compile,
`notice(options)`: what to say before the first; MUTANTS and `hunt(mutant)`, if there are any.
"""

from collections import Counter
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

from innervate.kernel.words import number_of
from innervate.prove.mutants import Mutant
from innervate.verify.errors import VerifyError
from innervate.verify.tally import Tally

BUDGET_MAX = 20
# What options say if they are left out: of that which is explored, and how much and how it is.
UNSAID = {"rule": "", "updates": "all", "graph": "all", "cells": 0, "budget": "", "prompt": False,
          "starts": 0, "walks": 0}  # fmt: skip
USUAL = UNSAID | {"liveness": True, "states": 0, "seed": None, "memory": "2G", "reduce": True,
                  "plain": False}  # fmt: skip

# Is told what is being done, how much of it is, and of how much (0 = unknown); true = stop.
Tell = Callable[[str, int, int], bool]


def only(name: str, options: Any, *takes: str) -> None:
    """That nothing is asked for which an exploration of a network would pass over in silence.

    Raises:
        VerifyError: something is.
    """
    for option, unsaid in UNSAID.items():
        if option not in takes and getattr(options, option, unsaid) != unsaid:
            known = ", ".join(f"--{one}" for one in takes)
            raise VerifyError(f"--{option} is not for {name}, of which {known} can be said")


@dataclass
class Story:
    """A counterexample in sentences: how something breaks."""

    title: str  # what is broken, in one line
    sentences: list[str] = field(default_factory=list)  # one for each event
    scenario: str = ""  # the text of a scenario file that plays it; "" = none does
    # the sentences without what an event changed, where a script takes them so
    events: list[str] = field(default_factory=list)

    def lines(self) -> list[str]:
        """The story as numbered lines."""
        told = [f"{i}. {text}" for i, text in enumerate(self.sentences, 1)]
        return [*told, f"So: {self.title}"]


@dataclass(slots=True)
class Case:
    """One exploration and what came of it.

    Attributes:
        lines: for people.
        record: for --json.
        is_broken: a property does not hold.
        is_complete: everything was looked at, within what `but` says.
        but: what of a complete exploration was not; "" = nothing.
        sums_up: the last line counts it.
        story: the counterexample, if it is told: title, sentences, scenario, lines().
        play: makes the text of a scenario that plays it; "" = none does.
        stem: what its files are called, before their number.
    """

    lines: list[str]
    record: dict[str, Any]
    is_broken: bool
    is_complete: bool = True
    sums_up: bool = True
    story: Any = None
    play: Callable[[], str] | None = None
    stem: str = "counterexample"
    but: str = ""


Explore = Callable[[Tell], Case]


def notice_of(network: Any, options: Any) -> str:
    """What to say before the first exploration of a network; "" = nothing takes long."""
    return str(network.verify.notice(options)) if hasattr(network.verify, "notice") else ""


@dataclass(frozen=True, slots=True)
class Catch:
    """What an explorer found of a mutant, which it runs uncompiled on copies of the protocol.

    Attributes:
        mutant: that was hunted.
        by: what it breaks; "" = nothing was found.
        where: it was found.
        states: how many were looked at, or runs.
    """

    mutant: Mutant
    by: str
    where: str
    states: int


def verdict(done: list[Case], is_cut: bool = False) -> str:
    """The last line; "" where there is none. `is_cut`: others were asked for and not begun."""
    if not all(case.sums_up for case in done):
        return ""
    if not done:
        return "Nothing was explored."
    broken = sum(case.is_broken for case in done)
    part = sum(not case.is_complete and not case.is_broken for case in done)
    end = "; interrupted before the others." if is_cut else "."
    if broken:
        rest = f"; {part} of the others only in part" if part else ""
        return f"{broken} of {len(done)} broken{rest}{end}"
    whole = [case for case in done if case.is_complete]
    but = _buts(whole, "of the others" if part else "of them")
    if len(done) == 1:
        far = "only in part" if part else "completely"
        return f"Nothing broken in one exploration, {far}{but}{end}"
    sampled = f"; {part} of them only in part" if part else ", all completely"
    return f"Nothing broken in {len(done)} explorations{sampled}{but}{end}"


def _buts(whole: list[Case], whose: str) -> str:
    """What complete explorations did not look at, each thing with how many it is said of."""
    counts = Counter(case.but for case in whole if case.but)
    return "".join(f", {but}" if count == len(whole) else f", {count:,} {whose} {but}"
                   for but, count in counts.items())  # fmt: skip


def lines_of(head: str, story: Any, else_words: Callable[[], str]) -> list[str]:
    """The lines of a case: a counterexample, or how far the search came."""
    if story is None:
        return [f"{head}  {else_words()}"]
    told = [f"    {line}" for line in story.lines()]
    events = len(story.sentences)
    after = f" after {number_of(events, 'event')}" if events else ""
    return [f"{head}  BROKEN{after}", *told]


def many(tally: Tally, more: int = 0) -> str:
    """How many states (or walks) and successors there were, in columns, the last so much wider."""
    what = number_of(tally.states, "walk" if tally.ended == "walked" else "state")
    what = f"{what} " if tally.ended == "walked" else what
    return f"{what:>17} {number_of(tally.generated, 'successor'):>{21 + more}}"


def extent(tally: Tally) -> str:
    """How far a search came, in words."""
    first = f"first {number_of(tally.expanded, 'state')}, to {number_of(tally.depth, 'event')}"
    return {
        "complete": "all states",
        "broken": "broken",
        "memory": f"{first}: memory is full",
        "limit": f"{first}, as asked",
        "interrupted": f"{first}: interrupted",
        "walked": "a sample of random walks",
    }[tally.ended]


def budget_of(text: str, given: Any, words: dict[str, tuple[str, int]] | None = None) -> Any:
    """Budgets from text like "deaths=2,acks=0"; those left out stay as they are.

    Args:
        text: of --budget.
        given: a dataclass of whole numbers.
        words: what else may be written for a number: {"ticks=any": ("ticks", 255)}.

    Raises:
        VerifyError: no such budget, or no number.
    """
    values = asdict(given)
    names, words = ", ".join(values), words or {}
    for part in filter(None, text.replace(" ", ",").split(",")):
        name, _, value = part.partition("=")
        if part in words:
            name, number = words[part]
            values[name] = number
        elif name in values and value.isascii() and value.isdigit() and int(value) <= BUDGET_MAX:
            values[name] = int(value)
        else:
            more = "".join(f", or {word}" for word in words)
            message = f'--budget: "{part[:40]}" should be NAME=NUMBER, at most {BUDGET_MAX}{more}'
            raise VerifyError(f"{message}; the names are {names}")
    return type(given)(**values)


def choices(name: str, text: str, known: tuple[str, ...]) -> tuple[str, ...]:
    """One of several words, or all of them.

    Raises:
        VerifyError: none of them.
    """
    if text == "all":
        return known
    if text not in known:
        raise VerifyError(f'--{name} is {", ".join(known)} or all, not "{text[:40]}"')
    return (text,)


def bytes_of(text: str) -> int:
    """Memory like "800M" or "4G".

    Raises:
        VerifyError: no such size.
    """
    unit = {"M": 1 << 20, "G": 1 << 30}.get(text[-1:].upper())
    number = text[:-1] if unit else text
    if unit is None or not (number.isascii() and number.isdigit() and int(number) > 0):
        raise VerifyError(f'--memory takes a size like 800M or 4G, not "{text[:40]}"')
    return int(number) * unit
