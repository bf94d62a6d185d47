"""A simulation as a source: paced, held, taken back, and changed while it runs."""

import time
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

from innervate import __version__
from innervate.network import networks
from innervate.sim.driver import InvariantBroken
from innervate.web.engine import Engine, Mark, engine_of
from innervate.web.errors import Refused
from innervate.web.messages import Command, Go, Pause, Save, Seek, Speed, Step
from innervate.web.playback import Playback
from innervate.web.saving import saved
from innervate.web.source import Source
from innervate.web.view import View

SLICE_S = 0.01  # so long nobody is listened to
BUDGET = 500  # events at least, and as many as fit into a slice
BEAT_S = 1 / 60  # paced networks are brought up to date so often
POINTS = 500  # of every plot, over the whole time, at least
POINT_US = (1_000, 10_000)  # between two of them: at least; and at most, for who looks on
POINTS_PER_S = 10  # so many are enough for who looks on
MARKS = 32
APART_US = 20_000  # between two of them at first
MARKS_BYTES = 256 * 1024 * 1024

Progress = Callable[[int, int], None]


class Checkpoint(NamedTuple):
    """A moment to go back to."""

    engine: Mark
    memory: Any


class Simulated(Source):
    """A plan that is simulated while one looks on.

    Its speed is seconds of the network per second; None = one at which its changes can be seen.

    Attributes:
        broken: what a checker found that must not happen; the network is held there. "" = nothing.
    """

    kind_of_source: ClassVar[str] = "simulation"

    def __init__(self, plan: Any, speed: float | None = None) -> None:
        super().__init__()
        self.plan = plan
        self.engine: Engine = engine_of(plan)
        self.view: View = networks()[plan.kind].view(self.engine, self.history)
        saves = ("save",) if self.view.saves else ()
        self.can = ("pause", "step", "speed", "seek", *self.view.can, *saves)
        self.playback = Playback(self.view.speed if speed is None else speed)
        self.broken = ""
        self._budget = BUDGET
        self._target_us: int | None = None  # where a seek leads
        self._next_point_us = self._point_us()
        self._sampled_us = 0
        self._marks: list[Checkpoint] = []
        self._apart_us = APART_US

    def prepare(self) -> None:
        """Compile what has to be compiled: up to a minute, once on a machine."""
        self.engine.running.prepare()
        self._keep()

    @property
    def at_end(self) -> bool:
        """True if nothing more can happen."""
        done = self.engine.now_us >= self.plan.duration_us or self.engine.running.is_complete()
        return done or bool(self.broken)

    def scene(self) -> dict[str, Any]:
        """Nodes, links and what else stands still."""
        return {
            "kind": self.plan.kind,
            "name": self.plan.scenario.name,
            "source": self.kind_of_source,
            "version": __version__,
            "can": list(self.can),
            "duration_s": self.plan.duration_us / 1e6,
            "t_s": self.engine.now_us / 1e6,
            **({"absent": True} if self.view.has_absent() else {}),
            **self.view.scene(),
        }

    def fields(self) -> dict[str, Any]:
        """What pages get of the present state, by name."""
        self.view.is_still = self.playback.paused or self.at_end
        is_paced = self.playback.paused or 0 < self.playback.speed <= self.view.slow
        return {
            "t_s": self.engine.now_us / 1e6,
            "paused": self.playback.paused,
            "speed": self.playback.speed,
            "at_end": self.at_end,
            **self.view.fields(flights=is_paced and self._target_us is None),
        }

    def work(self) -> float:
        """Go on as far as the playback says."""
        now_us, end_us = self.engine.now_us, self.plan.duration_us
        if self._target_us is not None:
            self._advance(self._target_us)
            if self.engine.now_us >= self._target_us or self.at_end:
                self._target_us = None
                self._point_at_rest()
                self.playback.start_from(self.engine.now_us)
            return 0.0
        due_us = self.playback.due_us(end_us)
        if self.at_end or due_us <= now_us:
            return 1.0 if self.at_end or self.playback.paused else BEAT_S
        self._advance(due_us)
        self.playback.note(self.engine.now_us, due_us)
        return BEAT_S if self.engine.now_us >= due_us else 0.0

    def do(self, command: Command) -> dict[str, Any] | None:
        """Carry out a page's command; what to tell all pages of it, or None."""
        now_us = self.engine.now_us
        if isinstance(command, Pause):
            self.playback.hold(now_us)
            self._point_at_rest()
        elif isinstance(command, Go):
            self.playback.go(now_us)
        elif isinstance(command, Speed):
            self.playback.set_speed(command.value, now_us)
            self._plan_point()
        elif isinstance(command, Seek):
            self._seek(command.t_s)
        elif isinstance(command, Save):
            if not self.view.saves:
                raise Refused(f"how a {self.plan.kind} writes its events is not known here")
            return {"type": "saved", "toml": saved(self.view)}
        elif self._target_us is not None:
            raise Refused(f"on the way to {self._target_us / 1e6:g} s; try again in a moment")
        elif isinstance(command, Step):
            self._step()
        else:
            self._change(command)
        return None

    def run_to_end(self, progress: Progress = lambda now_us, end_us: None) -> None:
        """Go on to the end at once; `progress` is called now and then."""
        self._target_us = self.plan.duration_us
        self._plan_point()
        while not self.at_end:
            self._advance(self.plan.duration_us)
            progress(self.engine.now_us, self.plan.duration_us)
        self._target_us = None

    def back_to(self, to_us: int) -> None:
        """Go back to the last moment kept that is not after `to_us`."""
        kept = max(
            (kept for kept in self._marks if kept.engine.now_us <= to_us),
            key=lambda kept: kept.engine.now_us,
        )
        self.engine.back_to(kept.engine)
        self.view.forget(kept.memory)
        self.history.go_back(kept.engine.now_us)
        self.broken = ""
        self._sampled_us = self.engine.now_us
        self._plan_point()
        self.playback.start_from(self.engine.now_us)

    def _advance(self, until_us: int) -> None:
        """Go on towards a time, for about a slice."""
        began = time.perf_counter()
        while self.engine.now_us < until_us and not self.at_end:
            edge = min(until_us, self._next_point_us, self._next_check_us(), self.engine.edge_us)
            if self.engine.is_before_fault:
                self.view.memory.before = self.view.apart()
            started = time.thread_time()  # not the time others have the processor
            try:
                self.engine.advance(edge, self._budget)
            except InvariantBroken as error:
                self._break(str(error))
            took = time.thread_time() - started
            if took > SLICE_S:
                self._budget = max(BUDGET, self._budget // 2)
            elif took < SLICE_S / 4 and self.engine.now_us < edge:
                self._budget *= 2
            self.view.note(self.engine.running.take())
            if self.view.is_open and self.engine.now_us >= edge:
                self.view.check()
            is_point = self.engine.now_us >= self._next_point_us
            if is_point or self.at_end:
                self._sample()
            if is_point:
                self._keep()
            if time.perf_counter() - began > SLICE_S:
                break
        if self.at_end and self.engine.now_us > self._sampled_us:
            self._sample()

    def _point_us(self) -> int:
        """Time between two points of the plots now."""
        whole_us = max(POINT_US[0], int(self.plan.duration_us) // POINTS)
        if self.playback.speed == 0 or self._target_us is not None:
            return whole_us
        return min(whole_us, max(POINT_US[1], round(1e6 * self.playback.speed / POINTS_PER_S)))

    def _sample(self) -> None:
        self._sampled_us = self.engine.now_us
        self.view.sample()
        self._plan_point()

    def _point_at_rest(self) -> None:
        """Plots tell of the moment at which somebody looks, too: not only of the one before."""
        if self.engine.now_us >= self._sampled_us + POINT_US[0]:
            self._sample()
        else:
            self._plan_point()

    def _plan_point(self) -> None:
        every_us = self._point_us()
        self._next_point_us = (self.engine.now_us // every_us + 1) * every_us

    def _next_check_us(self) -> int:
        """When the view is to look next whether the network has got over a fault."""
        every_us = self.view.check_us
        if not every_us or not self.view.is_open:
            return int(self.plan.duration_us)
        return (self.engine.now_us // every_us + 1) * every_us

    def _break(self, text: str) -> None:
        self.broken = text
        self.view.log.say(self.engine.now_us, text, "bad")

    def _keep(self) -> None:
        """Keep this moment, if the last one kept is long enough ago; of too many every other."""
        newest_us = self._marks[-1].engine.now_us if self._marks else -self._apart_us
        if self.engine.now_us < newest_us + self._apart_us:
            return
        self._marks.append(Checkpoint(self.engine.mark(), self.view.remember()))
        most = max(2, min(MARKS, MARKS_BYTES // self._marks[-1].engine.bytes))
        if len(self._marks) > most:
            self._marks = self._marks[::2]
            self._apart_us *= 2

    def _seek(self, t_s: float) -> None:
        to_us = min(max(0, round(t_s * 1e6)), self.plan.duration_us)
        if to_us < self.engine.now_us:
            self.back_to(to_us)
        self._target_us = to_us
        self._plan_point()

    def _step(self) -> None:
        self.playback.hold(self.engine.now_us)
        at_us = self.engine.running.next_us()
        if at_us is None or at_us >= self.plan.duration_us or self.at_end:
            raise Refused("nothing more happens")
        self._pass(at_us)

    def _change(self, command: Command) -> None:
        """Something is done to the network, now."""
        if self.broken or self.engine.now_us >= self.plan.duration_us:
            raise Refused("this is the end; go back first")
        at_us = self.engine.earliest_us
        self.view.apply(command)
        self._marks = [kept for kept in self._marks if kept.engine.now_us <= at_us]
        self._pass(at_us)

    def _pass(self, at_us: int) -> None:
        """Go on until all of that moment has happened, in however many slices; stay there."""
        while self.engine.now_us <= at_us and not self.at_end:
            self._advance(at_us + 1)
        self.playback.start_from(self.engine.now_us)
