"""Jobs over cables: nodes that all want to reach one, and what becomes of it when cables fail.

What a case gives: `cables`, pairs of ends like ["pc.0", "c3.2"]; `beacon_us`; `k`, how many beacons
a link may miss; `loss`; `harm`, "none", "cut", "four cuts" or "death"; `settle`, `watch`, periods.
Whoever does the job builds its own scenario of it, runs it with the moment and the cables of
`drawn`, and hands `measured` what its nodes said.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from innervate.analysis import parents
from innervate.analysis.parents import Cable, Change, Harm, Ways
from innervate.papers.errors import PapersError
from innervate.trace.streams import Stream, stream

Given = Mapping[str, Any]
SINK = "pc"
FRAME_BITS = 240  # on the wire, with framing and gap, whatever stands in it
CALM = 5  # periods that everybody has a way: then the outage is over
NEAR = 2  # hops from the sink: whose death is looked at
DRAWS = 1000  # until harm is found that leaves the others joined
CUTS = {"none": 0, "cut": 1, "four cuts": 4, "death": 0}


@dataclass(frozen=True, slots=True)
class Wiring:
    """Nodes by name, the sink as number 0, and their cables."""

    names: tuple[str, ...]
    cables: tuple[Cable, ...]

    @property
    def number(self) -> dict[str, int]:
        """A node's number by its name."""
        return {name: number for number, name in enumerate(self.names)}


@cache
def _wiring(pairs: tuple[tuple[str, str], ...]) -> Wiring:
    ends = [tuple(end.rpartition(".")[::2] for end in pair) for pair in pairs]
    names = dict.fromkeys([SINK, *(name for pair in ends for name, _ in pair)])
    number = {name: place for place, name in enumerate(names)}
    cables = tuple((number[a], int(p), number[b], int(q)) for (a, p), (b, q) in ends)
    return Wiring(tuple(names), cables)


def wiring(given: Given) -> Wiring:
    """The nodes and cables of a case."""
    return _wiring(tuple(tuple(pair) for pair in given["cables"]))


def drawn(given: Given, seed: int) -> Harm:
    """What happens in the run of a seed, and when: the same for all who do the job.

    `cut`: the cable of a port of the sink. `four cuts`: that and three others. `death`: a node two
    hops from the sink. Whoever is left stays joined with the sink by cables.
    """
    draw, made = stream(seed, "harm"), wiring(given)
    beat = given["beacon_us"]
    at = given["settle"] * beat + draw.draw(5 * beat)
    own = [place for place, cable in enumerate(made.cables) if 0 in (cable[0], cable[2])]
    if given["harm"] == "none":
        return Harm(at)
    for _ in range(DRAWS):
        harm = _one(given["harm"], made, own, draw, at)
        ways = Ways(len(made.names), 0, made.cables).play((), [harm])
        if ways.steps[-1][1] == len(made.names) - 1 - len(harm.nodes):
            return harm
    raise PapersError(f"no {given['harm']} leaves all others joined with the sink by cables")


def _one(what: str, made: Wiring, own: list[int], draw: Stream, at: int) -> Harm:
    if what == "death":
        near = _near(made)
        return Harm(at, nodes=(near[draw.draw(len(near))],))
    cables = [own[draw.draw(len(own))]]
    while len(cables) < CUTS[what]:
        place = draw.draw(len(made.cables))
        if place not in cables:
            cables.append(place)
    return Harm(at, tuple(cables))


def _near(made: Wiring) -> list[int]:
    """Nodes that are NEAR hops from the sink."""
    hops = {0: 0}
    for far in range(1, NEAR + 1):
        ring = {b for a, _, b, _ in made.cables if hops.get(a) == far - 1}
        ring |= {a for a, _, b, _ in made.cables if hops.get(b) == far - 1}
        hops |= {node: far for node in ring if node not in hops}
    return [node for node, far in hops.items() if far == NEAR]


def end_us(given: Given, harm: Harm) -> int:
    """When the run of a case ends."""
    return int(harm.at_us + given["watch"] * given["beacon_us"])


def measured(
    given: Given, harm: Harm, changes: Iterable[Change], downs: Iterable[int], sent: int
) -> dict[str, Any]:
    """What a run of a case gave.

    `changes` of next hops are in order of time; `downs`, us, is when nodes found some link down;
    `sent` counts all frames of control.
    """
    made = wiring(given)
    changes = list(changes)
    end = end_us(given, harm)
    ways = Ways(len(made.names), 0, made.cables)
    ways.play(change for change in changes if change[0] < harm.at_us)
    share = _largest_share(ways)
    ways.play((change for change in changes if change[0] >= harm.at_us), [harm])
    calm = CALM * given["beacon_us"]
    start = parents.settled_us(ways.steps, 0, harm.at_us, calm)
    routed = parents.settled_us(ways.steps, harm.at_us, end, calm)
    found = [at for at in downs if at > harm.at_us]
    return {
        "start_ms": None if start is None else start / 1e3,
        "detected_ms": (min(found) - harm.at_us) / 1e3 if found else None,
        "routed_ms": None if routed is None else (routed - harm.at_us) / 1e3,
        "without": parents.most_without(ways.steps, harm.at_us, end),
        "without_s": parents.time_without_us(ways.steps, harm.at_us, end) / 1e6,
        "loops": len(ways.loops),
        "bits_per_s": sent * FRAME_BITS / len(made.cables) / (end / 1e6),
        "largest_share": share,
    }


def _largest_share(ways: Ways) -> float | None:
    """Share of the nodes whose way goes through the sink's busiest port, of those with a way."""
    roots = [root for node, root in enumerate(ways.roots()) if node and root != parents.NOWHERE]
    return max(map(roots.count, set(roots))) / len(roots) if roots else None
