"""The document's sentences that claims quote, word by word; every other claim is one of ours."""

from functools import partial
from typing import NamedTuple

from innervate.papers.experiment import OURS, Claim, quoted


class Sentence(NamedTuple):
    """A sentence of the document, or a part of one: where it stands, and word by word."""

    section: str
    words: str


ANY_TWO = Sentence("1", "Our network supports routed messages between any two nodes.")
SMALL = Sentence("1", "This is not scalable, but sufficient for small networks.")
RESPONDS = Sentence(
    "1.1",
    "responds to the request by sending a response packet to the node from which the request came",
)
LATENCY = Sentence(
    "2.1", "Our design is optimized for low latency thanks to the routing by next hop tables"
)
SHORTEST = Sentence(
    "2.1",
    "next hop tables, which contain the next hop calculating according to the shortest path to "
    "destination by hop count",
)
MUST = Sentence(
    "2.2",
    "the fence crossing event delivery must happen even if some intermediate nodes malfunctioned",
)
RELIABLE = Sentence(
    "2.2",
    "Our design is optimized for reliability by having the routed packets acknowledged and by "
    "having nodes update their routing tables when an acknowledgement does not arrive in time.",
)
REPLACED = Sentence(
    "2.2",
    "if a node X dies, the nodes which list X as the next hop in their routing tables, will "
    "replace it automatically",
)
SENTENCES = (ANY_TWO, SMALL, RESPONDS, LATENCY, SHORTEST, MUST, RELIABLE, REPLACED)


def said(sentence: Sentence, claim: str, measurement: str, verdict: str, reason: str = "") -> Claim:
    """A claim of the document: its sentence, and in our words what was held against it."""
    source = quoted(sentence.section, sentence.words)
    return Claim(sentence.section, claim, measurement, verdict, reason, source)


def ours(figure: str, claim: str, measurement: str, verdict: str, reason: str = "") -> Claim:
    """A claim of ours, which the document does not make; beside a section, "beyond" or "asked"."""
    return Claim(figure, claim, measurement, verdict, reason, OURS)


beyond = partial(ours, "beyond")
