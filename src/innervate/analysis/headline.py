"""What a person reads first of a network: is all well, and if not, what is wrong.

Every network works out its headline in one function, from facts that a finished run, a simulation
that is under way and running nodes all have. Summary, report, terminal, live page, `compare` and
sweeps show what that function says; none of them judges by itself.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple, TypedDict

from innervate.kernel.words import number_of

OK, DEGRADED, DOWN, NO_DATA = "ok", "degraded", "down", "no data"
LEVELS = (OK, DEGRADED, DOWN, NO_DATA)  # from well to worst; no data: nobody answers


class HeadlineEntry(TypedDict):
    """The entry `headline` of a summary: one of LEVELS, and a sentence."""

    level: str
    text: str


class Headline(NamedTuple):
    """The state of a network in a word and a sentence.

    Attributes:
        level: one of LEVELS. ok: nothing is lost and everybody has a way; degraded: something is
            lost, late or cut off, the rest works; down: nothing gets through; no data: nothing is
            known, as nobody answers.
        text: one sentence with a full stop, worst news first, counts included.
        nodes: indices of the nodes it is about, to be marked on a map; none if all is well.
    """

    level: str
    text: str
    nodes: tuple[int, ...] = ()

    def shown(self) -> dict[str, Any]:
        """For pages, with the nodes to be marked."""
        return {**self.as_summary(), "nodes": list(self.nodes)}

    def as_summary(self) -> HeadlineEntry:
        """The entry `headline` of a summary."""
        return {"level": self.level, "text": self.text}


BEFORE_ALL = Headline(NO_DATA, "Nothing has happened yet.")


PLURAL = {"is": "are", "was": "were", "has": "have", "does": "do", "waits": "wait"}


def verb(count: int, one: str) -> str:
    """A verb of so many: "is" of one, "are" of several."""
    return one if count == 1 else PLURAL[one]


def sentence(parts: Iterable[str]) -> str:
    """Several parts as one sentence."""
    text = "; ".join(parts)
    return f"{text[0].upper()}{text[1:]}."


def every(count: int, what: str) -> str:
    """All of them: "the only cell", "both cells", "all 30 cells"."""
    if count > 2:
        return f"all {count:,} {what}s"
    return f"both {what}s" if count == 2 else f"the only {what}"


def part_of(part: int, whole: int, what: str) -> str:
    """So many of them: "1 of 91 messages"; all of them as every() says it."""
    if part < whole:
        return f"{part:,} of {number_of(whole, what)}"
    return every(whole, what)


def put_out(who: str, count: int) -> str:
    """Of running nodes whose identities are revoked: `who` they are, and how many."""
    whose = "its identity is" if count == 1 else "their identities are"
    return f"{who} {verb(count, 'was')} put out: {whose} revoked"


def silent(count: int, what: str) -> Headline:
    """Of a network of which nobody answers; `what` one of them is called."""
    who = f"None of the {count:,} {what}s answers." if count > 1 else f"The only {what} is silent."
    return Headline(NO_DATA, who, tuple(range(count)))
