"""The radio's search can fail: copies of the protocol with a small mistake in each."""

from collections.abc import Iterator

from innervate.networks.radio.verify import grid as grid
from innervate.networks.radio.verify import tree as tree
from innervate.prove.mutants import Mutant, planted
from innervate.verify.cases import Catch

RUNS = 120

MUTANTS = planted(
    ("minislots that collided do not split",
     "station.slot = parts * groups + draw(station, parts)", "station.slot = parts * groups"),
    ("a collision's wait is not drawn", "wait + step * draw(station, bound // step)", "wait"),
    ("who was given a place does not note it",
     "                if i == mine and station.mode == modes.WINDOW:\n"
     "                    station.pos = place\n", ""),
    ("nothing is ever proved", "    if count:\n        delivered(station, count, out)\n",
     "    if count < 0:\n        delivered(station, count, out)\n"),
)  # fmt: skip


def trees() -> Iterator[tree.Tree]:
    """What each mutant is tried on, smallest first."""
    for stations, turnaround_us in ((2, 0), (3, 0), (3, 2000)):
        made = grid.Grid(stations, "practical", turnaround_us, offers_us=(0, 52))
        yield tree.Tree(made, depth=5)


def hunt(mutant: Mutant) -> Catch:
    """Try a mutant on all trees until something is broken."""
    (entry,) = mutant.copies("innervate.networks.radio.protocol.practical")
    runs = 0
    for one in trees():
        found = tree.search(one, entry, RUNS, lambda grown: bool(grown.broken))
        runs += found.runs
        if found.broken:
            where = f"{one.grid.stations} stations, turnaround {one.grid.turnaround_us} us"
            return Catch(mutant, grid.WORDS[min(found.broken)], where, runs)
    return Catch(mutant, "", "", runs)
