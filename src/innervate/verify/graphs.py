"""Small graphs for the explorer of any network, by name or by their cables."""

from innervate.scenario.declared.shared import cabled
from innervate.topology import Graph, TopologyError
from innervate.verify.errors import VerifyError

GRAPHS = {
    "pair": "n0.E-n1.W n1.E-n0.W",
    "line": "n0.E-n1.W n1.E-n2.W",
    "ring": "n0.E-n1.W n1.E-n2.W n2.E-n0.W",
}


def graph_of(text: str) -> Graph:
    """The graph of a name, or of cables like "n0.E-n1.W n1-n2".

    Raises:
        VerifyError: no such cables, or no such name.
    """
    try:
        return cabled(GRAPHS.get(text, text))
    except TopologyError as error:
        names = ", ".join(GRAPHS)
        raise VerifyError(f"--graph: {error}; or one of {names}") from None
