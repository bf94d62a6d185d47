"""The thread in which a network runs: commands come in, snapshots go out."""

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any

from innervate.web.errors import Refused
from innervate.web.messages import Command
from innervate.web.snapshot import Part, Snapshot
from innervate.web.source import Source

STATES_PER_S = 30
WAITING_MAX = 1_000

Reply = Callable[[dict[str, Any]], None]
Publish = Callable[[Snapshot], None]


def next_due(due: float, now: float) -> float:
    """When the next state may be shown, if one was due at `due` and was shown now.

    Who is late once, because others had the processor, may be early once.
    """
    return max(due + 1 / STATES_PER_S, now - 1 / STATES_PER_S)


class Stage:
    """Runs a source in a thread of its own, so that no page can hold it up.

    Args:
        source: what is watched.
        publish: called in that thread with every new snapshot, at most STATES_PER_S times a second.
        ended: called in that thread with a line when the source cannot go on.
    """

    def __init__(
        self, source: Source, publish: Publish, ended: Callable[[str], None] = lambda text: None
    ) -> None:
        self.source = source
        self.newest: Snapshot | None = None
        self._scene = Part({})
        self._scenes = 0
        self._publish = publish
        self._ended = ended
        self._waiting: deque[tuple[Command, Reply]] = deque()
        self._wake = threading.Condition()
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name="stage", daemon=True)

    def start(self) -> None:
        """Begin; the first snapshot is there when this returns."""
        self._show()
        self._thread.start()

    def stop(self) -> None:
        """End, and wait for it."""
        with self._wake:
            self._stopping.set()
            self._wake.notify()
        if self._thread.is_alive():
            self._thread.join(timeout=5.0)
        self.source.close()

    def submit(self, command: Command, reply: Reply) -> None:
        """Have a command carried out; `reply` is called, in the stage's thread, with answers.

        Raises:
            Refused: too many wait already.
        """
        with self._wake:
            if len(self._waiting) >= WAITING_MAX:
                raise Refused("too many commands wait; try again in a moment")
            self._waiting.append((command, reply))
            self._wake.notify()

    def _run(self) -> None:
        due, fresh = time.monotonic(), True
        try:
            while not self._stopping.is_set():
                told = self._obey()
                rest = self.source.work()
                now = time.monotonic()
                if now >= due or told:
                    fresh = self._show()
                    due = next_due(due, now)
                until_shown = max(0.0, due - time.monotonic())
                with self._wake:
                    if not self._waiting and not self._stopping.is_set() and rest > 0:
                        # Where nothing changes, nothing has to be shown.
                        self._wake.wait(min(rest, max(until_shown, 0.001)) if fresh else rest)
        except Exception as error:
            self._show()
            self._ended(" ".join(str(error).split()) or type(error).__name__)

    def _obey(self) -> bool:
        """Carry out the commands that wait: were there any?"""
        told = False
        while True:
            with self._wake:
                if not self._waiting:
                    return told
                command, reply = self._waiting.popleft()
            told = True
            try:
                answer = self.source.carry_out(command)
            except Refused as error:
                answer = {"type": "error", "text": str(error)}
            if answer is not None:
                reply(answer)

    def _show(self) -> bool:
        """Publish the state, if there is anything new in it: was there?"""
        source = self.source
        if self._scenes != source.scenes:
            self._scenes = source.scenes
            self._scene = Part({"type": "scene", **source.scene()})
        newest = source.history.newest
        snapshot = Snapshot(self._scene, source.fields(), newest, self.newest)
        if snapshot.same_as(self.newest):
            return False
        self.newest = snapshot
        self._publish(snapshot)
        return True
