"""Sweeps: what a run costs beyond itself, and how much of every core there is.

Both are counted from the first run's beginning to the last one's end, so without starting the
workers, which happens once. Other work on the machine lowers the scaling.
"""

import os

import innervate

SMALL = "radio-disaster"
SMALL_RUNS = 1000
LONG = {"duration_s": 120.0, "data.rate_hz": 100, "event.0.at_s": 60.0}
LONG_RUNS = 24


def span_s(done):
    """From the first run's beginning to the last one's end."""
    times = done.timings
    return (times["began_s"] + times["wall_s"]).max() - times["began_s"].min()


def overhead():
    """Seconds of worker time that a small run costs beyond itself, here and in processes."""
    figures = {}
    for name, workers in (("here", 1), ("processes", max(2, os.cpu_count() or 1))):
        done = innervate.sweep(SMALL, repeat=SMALL_RUNS, workers=workers)
        figures[name] = (span_s(done) * workers - done.timings["wall_s"].sum()) / SMALL_RUNS
    return figures


def scaling():
    """Speed on all cores over that on one, per core; 1 = perfect. Compute-bound runs."""
    cores = os.cpu_count() or 1
    one, all_ = (
        span_s(innervate.sweep("setup-3", overrides=LONG, repeat=LONG_RUNS, workers=workers))
        for workers in (1, cores)
    )
    return {"cores": cores, "per_core": one / all_ / cores}
