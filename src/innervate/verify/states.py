"""States of any network that declares its protocol, as they are explored, and what made them."""

from __future__ import annotations

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
    """

    values: tuple[Any, ...]
    timers: tuple[tuple[int, int], ...]
    down: tuple[tuple[Any, ...], ...] = ()


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
