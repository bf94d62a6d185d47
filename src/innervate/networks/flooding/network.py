"""What the toolkit is told of managed flooding."""

from innervate import Network
from innervate.networks.places import DECLARED

NETWORK = Network(
    "flooding", __package__, medium="field", over="csma", rank=20, link_type=160, key_kind=20,
    **DECLARED, foreseen="foreseen:foreseen", template="template:template",
)  # fmt: skip
