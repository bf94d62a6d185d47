"""What an action is: a thing that can be done to a network, and its words."""

from typing import NamedTuple


class Action(NamedTuple):
    """One thing that can be done, by the word for it; its number is its place in a table."""

    word: str  # as in `action = "cut"`
    target: str  # what it happens to: "cable" or "link"; "node", or "cell" for nodes but the PC
    key: str = ""  # of an event's table, that only this action has; "" = none
    harms: bool = False  # it makes things worse: recordings show it as a warning
    mends: str = ""  # the action that it undoes; "" = none
    revives: bool = False  # a node that is off is on after it, though it undoes nothing else


def words(table: tuple[Action, ...]) -> tuple[str, ...]:
    """The words of a table, in order of their numbers."""
    return tuple(action.word for action in table)


def targets(table: tuple[Action, ...]) -> dict[str, str]:
    """What each happens to, by its word."""
    return {action.word: action.target for action in table}


def harmful(table: tuple[Action, ...]) -> tuple[str, ...]:
    """Those that make it worse."""
    return tuple(action.word for action in table if action.harms)
