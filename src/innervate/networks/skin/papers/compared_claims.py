"""What is claimed of the skin beside others at its job, and why where it does not hold."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

from innervate.papers.experiment import Claim, verdict
from innervate.papers.jobs import Case, Compared, Words, entries

OURS, FAST = "skin, feasible", "skin, feasible, k = 2"
STATIC, RFC, SAME = "static trees", "Babel, 2 of 3", "Babel, 1 of k"
SLOW_TO_FIND = (
    "measured, in the column found: a port is broken after k = 5 missing beacons, and Babel's link "
    "is down when two of three are missing; the next two lines compare what is left when both find "
    "a failure as soon"
)
NOTHING_TO_DO = (
    "a reading: where another port is at hand both take it at once, and finding out is all there is"
)
LISTENS = (
    "measured, with k = 2 it starts sooner: the PC of a skin listens for k periods before it says "
    "anything, as it may have restarted"
)
WAVES = (
    "measured, with periodic updates it sends no more than Babel: every new sequence number goes "
    "out as a wave at once, and comes a little before the period"
)
NO_TIES = (
    "a reading: the wiring of this skin leaves few cells that have ports of two subnetworks as near"
)


def judge(compared: Compared) -> Iterator[Claim]:
    """Setup by setup, with and without loss."""
    for place, group in groupby(compared.cases(), lambda case: case.title.partition(":")[0]):
        cases = {case.given["harm"]: case for case in group}
        calm = {"": cases.pop("none")}
        yield from _recovery(compared, place, cases)
        yield from _calm(compared, place, calm)
    yield _loops(compared)


def _recovery(compared: Compared, place: str, cases: dict[str, Case]) -> Iterator[Claim]:
    known = {one.name: one for one in entries(compared.job.name)}
    for ours, other, words, why in (
        (OURS, RFC, "at the same beacon rate, with k = 5,", SLOW_TO_FIND),
        (FAST, RFC, "at the same beacon rate, with k = 2,", NOTHING_TO_DO),
        (OURS, SAME, "with the same time to find a failure", NOTHING_TO_DO),
        (OURS, STATIC, "with the same time to find a failure", ""),
    ):
        claim = f'{place}: {words} all cells of "{ours}" have a way again sooner than of "{other}"'
        yield compared.less(cases, "routed_ms", (known[ours], known[other]), Words(claim, why))


def _calm(compared: Compared, place: str, calm: dict[str, Case]) -> Iterator[Claim]:
    known = {one.name: one for one in entries(compared.job.name)}
    for name, words, why, digits in (
        ("start_ms", "starts up sooner", LISTENS, 1),
        ("bits_per_s", "sends less control", WAVES, 0),
        ("largest_share", "loads the busiest port less", NO_TIES, 2),
    ):
        claim = f'{place}: "{OURS}" {words} than "{RFC}"'
        pair = known[OURS], known[RFC]
        yield compared.less(calm, name, pair, Words(claim, why, digits))


def _loops(compared: Compared) -> Claim:
    found = {
        entry.name: sum(sum(compared.values(case, entry, "loops")) for case in compared.cases())
        for entry in entries(compared.job.name)
    }
    runs = sum(len(case.seeds) for case in compared.cases())
    said = ", ".join(f"{name} {count:.0f}" for name, count in found.items())
    return Claim(
        compared.job.name, "no forwarding loop in any run of any of them",
        f"{said}; in {runs} runs each", verdict(not any(found.values())),
    )  # fmt: skip
