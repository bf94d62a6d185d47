"""What the toolkit is told of RPL."""

from innervate import Network

NETWORK = Network(
    "rpl",
    __package__,
    medium="field",
    over="csma",
    rank=21,
    link_type=161,
    key_kind=21,
    protocol="protocol.node",
    fields="protocol.fields",
    frames="frames",
    invariants="invariants",
    comparison="comparison",
    shows="shows:SHOWS",
    foreseen="foreseen:foreseen",
)
