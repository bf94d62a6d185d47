"""The radio paper: Kim and Kim, CSMA/CD-R for a wireless multi-robot communication."""

from functools import partial
from pathlib import Path

from innervate.papers.experiment import Experiment
from innervate.papers.words import sentences

TITLE = "CSMA/CD-R for a wireless multi-robot communication"
AUTHORS = "D.-H. Kim, J.-H. Kim"
READINGS = sentences(Path(__file__).with_name("readings.txt").read_text(encoding="utf-8"))
# One module each: figures in the order of the paper, what was found about them, and the last
# three beyond it.
FIGURES = (
    "fig1", "fig4_5", "limits", "fig6_7", "quadratic", "fig12", "ties", "silent", "members",
    "capture", "fairness", "practical", "turnaround", "delay",
)  # fmt: skip
experiment = partial(Experiment.of, __name__)


def warm_up() -> None:
    """Compile the loops that the figures need."""
    from innervate.networks.radio.papers.common import MACS
    from innervate.networks.radio.papers.medium import Channel
    from innervate.networks.radio.slotted.model import slotted

    for mac in MACS:
        for traffic in ("saturated", "disaster"):
            slotted(mac, 2, 5, traffic, packets=2)
    for mode in ("paper", "practical"):
        Channel(mode, 2, 5).run(1)
