"""What the toolkit is told of managed flooding."""

from innervate import Network

NETWORK = Network(
    "flooding",
    __package__,
    medium="field",
    over="csma",
    rank=20,
    link_type=160,
    key_kind=20,
    protocol="protocol.node",
    fields="protocol.fields",
    frames="frames",
    invariants="invariants",
    comparison="comparison",
    foreseen="foreseen:foreseen",
    template="template:template",
)
