"""A recorded run as a source: simulated again from its scenario, which gives the same network.

The tables of a run folder hold what happened, not what every node knew at every moment. The same
scenario and seed give all of it again, on any machine; the fingerprint says that it is the same.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

from innervate.running import folder as folders
from innervate.running.recorded import RecordedRun
from innervate.web.errors import WatchError
from innervate.web.simulated import Progress, Simulated


def plan_of(folder: Path) -> Any:
    """The plan of a run folder's scenario, as far as the run came.

    Raises:
        RunError: it is no run folder, or its scenario cannot be run any more.
    """
    run = RecordedRun(folder)
    plan = run.plan()
    if run.interrupted_s is None:
        return plan
    reached_us = round(1e6 * run.interrupted_s) + 1  # what happened at that moment is shown, too
    return replace(plan, duration_us=min(plan.duration_us, reached_us))


class Recorded(Simulated):
    """A run folder. Nothing can be done to it, but its time goes both ways."""

    kind_of_source: ClassVar[str] = "run"

    def __init__(self, folder: Path, plan: Any, speed: float | None = None) -> None:
        super().__init__(plan, speed)
        self.can = ("pause", "step", "speed", "seek")
        self._run = RecordedRun(folder)

    @property
    def report(self) -> Path | None:
        """The run's page, if it was written."""
        path = self._run.folder / folders.REPORT
        return path if path.is_file() else None

    def scene(self) -> dict[str, Any]:
        """Nodes, links and what else stands still."""
        return {**super().scene(), "report": self.report is not None}

    def replay(self, progress: Progress = lambda now_us, end_us: None) -> None:
        """Simulate it to its end, see that it is the same, and go back to the beginning.

        Of a run that was interrupted only that is simulated which was then; its last moment was
        cut short, so that there is no fingerprint to compare.

        Raises:
            WatchError: this version of innervate makes another network of it.
        """
        self.prepare()
        self.run_to_end(progress)
        if self.broken:
            raise WatchError(f"{self._run.folder}: simulated again, {self.broken}")
        was, now = self._run.summary.get("fingerprint"), self.engine.running.fingerprint
        interrupted_s = self._run.interrupted_s
        if interrupted_s is None and was != now:
            raise WatchError(
                f"{self._run.folder}: simulated again, its fingerprint is {now}, not {was}: it was "
                "made by another version of innervate; run its scenario again"
            )
        self.back_to(0)
        if interrupted_s is not None:
            planned_s = self.plan.scenario.model.duration_s
            text = f"the run was interrupted at {interrupted_s:g} of {planned_s:g} s"
            self.view.log.say(0, text)
