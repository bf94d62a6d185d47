"""Events of a counterexample, played on the whole network and put into words."""

from dataclasses import dataclass
from typing import Any

from innervate.kernel.words import number_of
from innervate.networks.skin.protocol.constants import INFINITY, NONE, PORTS
from innervate.networks.skin.verify import check as skin_check
from innervate.networks.skin.verify import moves as skin_moves
from innervate.networks.skin.verify import row as skin_row
from innervate.networks.skin.verify import world as w
from innervate.topology import Graph
from innervate.verify.twin import Event, Twin


@dataclass(frozen=True, slots=True)
class Scene:
    """The network after an event."""

    parents: tuple[int, ...]  # the node each cell sends to, NONE without a way, over cut cables too
    cut: frozenset[tuple[int, int]]  # pairs of nodes whose cable is cut
    actor: int  # who did something, NONE for a cable


class Narrator:
    """Plays events on the real network and finds words for them."""

    def __init__(self, real: Twin, story: Any) -> None:
        self.real, self.story = real, story
        self.graph: Graph = real.model.graph
        self.steps: list[str] = []

    def name(self, node: int) -> str:
        """What a node is called in sentences."""
        return "the PC" if node == self.graph.sink else self.graph.label(node)

    def play(self, found: Twin, event: Event) -> None:
        """One event of the search, in the state before it."""
        kind, arg = event.kind, event.arg
        before = self._parents()
        if kind in (w.TICK, w.PC_TICK):
            node = arg if kind == w.TICK else self.graph.sink
            text = self._tick(found, node, event)
            actor = node
        elif kind in (w.DELIVER, w.LOSE):
            text, actor = self._frame(found, kind, arg, event)
        elif kind == w.SOON:
            text, actor = self._soon(arg, event), arg
        else:
            text, actor = self._outside(kind, arg)
        if actor != NONE and actor < self.graph.cells:
            text += self._turned(actor, before[actor])
        self.story.sentences.append(("The" + text[3:] if text.startswith("the ") else text) + ".")
        self.story.steps.append(self.steps)
        self.steps = []
        self.story.scenes.append(Scene(tuple(self._parents()), frozenset(self._cut()), actor))

    # What happens.

    def _tick(self, found: Twin, node: int, event: Event) -> str:
        """A node ticks, after what it takes in."""
        is_cell = node < self.graph.cells
        heard, breaks = self._taken_in(found, node, event.variant)
        listens = self.real.world.work[self.real.lay.pc_at + w.PC_LISTEN]
        queued = self._queued(node)
        if is_cell:
            self._step(w.TICK, node, breaks, event.choice, event.asked)
        else:
            self._step(w.PC_TICK, 0, 0, 0, 1)
        self.steps.append(f"tick {self.graph.label(node)}")
        if is_cell:
            words, said = ", ".join([*heard, "ticks"]), self._said(node, queued)
            return f"{self.name(node)} {words}{f' and says {said}' if said else ''}"
        if listens:
            return f"the PC {', '.join([*heard, 'has listened for a period'])}"
        own = self.real.world.work[self.real.lay.pc_at + w.PC_SQ]
        return f"the PC sends its beacon with number {own}"

    def _taken_in(self, found: Twin, node: int, variant: int) -> tuple[list[str], int]:
        """What a node takes in before its tick, in words; which of its ends break then, coded."""
        heard: list[str] = []
        breaks, factor, wrongly = 0, 1, 0
        is_cell = node < self.graph.cells
        for end in self.graph.ends_of(node):
            if self.graph.peer[end] < 0:
                continue
            way = self.real.lay.in_way[end]
            queued = found.world.work[found.lay.queue_at[way]] if found.model.merges else 0
            can = int(is_cell and _may_break(found, end, wrongly))
            real_can = int(is_cell and _may_break(self.real, end, wrongly))
            count = 1 + queued + can
            chosen, variant = variant % count, variant // count
            if can and chosen == count - 1:
                heard.append(self._broken(end, way))
                breaks += factor
                wrongly += not self._is_cut(way)
            elif chosen:
                heard.append(self._hear(found, way, chosen))
            factor *= 1 + real_can
        return heard, breaks

    def _hear(self, found: Twin, way: int, count: int) -> str:
        """Frames are taken in: as many as it takes to come to the one the search took."""
        wanted = _queued_frame(found, way, count)
        while self._first(way) != wanted:
            self._take(way)
        self._take(way)
        return f"hears from {self._frame_words(way, wanted)}"

    def _first(self, way: int) -> bytes:
        """The oldest frame that is under way."""
        queue = self.real.lay.queue_at[way]
        assert self.real.world.work[queue] > 0, "a frame is missing from the story"
        return _queued_frame(self.real, way, 1)

    def _take(self, way: int) -> None:
        self._step(w.DELIVER, way, 0, 0, 1)
        self.steps.append(f"deliver {self._way(way)}")

    def _broken(self, end: int, way: int) -> str:
        """A port is found broken by the coming tick."""
        self.steps.append(f"detect {self._end(end)}")
        wrongly = "" if self._is_cut(way) else ", wrongly,"
        other = self.graph.node_of(self.graph.peer[end])
        return f"finds{wrongly} its cable to {self.name(other)} broken"

    def _frame(self, found: Twin, kind: int, way: int, event: Event) -> tuple[str, int]:
        """A frame arrives, or is lost; the PC hears first what the search has left out for it."""
        first = _queued_frame(found, way, 1)
        while self._first(way) != first:
            self._take(way)
        node = self.graph.node_of(self.real.lay.way_end[way])
        words = self._frame_words(way, first)
        self._step(kind, way, 0, event.choice, event.asked)
        if kind == w.LOSE:
            self.steps.append(f"lose {self._way(way)}")
            return f"lost on its way to {self.name(node)}: the beacon of {words}", NONE
        self.steps.append(f"deliver {self._way(way)}")
        return f"{self.name(node)} hears from {words}", node

    def _soon(self, node: int, event: Event) -> str:
        """The timer for news fires."""
        queued = self._queued(node)
        self._step(w.SOON, node, 0, event.choice, event.asked)
        self.steps.append(f"soon {self.graph.label(node)}")
        said = self._said(node, queued)
        name = self.name(node)
        return f"{name} sends its news: {said}" if said else f"{name} comes to send news"

    def _outside(self, kind: int, arg: int) -> tuple[str, int]:
        """A cable is cut or mended, or the PC restarts."""
        self._step(kind, arg, 0, 0, 1)
        if kind == w.RESTART_PC:
            self.steps.append("restart pc")
            return "the PC restarts and has forgotten its number", NONE
        way = 2 * arg
        verb = "cut" if kind == w.CUT_LINK else "restore"
        self.steps.append(f"{verb} {self._way(way)}")
        a, b = (self.graph.node_of(self.real.lay.way_end[w_]) for w_ in (way + 1, way))
        a, b = (b, a) if b == self.graph.sink else (a, b)
        what = "is cut" if kind == w.CUT_LINK else "works again"
        return f"the cable between {self.name(a)} and {self.name(b)} {what}", NONE

    def _step(self, kind: int, arg: int, variant: int, choice: int, asked: int) -> None:
        if asked > 1:
            self.steps.append(f"draw {choice}")
        move = self.real.moves.index((kind, arg))
        done = self.real.system.step(self.real.world, move, variant, choice)
        assert done > 0, "a step of the story cannot be taken"

    # Words.

    def _frame_words(self, way: int, frame: bytes) -> str:
        sender = self.name(self.graph.node_of(self.real.lay.way_end[way ^ 1]))
        child = ", you are my parent" if frame[w.SAYS] & skin_row.IS_CHILD else ""
        return f'{sender} "{_route(frame[w.DIST], frame[w.SQ])}{child}"'

    def _queued(self, node: int) -> dict[int, int]:
        """How many frames of a node are under way, by direction."""
        ends = [end for end in self.graph.ends_of(node) if self.graph.peer[end] >= 0]
        ways = [self.real.lay.out_way[end] for end in ends]
        return {way: self.real.world.work[self.real.lay.queue_at[way]] for way in ways}

    def _said(self, node: int, before: dict[int, int]) -> str:
        """The beacon that a node has sent over a cable since then; "" none."""
        for way, count in self._queued(node).items():
            if count > before[way]:
                frame = _queued_frame(self.real, way, count)
                return f'"{_route(frame[w.DIST], frame[w.SQ])}"'
        return ""

    def _turned(self, cell: int, old: int) -> str:
        new = self._parents()[cell]
        if new == old:
            return "" if new == NONE else f"; it stays with {self.name(new)}"
        if new == NONE:
            return f"; it leaves {self.name(old)} and has no way left"
        left = f"leaves {self.name(old)} and " if old != NONE else ""
        return f"; it {left}takes {self.name(new)} as its parent"

    def _end(self, end: int) -> str:
        node, port = self.graph.node_of(end), self.graph.port_of(end)
        return f"{self.graph.label(node)}.{port}"

    def _way(self, way: int) -> str:
        """A direction as a script names it."""
        ends = self.real.lay.way_end
        return f"{self._end(ends[way ^ 1])}->{self._end(ends[way])}"

    # The network.

    def _parents(self) -> list[int]:
        found = []
        for cell in range(self.graph.cells):
            port = skin_check.parent_port(self.real.world, cell)
            there = NONE if port == NONE else self.graph.peer[PORTS * cell + port]
            found.append(NONE if port == NONE else self.graph.node_of(there))
        return found

    def _is_cut(self, way: int) -> bool:
        return bool(self.real.world.work[self.real.lay.link_at + way // 2])

    def _cut(self) -> list[tuple[int, int]]:
        ends = self.real.lay.way_end
        return [
            (self.graph.node_of(ends[way]), self.graph.node_of(ends[way + 1]))
            for way in range(0, self.real.lay.ways, 2)
            if self._is_cut(way)
        ]


def _may_break(twin: Twin, end: int, wrongly: int) -> bool:
    """If a cell can find a port broken, after so many in the same tick that work."""
    node, port = divmod(end, PORTS)
    if not skin_moves.may_break(twin.world, node, port):
        return False
    work, at = twin.world.work, twin.lay.budget_at
    is_cut = work[twin.lay.link_at + twin.lay.in_way[end] // 2]
    return bool(is_cut) or min(work[at + w.FALSE], work[at + w.TOTAL]) > wrongly


def _queued_frame(twin: Twin, way: int, count: int) -> bytes:
    """The bytes of a frame that is under way, the oldest is 1."""
    at = twin.lay.queue_at[way] + 1 + w.FRAME_BYTES * (count - 1)
    return bytes(twin.world.work[at : at + w.FRAME_BYTES])


def _route(dist: int, sq: int) -> str:
    if dist == INFINITY:
        return f"no route, number {sq}"
    return f"{number_of(dist, 'hop')}, number {sq}"
