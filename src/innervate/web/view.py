"""What a simulated network looks like: what all kinds have in common."""

import copy
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Any, ClassVar

from innervate.analysis.headline import Headline
from innervate.scenario.actions.action import Action
from innervate.web.engine import Engine, Rows
from innervate.web.errors import Refused
from innervate.web.history import LOSS, RETURN, SERIES, History, Logbook
from innervate.web.messages import Command, Cut, Heal, Kill, Revive
from innervate.web.recovery import Recovery
from innervate.web.taken import LEAVE, Taken


@dataclass(slots=True)
class Memory:
    """What a view remembers of the time before; goes back with the network."""

    recovery: Recovery | None = None
    fault: Any = None  # the newest that took something away
    event_us: int = 0  # when something was done last, whatever it was
    told_us: int = 0  # faults before this are told
    before: int = 0  # so many were cut off before the newest moment in which something was done
    taken: Taken = field(default_factory=Taken)


class View(ABC):
    """Draws an engine's world up for pages, and turns their commands into faults."""

    # Seconds of the network per second, at which its changes can be seen; and from where on
    # frames on their way can.
    speed: ClassVar[float]
    slow: ClassVar[float]
    can: tuple[str, ...] = ("cut", "heal", "kill", "revive")
    # `check` is called at multiples of this time, us, while somebody has no way; 0 = never.
    check_us: ClassVar[int] = 0
    actions: ClassVar[tuple[Action, ...]] = ()  # of the medium, by the numbers that faults have
    fault_type: ClassVar[Any]  # of the faults of a plan
    memory: Any  # all that it keeps from one moment to the next
    saves: bool = True  # what was done to it can be written as a scenario's events
    is_still: bool = True  # the network is held, so that there is time to count all anew

    def __init__(self, engine: Engine, history: History) -> None:
        self.engine = engine
        self.plan = engine.plan
        self.history = history
        self.log = Logbook(history)

    @abstractmethod
    def scene(self) -> dict[str, Any]:
        """Nodes, links and what else stands still."""

    @abstractmethod
    def note(self, rows: Rows) -> None:
        """Take in what happened since the last call."""

    @abstractmethod
    def points(self) -> dict[str, float | None]:
        """A point of every plot, for now."""

    @abstractmethod
    def arrays(self, flights: bool) -> dict[str, Any]:
        """The state's fields for nodes and links; `flights` with frames on their way."""

    @abstractmethod
    def headline(self) -> Headline:
        """Is all well, and if not, what is wrong."""

    @abstractmethod
    def words(self, fault: Any) -> str:
        """What a fault does, in words for the log."""

    def takes(self, fault: Any) -> bool:
        """True if a fault takes something away, false if it gives it back."""
        return not self.actions[fault.action].mends

    @abstractmethod
    def cut(self, link: int, heal: bool) -> dict[str, int]:
        """Fields of the fault that cuts a link, or puts it back; Refused if it is so already."""

    @abstractmethod
    def kill(self, node: int, revive: bool) -> dict[str, int]:
        """Fields of the fault that switches a node off, or on; Refused if it is so already."""

    def make(self, at_us: int, index: int, fields: dict[str, int]) -> Any:
        """A fault of the plan's own type, of what `cut` or `kill` says."""
        return self.fault_type(at_us=at_us, index=index, **fields)

    @abstractmethod
    def event(self, fault: Any) -> dict[str, Any]:
        """The [[event]] table of a fault, without its time."""

    @property
    def is_open(self) -> bool:
        """True if the network has not got over the newest fault yet."""
        recovery = self.memory.recovery
        return recovery is not None and recovery.recovered_ms is None

    def apart(self) -> int:
        """How many are cut off now, so that no recovery can have them in it."""
        return 0

    def check(self) -> None:  # noqa: B027 - only who says so by `check_us`
        """Look whether the network has recovered; called at `check_us`."""

    def sample(self) -> None:
        """Keep a point of every plot."""
        self.history.add(SERIES, self.engine.now_us, self.points())

    def fault(self, command: Command) -> Any:
        """The fault that a command means, at the earliest moment.

        Raises:
            Refused: there is no such link or node, or it is so already.
        """
        if isinstance(command, Cut | Heal):
            fields = self.cut(command.link, isinstance(command, Heal))
        elif isinstance(command, Kill | Revive):
            fields = self.kill(command.node, isinstance(command, Revive))
        else:
            raise Refused("not possible here")
        return self.make(self.engine.earliest_us, self.engine.next_index, fields)

    def apply(self, command: Command) -> None:
        """Have a command happen at the earliest moment.

        Raises:
            Refused: see `fault`.
        """
        self.engine.add(self.fault(command))

    def extra(self) -> dict[str, Any]:
        """Tables of the scenario, besides its events, that commands have changed."""
        return {}

    def changes(self, fault: Any) -> bool:
        """Take in what a fault does; false if all is as it was, as when the dead are killed."""
        if not self.actions:
            return True
        action, thing = self.actions[fault.action], fault.node
        if action.target == "link":
            thing = tuple(sorted((fault.node, fault.other)))
        elif action.target == "cable":
            thing = min(fault.end, int(self.plan.graph.peer[fault.end]))
        absent = {node for node, off in enumerate(getattr(self.plan, "absent", ())) if off}
        taken: Taken = self.memory.taken
        return taken.changes(self.actions, action, thing, absent)

    def has_absent(self) -> bool:
        """True if somebody is yet to come, or leaves: off at times, though nothing failed."""
        leaves = any(map(self.leaves, self.plan.faults))
        return leaves or any(getattr(self.plan, "absent", ()))

    def leaves(self, fault: Any) -> bool:
        """True if somebody goes by plan: nothing failed."""
        return bool(self.actions) and self.actions[fault.action].word == LEAVE

    def begin_fault(self, fault: Any) -> bool:
        """Something is done to the network now; false if that changes nothing."""
        memory, cause = self.memory, self.words(fault)
        if not self.changes(fault):
            self.log.say(fault.at_us, f"{cause}: nothing changed")
            return False
        memory.event_us = fault.at_us
        if self.leaves(fault):
            self.log.say(fault.at_us, cause)
            return True
        if self.takes(fault):
            memory.recovery, memory.fault = self._lost(cause, fault.at_us), fault
        elif memory.recovery is not None:
            memory.recovery.close()
        self.log.calm()
        self.log.say(fault.at_us, cause, mark=LOSS if self.takes(fault) else RETURN)
        return True

    def _lost(self, cause: str, at_us: int) -> Recovery:
        """Something was taken away; what went at the same moment before it is named first."""
        first, before = self.memory.recovery, self.memory.before
        if first is None or first.at_us != at_us:
            return Recovery(cause, at_us, before=before)
        return Recovery(first.cause, at_us, more=first.more + 1, before=before)

    def tell_faults(self) -> list[Any]:
        """Begin all faults that have happened and were not told yet; them, in order of time."""
        since_us, until_us = self.memory.told_us, self.engine.now_us
        self.memory.told_us = until_us
        happened = [fault for fault in (*self.plan.faults, *self.engine.given)
                    if since_us <= fault.at_us < until_us]  # fmt: skip
        happened.sort(key=lambda fault: fault.at_us)
        for fault in happened:
            self.begin_fault(fault)
        return happened

    def fields(self, flights: bool) -> dict[str, Any]:
        """What pages get of the present state; `flights`: with frames under way."""
        recovery, fault = self.memory.recovery, self.memory.fault
        return {
            **self.arrays(flights),
            "headline": self.headline().shown(),
            "since_cut_s": fault and (self.engine.now_us - fault.at_us) / 1e6,
            "recovery": None if recovery is None else recovery.shown(),
        }

    def remember(self) -> Any:
        """The memory, to go back to."""
        return copy.deepcopy(self.memory)

    def forget(self, memory: Any) -> None:
        """Go back to a memory."""
        self.memory = copy.deepcopy(memory)
        self.log.calm()
