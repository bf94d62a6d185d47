"""What the toolkit is told of Babel; the rest is as for any network over cables."""

from innervate.network import Network

NETWORK = Network(
    "babel",
    __package__,
    medium="cables",
    rank=10,
    link_type=151,
    key_kind=5,
    protocol="protocol.node",
    fields="protocol.fields",
    frames="frames",
    packets="packets:Packets",
    invariants="invariants",
    measures="measures:measures",
    comparison="comparison",
)
