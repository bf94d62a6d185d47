"""What an action is: a thing that can be done to a network, and its words."""

from __future__ import annotations

from typing import NamedTuple


class Action(NamedTuple):
    """One thing that can be done, by the word for it; its number is its place in a table.

    Attributes:
        word: as in `action = "cut"`.
        target: what it happens to: "cable" or "link"; "node", or "cell" for nodes but the PC.
        key: of an event's table, that only this action has; "" = none.
        harms: it makes things worse: recordings show it as a warning.
        mends: the action that it undoes; "" = none.
        revives: a node that is off is on after it, though it undoes nothing else.
    """

    word: str
    target: str
    key: str = ""
    harms: bool = False
    mends: str = ""
    revives: bool = False


def words(table: tuple[Action, ...]) -> tuple[str, ...]:
    """The words of a table, in order of their numbers."""
    return tuple(action.word for action in table)


def harmful(table: tuple[Action, ...]) -> tuple[str, ...]:
    """Those that make it worse."""
    return tuple(action.word for action in table if action.harms)
