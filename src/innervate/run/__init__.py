"""Runs: `innervate.run(scenario)` simulates, sums up and writes a run folder."""

import sys
from types import ModuleType

from innervate.run.compare import Comparison, Divergence, compare
from innervate.run.errors import RunError
from innervate.run.folder import default_folder
from innervate.run.run import Run, resolve, run

__all__ = [
    "Comparison",
    "Divergence",
    "Run",
    "RunError",
    "compare",
    "default_folder",
    "resolve",
    "run",
]


class _CallableRoom(ModuleType):
    """Makes `innervate.run(...)` work although `innervate.run` is this package, too."""

    __call__ = staticmethod(run)


sys.modules[__name__].__class__ = _CallableRoom
