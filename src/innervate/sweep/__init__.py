"""Sweeps: `innervate.sweep(scenario, vary=...)` runs grids of scenarios, many times each."""

import sys
from types import ModuleType

from innervate.sweep.errors import SweepError
from innervate.sweep.plan import SweepPlan
from innervate.sweep.result import Sweep, load
from innervate.sweep.sweep import make_plan, sweep

__all__ = ["Sweep", "SweepError", "SweepPlan", "load", "make_plan", "sweep"]


class _CallableRoom(ModuleType):
    """Makes `innervate.sweep(...)` work although `innervate.sweep` is this package, too."""

    __call__ = staticmethod(sweep)


sys.modules[__name__].__class__ = _CallableRoom
