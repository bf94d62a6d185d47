"""The radio paper: Kim and Kim, CSMA/CD-R for a wireless multi-robot communication."""

from importlib import import_module

from innervate.papers.experiment import Experiment
from innervate.papers.radio.readings import READINGS as READINGS

TITLE = "CSMA/CD-R for a wireless multi-robot communication"
AUTHORS = "D.-H. Kim, J.-H. Kim"
# One module each: figures in the order of the paper, what was found about them, and the last
# three beyond it.
FIGURES = (
    "fig1", "fig4_5", "limits", "fig6_7", "quadratic", "fig12", "ties", "silent", "members",
    "capture", "fairness", "practical", "turnaround", "delay",
)  # fmt: skip


def experiment(name: str) -> Experiment:
    """The experiment of a figure, loaded when it is asked for."""
    found = import_module(f"innervate.papers.radio.{name}").EXPERIMENT
    assert isinstance(found, Experiment)
    return found


def warm_up() -> None:
    """Compile the loops that the figures need."""
    from innervate.papers.radio.common import MACS
    from innervate.papers.radio.medium import Channel
    from innervate.sim.slotted import slotted

    for mac in MACS:
        for traffic in ("saturated", "disaster"):
            slotted(mac, 2, 5, traffic, packets=2)
    for mode in ("paper", "practical"):
        Channel(mode, 2, 5).run(1)
