"""What the toolkit is told of a token ring: no more than it has to be."""

from innervate.network import Network

NETWORK = Network(
    "tokenring", __package__, link_type=150, key_kind=4, rank=9,
    model="scenario:RingScenario", check="scenario:check", plan="scenario:plan",
    protocol="protocol", fields="fields", frames="frames",
)  # fmt: skip
