"""What the toolkit is told of RPL."""

from innervate import Network
from innervate.networks.places import DECLARED

NETWORK = Network(
    "rpl", __package__, medium="field", over="csma", rank=21, link_type=161, key_kind=21,
    **DECLARED, shows="shows:SHOWS", foreseen="foreseen:foreseen",
)  # fmt: skip
