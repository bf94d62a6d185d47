"""Runs: `run(scenario)` simulates, sums up and writes a run folder."""

from innervate.running.compare import Comparison, Divergence, compare
from innervate.running.errors import RunError
from innervate.running.folder import default_folder
from innervate.running.run import Run, run

__all__ = ["Comparison", "Divergence", "Run", "RunError", "compare", "default_folder", "run"]
