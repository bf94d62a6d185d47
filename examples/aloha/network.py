"""What the toolkit is told of aloha; whatever is not said here is as for any network."""

from innervate import Network

NETWORK = Network(
    "aloha",
    __package__,
    medium="channel",
    link_type=162,  # of its frames in captures: 147 to 162, which are free for everybody
    key_kind=255,  # its number under a seal, 1 to 255: different for networks that share keys
    protocol="protocol",
    fields="fields",
    frames="frames",
    invariants="invariants",
)
