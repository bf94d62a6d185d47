"""Reads a run folder, for comparing, exporting and watching."""

from functools import cached_property
from pathlib import Path
from typing import Any

from innervate import scenario as scenarios
from innervate.running import folder as folders
from innervate.running.errors import RunError
from innervate.scenario import ScenarioError


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
    def interrupted_s(self) -> Any:
        """Simulated time at which it was interrupted, s; None if it came to its end."""
        return self.summary.get("interrupted_at_s")

    def plan(self) -> Any:
        """The plan of its scenario, to its end even where the run was interrupted."""
        try:
            return scenarios.plan(scenarios.load(self.folder / folders.SCENARIO))
        except ScenarioError as error:
            raise RunError(f"its scenario cannot be run any more: {error}") from None
