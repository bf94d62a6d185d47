"""States of any network that declares its protocol, as they are explored, and what made them."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple


@dataclass(frozen=True, slots=True)
class Budget:
    """How often what may happen: lost frames, nodes that lose their memory, inputs."""

    loss: int = 1
    restart: int = 1
    input: int = 1


class Node(NamedTuple):
    """A node: its state's values, its timers as (timer, us from its time on), frames handed down.

    Frames are handed down, and leave later, where the protocol is told when they do (`on_sent`).
    `late` are those that were sent with a delay: us from its time on, port, frame.
    `airing` are its frames on the air whose end it has not been told of (`on_carrier`).
    """

    values: tuple[Any, ...]
    timers: tuple[tuple[int, int], ...]
    down: tuple[tuple[Any, ...], ...] = ()
    late: tuple[tuple[int, int, tuple[Any, ...]], ...] = ()
    airing: int = 0


class State(NamedTuple):
    """A network: its nodes, the frames on their way by end, and what may still go wrong."""

    nodes: tuple[Node, ...]
    ways: tuple[tuple[tuple[Any, ...], ...], ...]
    left: tuple[int, ...]


class Step(NamedTuple):
    """A successor: what happened, the state after it, what it broke ("" nothing)."""

    words: str
    state: State
    broken: str


After = tuple[State, str]  # the state after something, and what that broke


class Move(NamedTuple):
    """What can happen: its words, and what makes it so, from what."""

    words: str
    make: Callable[..., After]
    what: tuple[Any, ...]


def happen(move: Move) -> Step:
    """What comes of a move."""
    return Step(move.words, *move.make(*move.what))


def sent(state: State, ends: list[int], frame: tuple[Any, ...]) -> State:
    """The state after a frame has left at some ends of cables."""
    ways = list(state.ways)
    for end in ends:
        ways[end] = (*ways[end], frame)
    return state._replace(ways=tuple(ways))


def is_still(state: State) -> bool:
    """True if nothing happens any more by itself."""
    return not any(state.ways) and not any(any(node[1:]) for node in state.nodes)


def most_frames(state: State) -> int:
    """How many frames are where most are: on a cable one way, held back in a node, or its own."""
    down = (len(node.down) for node in state.nodes)
    late = (count for node in state.nodes if node.late
            for count in Counter(port for _, port, _ in node.late).values())  # fmt: skip
    return max(*map(len, state.ways), *down, *late, *(node.airing for node in state.nodes))
