"""The options of `innervate new`, with what `--help` says of each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from cyclopts import Parameter

from innervate.cli.seeds import Whole


@dataclass(frozen=True)
class OwnOptions:
    """What a network of one's own is joined by.

    Parameters
    ----------
    on
        What a network of your own is joined by: cables (if left out), channel or field.
    over
        On a field: the medium access below it, csma; it sends by itself if left out.
    """

    on: str = "cables"
    over: str = ""


@dataclass(frozen=True)
class MeasuredOptions:
    """Which nodes and links of a measured network count.

    Parameters
    ----------
    network
        Of a measured mesh: a JSON file as community meshes publish it, lines "A B 0.9 0.7",
        freifunk/leipzig, or topohub:NAME.
    types
        Types of its links that count; wifi if left out, --empty-types for all.
    min_tq
        Worst quality of a link that counts, 0 to 1; if left out 0.3, or what leaves few enough.
    around
        A node as the file calls it: only those about it, nearest first, by their better links.
    nodes
        At most so many of them, 2 to 254; around the best connected node if none is named.
    gateways
        So many clusters of at most 254 nodes, each with a gateway and a channel of its own.
    """

    network: str | None = None
    types: Annotated[list[str] | None, Parameter(consume_multiple=True)] = None
    min_tq: float | None = None
    around: str | None = None
    nodes: Whole | None = None
    gateways: Whole | None = None

    @property
    def wanted(self) -> dict[str, Any]:
        """What was chosen of the network."""
        chosen = {"types": self.types, "min_tq": self.min_tq, "around": self.around,
                  "nodes": self.nodes, "gateways": self.gateways}  # fmt: skip
        return {key: value for key, value in chosen.items() if value is not None}
