"""Sweeps: `sweep(scenario, vary=...)` runs grids of scenarios, many times each."""

from innervate.sweeping.errors import SweepError
from innervate.sweeping.plan import SweepPlan
from innervate.sweeping.result import Sweep
from innervate.sweeping.sweep import load_sweep, make_plan, sweep

__all__ = ["Sweep", "SweepError", "SweepPlan", "load_sweep", "make_plan", "sweep"]
