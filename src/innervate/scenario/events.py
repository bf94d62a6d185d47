"""What [[event]] tables of all networks have in common: when, which keys, how they are told."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from heapq import merge
from operator import itemgetter
from typing import Any

from innervate.scenario.actions.action import Action
from innervate.scenario.lines import Key
from innervate.scenario.source import Source, dotted, with_article
from innervate.trace.streams import Stream

SHOWN = 12  # events of a scenario that are told one by one
Finding = tuple[Key, str]


def refuse(source: Source, findings: Iterable[Finding]) -> None:
    """Raise ScenarioError for the first of (key, what is wrong with it)."""
    for key, message in findings:
        raise source.error(key, message)


def in_order(key: Key, pair: tuple[float, float], names: str = "least, most") -> Iterator[Finding]:
    """That a range does not end before it begins."""
    if pair[0] > pair[1]:
        yield key, f"{dotted(key)} must be [{names}], not [{pair[0]:g}, {pair[1]:g}]"


def in_time(
    index: int,
    at_s: float | tuple[float, float],
    duration_s: float,
    names: str = "from, to",
    table: str = "event",
) -> Iterator[Finding]:
    """That event (or `table`) `index` happens: a run ends just before `duration_s`."""
    first, last = at_s if isinstance(at_s, tuple) else (at_s, at_s)
    key: Key = (table, index, "at_s")
    name = dotted(key)
    yield from in_order(key, (first, last), names)
    if not first >= 0:
        yield key, f"{name} must be a number of seconds from 0, not {first:g}"
    if micros(last) > micros(duration_s):
        yield key, f"{name} = {last:g} is outside the run; duration_s is {duration_s:g}"
    if micros(last) == micros(duration_s):
        message = f"{name} = {last:g} is the end of the run, so it would never happen"
        yield key, f"{message}; make it earlier, or duration_s longer"


def own_keys(index: int, event: Any, table: Sequence[Action]) -> Iterator[Finding]:
    """That an event has no key that only other actions have."""
    for name in dict.fromkeys(action.key for action in table if action.key):
        words = [action.word for action in table if action.key == name]
        if getattr(event, name) is not None and event.action not in words:
            those = " and ".join(f'"{word}"' for word in words)
            message = f'event.{index}.{name} goes with {those}, not "{event.action}"'
            yield ("event", index, name), message


class Harmed:
    """Who is dead and what is cut as events go by, so that random ones hit what is whole.

    Attributes:
        actions: those of a table, by their words.
        by: what an action has done harm to that nobody has mended, by the action's word.
    """

    def __init__(self, table: Sequence[Action]) -> None:
        self.actions = {action.word: action for action in table}
        self.by: dict[str, set[Any]] = {action.word: set() for action in table if action.harms}

    def note(self, word: str, hit: Any) -> None:
        """Remember what an event did."""
        action = self.actions[word]
        if action.harms:
            self.by[word].add(hit)
        if action.mends:
            self.by[action.mends].discard(hit)
        if action.revives:  # off and on: whoever was dead is there again
            self.by["kill"].discard(hit)


def exact(value: float) -> Fraction:
    """The decimal number the user wrote, free of binary rounding."""
    return Fraction(repr(float(value)))


def micros(seconds: float) -> int:
    """Seconds as the nearest whole number of microseconds."""
    return round(exact(seconds) * 1_000_000)


def at_us(event: Any, draw: Stream) -> int:
    """When an event happens, us: as it says, or drawn from its range."""
    if isinstance(event.at_s, tuple):
        return draw.uniform(micros(event.at_s[0]), micros(event.at_s[1]))
    return micros(event.at_s)


def opening(made: Any) -> str:
    """The first line on a plan: its name, network, length and seed."""
    what = f"{made.scenario.name}: {with_article(made.kind)} scenario"
    return f"{what} of {made.duration_us / 1e6:g} s, seed {made.seed}"


def told(
    made: Any,
    fault_words: Callable[[Any, Any], str],
    warnings: Iterable[str],
    own: Iterable[tuple[int, str]] = (),
) -> Iterator[str]:
    """The lines on a plan's events and warnings, as at the end of what `check` prints.

    `own` are events that only this kind of network has: when (us), and in words.
    """
    events = list(merge(((fault.at_us, fault) for fault in made.faults), own, key=itemgetter(0)))
    for i, (_, event) in enumerate(events[:SHOWN]):
        words = event if isinstance(event, str) else fault_words(made, event)
        yield f"  {'' if i else 'event':10} {words}"
    if len(events) > SHOWN:
        yield f"  {'':10} and {len(events) - SHOWN} more"
    for text in warnings:
        yield f"  warning    {text}"
