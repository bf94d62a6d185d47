"""The mesh's document: centrally computed routing tables, and a virtual fence on top of them."""

from functools import partial
from pathlib import Path

from innervate.papers.experiment import Experiment
from innervate.papers.words import sentences

TITLE = "Routing tables from a gateway, and a virtual fence"
AUTHORS = "The routing part of a design of a virtual fence for robots"
READINGS = sentences(Path(__file__).with_name("readings.txt").read_text(encoding="utf-8"))
# One module each: what was asked for, then the document's statements in its order.
FIGURES = (
    "bars", "recall", "stretch", "failures", "lossy", "alarms", "gateway", "scale", "versions",
)  # fmt: skip
experiment = partial(Experiment.of, __name__)


def warm_up() -> None:
    """Compile the loop for the smallest class of networks; larger ones when they are met."""
    from innervate.networks.mesh.papers.testbed import MeshTestbed

    MeshTestbed(nodes=4, degree=3, duration_s=0.1).run(1)
