"""The skin paper: Bader, Bergner and Cheng, a dynamic network protocol for an artificial skin."""

from functools import partial
from pathlib import Path

from innervate.papers.experiment import Experiment
from innervate.papers.words import sentences

TITLE = "A robust and efficient dynamic network protocol for a large-scale artificial robotic skin"
AUTHORS = "C. Bader, F. Bergner, G. Cheng"
READINGS = sentences(Path(__file__).with_name("readings.txt").read_text(encoding="utf-8"))
# One module each, in the order of the paper; the last two are beyond it.
FIGURES = (
    "startup", "fig5", "fig6", "eq3", "delay", "fig8a", "fig8b", "eq7", "at_most", "fig10", "eq9",
    "fig11", "loop", "modes",
)  # fmt: skip
experiment = partial(Experiment.of, __name__)


def warm_up() -> None:
    """Compile the loops that the figures need."""
    from innervate import scenario
    from innervate.networks.skin.sim.simulate import simulate

    tiny = {"kind": "skin", "duration_s": 0.01, "patch": [{"columns": 2, "rows": 1}]}
    for rule in ("feasible", "static"):
        tables = tiny | {"interface": [{"row": 0, "column": 0}], "protocol": {"rule": rule}}
        simulate(scenario.plan(scenario.from_dict(tables)))
