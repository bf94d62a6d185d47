"""Reads a run folder, for comparing, exporting and watching."""

from functools import cached_property
from pathlib import Path
from typing import Any

from innervate import scenario as scenarios
from innervate.running import folder as folders
from innervate.running.errors import RunError
from innervate.scenario import ScenarioError

TIME_MAX_S = 1e12  # no run comes so far


def time_of(value: Any, called: str) -> float:
    """A moment of simulated time that a summary has, s.

    Raises:
        RunError: it is none.
    """
    if type(value) not in (int, float) or not 0 <= value < TIME_MAX_S:
        raise RunError(f"{called}: its summary is damaged; run the scenario again")
    return float(value)


class RecordedRun:
    """What a run folder says of its run; its files are read as they are asked for.

    Attributes:
        folder: where it is.
        summary: as it was written.

    Raises:
        RunError: it is no run folder, or damaged; so from whatever reads one of its files.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.summary = folders.read_json(folder, folders.SUMMARY)

    @cached_property
    def provenance(self) -> dict[str, Any]:
        """Versions, seeds and settings that it came from, and the hashes of its tables."""
        return folders.read_json(self.folder, folders.PROVENANCE)

    def check_tables(self) -> None:
        """That its tables are as they were written."""
        folders.check_tables(self.folder, self.provenance.get("tables_sha256"))

    @property
    def interrupted_s(self) -> float | None:
        """Simulated time at which it was interrupted, s; None if it came to its end."""
        at_s = self.summary.get("interrupted_at_s")
        return None if at_s is None else time_of(at_s, str(self.folder))

    @property
    def scenario(self) -> Path:
        """The file of its scenario."""
        path = self.folder / folders.SCENARIO
        if not path.is_file():
            raise RunError(f"{self.folder} is not a run folder: it has no {path.name}")
        return path

    def plan(self) -> Any:
        """The plan of its scenario, to its end even where the run was interrupted."""
        try:
            return scenarios.plan(scenarios.load(self.scenario))
        except ScenarioError as error:
            raise RunError(f"its scenario cannot be run any more: {error}") from None
