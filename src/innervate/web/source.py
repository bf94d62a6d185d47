"""What can be watched: one interface for simulated, recorded and running networks."""

from abc import ABC, abstractmethod
from typing import Any

from innervate.web.errors import Refused
from innervate.web.history import History
from innervate.web.messages import Command, name_of


class Source(ABC):
    """A network to watch. All its methods are called by one thread, the stage's.

    Attributes:
        history: what pages are told once.
        can: names of the commands that it carries out, "pause" for both pause and go.
        scenes: how many scenes there were; a new number says that pages need the scene anew.
    """

    can: tuple[str, ...] = ()

    def __init__(self) -> None:
        self.history = History()
        self.scenes = 1

    @abstractmethod
    def scene(self) -> dict[str, Any]:
        """Who is there and where; all that does not change, without the message's `type`."""

    @abstractmethod
    def fields(self) -> dict[str, Any]:
        """The state now, by field: arrays, numbers, lists; what is not there is left out."""

    @abstractmethod
    def work(self) -> float:
        """Do what is due, for some ten milliseconds at most; when to come back, in seconds.

        Raises:
            Exception: it cannot go on.
        """

    @abstractmethod
    def do(self, command: Command) -> dict[str, Any] | None:
        """Carry out a command that is in `can`; an answer for the page that gave it.

        Raises:
            Refused: why it cannot be done.
        """

    def close(self) -> None:  # noqa: B027 - most have nothing to let go of
        """Let go of files, sockets and threads; most have none."""

    def carry_out(self, command: Command) -> dict[str, Any] | None:
        """Carry out a command, if that is possible here.

        Raises:
            Refused: why it is not.
        """
        if name_of(command) not in self.can:
            raise Refused(f'"{name_of(command)}" is not possible here')
        return self.do(command)
