"""What the toolkit is told of Babel; the rest is as for any network over cables."""

from innervate.network import Network
from innervate.networks.places import DECLARED

NETWORK = Network(
    "babel", __package__, medium="cables", rank=10, link_type=151, key_kind=5,
    **DECLARED, packets="packets:Packets", measures="measures:measures",
)  # fmt: skip
