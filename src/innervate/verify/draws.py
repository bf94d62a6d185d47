"""What nodes draw while they are explored: every outcome, as far as there are few.

An event is explored once for every way in which its draws can turn out. Of a draw out of more than
FEW the first, the second, the middle and the last are tried, of one such draw in an event at a
time, while the others give the first; of one event the first PLACES draws, those behind them (of a
loop that draws again) are what a stream says; and at most OUTCOMES ways, those first in which fewer
draws give something else than the first. What was left out is noted.
"""

from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from innervate.dialect.rng import GENERATE
from innervate.kernel.words import number_of
from innervate.trace.streams import Stream, stream
from innervate.verify.states import Step

FEW = 8
PLACES = 16
OUTCOMES = 512
MANY_SIZES = 4  # of which a line names each
NEEDED = ("choice", "asked")  # fields of a node that draws


def tried(count: int) -> tuple[int, ...]:
    """What a draw out of so many is explored to give."""
    return tuple(range(count)) if count <= FEW else (0, 1, count // 2, count - 1)


def branches(script: tuple[int, ...], sizes: list[int]) -> list[tuple[int, ...]]:
    """The scripts that differ from one that was played in one draw behind it.

    `sizes` is in how many ways each draw can turn out; a draw behind a script gives the first.
    """
    found = []
    for at in range(len(script), len(sizes)):
        zeros = script + (0,) * (at - len(script))
        found += [(*zeros, value) for value in range(1, sizes[at])]
    return found


class Draws:
    """Answers what nodes draw while they are explored."""

    def __init__(self) -> None:
        # the node that is called, by name; "" = nobody is, and nothing can be drawn
        self.who, self.answer = "", GENERATE
        self.made: list[tuple[str, int, int]] = []  # of the present event: (who, what, out of)
        # out of how many was drawn; where not everything was tried; events with ways not tried
        self.sizes, self.some, self.left_out = set[int](), set[int](), 0
        self._script: tuple[int, ...] = ()
        self._more: Stream | None = None

    def node(self, base: type) -> type:
        """A class of nodes whose draws are answered here, if they have what a draw needs."""
        if not all(hasattr(base, name) for name in NEEDED):
            return base

        def given(node: Any) -> int:
            return self.answer if self.who else node.kept_choice

        def ask(node: Any, count: int) -> None:
            if self.who:
                self.ask(count)
            else:  # the node is put back
                node.kept_asked = count

        members = {
            "kept_choice": GENERATE, "kept_asked": 0,
            "choice": property(given, lambda node, value: setattr(node, "kept_choice", value)),
            "asked": property(lambda node: node.kept_asked, ask),
        }  # fmt: skip
        return type("Node", (base,), members)

    def call(self, who: str) -> None:
        """A node is called now, or nobody any more ("")."""
        self.who, self.answer = who, 0

    def ask(self, count: int) -> None:
        """Find what a draw out of so many gives."""
        if count < 1:
            raise ValueError(f"a draw out of {count}: there is nothing to draw")
        if count == 1:
            self.answer = 0
            return
        place = len(self.made)
        self.sizes.add(count)
        if count > FEW:
            self.some.add(count)
        self.answer = self._script[place] if place < len(self._script) else 0
        if place >= PLACES:
            self._more = self._more or stream(1, "draws of one explored event")
            self.answer = self._more.draw(count)
            self.some.add(count)
        self.made.append((self.who, self.answer, count))

    def outcomes(self, make: Callable[..., Step], *what: Any) -> Iterator[Step]:
        """An event in every way in which its draws can turn out."""
        todo: deque[tuple[int, ...]] = deque([()])
        count = 0
        while todo and count < OUTCOMES:
            self._script = todo.popleft()
            step = self._outcome(make, *what)
            made = self.made
            count += 1
            given = tuple(value for _, value, _ in made)
            is_spent = any(value and size > FEW for _, value, size in made[: len(self._script)])
            for place in range(len(self._script), min(len(made), PLACES)):
                size = made[place][2]
                if size <= FEW or not is_spent:
                    todo += [(*given[:place], value) for value in tried(size)[1:]]
            if todo and count == OUTCOMES:
                self.left_out += 1
                self.some.update(size for _, _, size in made)
            self._script = ()
            yield step

    def again(self, drawn: tuple[int, ...], make: Callable[..., Step], *what: Any) -> Step:
        """An event as it was, its draws given; those behind them give 0."""
        self._script = drawn
        step = self._outcome(make, *what)
        self._script = ()
        return step

    def _outcome(self, make: Callable[..., Step], *what: Any) -> Step:
        """An event as the script has it, and in words what was drawn."""
        self.made, self._more = [], None
        step = make(*what)
        return step._replace(words=step.words + told(self.made)) if self.made else step

    @contextmanager
    def by_chance(self) -> Iterator[None]:
        """What is drawn meanwhile belongs to no event: a stream says it, and it is not noted."""
        kept = self.made, self._more, set(self.sizes), set(self.some)
        self.made, self._more = [], None
        try:
            yield
        finally:
            self.made, self._more, self.sizes, self.some = kept

    def as_dict(self) -> dict[str, Any]:
        """What was tried, for --json."""
        every = self.sizes - self.some
        return {"every": sorted(every), "some": sorted(self.some), "left_out": self.left_out}

    def words(self) -> str:
        """What was not tried, behind what was explored; "" nothing."""
        parts, large = [], sorted(size for size in self.some if size > FEW)
        if large:
            named = [f"{size:,}" for size in large]
            if len(named) > MANY_SIZES:
                named = [f"{named[0]} to {named[-1]}"]
            parts.append(f"; of draws out of {', '.join(named)} "
                         "only the first, second, middle and last were tried")  # fmt: skip
        if self.left_out:
            events = number_of(self.left_out, "event")
            parts.append(f"; of {events} only {OUTCOMES} ways to draw were tried")
        elif self.some - set(large):
            parts.append(f"; of events with more than {PLACES} draws only the first {PLACES} "
                         "were tried")  # fmt: skip
        return "".join(parts)


def told(made: list[tuple[str, int, int]]) -> str:
    """What was drawn, behind the words of an event."""
    by: dict[str, list[str]] = {}
    for who, value, count in made:
        by.setdefault(who, []).append(f"{value} out of {count:,}")
    return "".join(f", {who} draws {' and '.join(drawn)}" for who, drawn in by.items())
