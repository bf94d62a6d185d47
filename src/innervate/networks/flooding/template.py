"""A scenario of managed flooding to start from: without an input nobody would send anything."""

from typing import Any

from innervate.scenario.declared import field

SENDS = """
[[input]]  # to node 8, at the other corner; to all: dest = 255
at_s = 0.1
every_s = 0.2
node = 0
item = { dest = 8, body = [1, 2, 3, 4, 5, 6, 7, 8] }
"""


def template(network: Any) -> str:
    """All keys, and a message from corner to corner."""
    return field.template(network) + SENDS
