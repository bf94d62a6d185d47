"""A skin's headline: who has a way to the PC, who has none, and whether a cable could give one.

From plain facts, so that a finished run, a simulation under way and running nodes can all ask.
"""

from collections.abc import Callable, Collection
from typing import NamedTuple

from innervate.analysis.headline import (
    DEGRADED,
    DOWN,
    NO_DATA,
    OK,
    Headline,
    every,
    part_of,
    put_out,
    sentence,
    verb,
)
from innervate.analysis.words import share_words
from innervate.kernel.words import number_of

NAMED_MAX = 3


class SkinFacts(NamedTuple):
    """What is known of a skin at one moment; a cell is off, silent, cut_off, seeking or out."""

    cells: int  # how many there are; they are numbered 0 .. cells - 1
    off: Collection[int] = ()  # cells that are switched off
    # running nodes only: cells that do not answer, so that nothing is known of them
    silent: Collection[int] = ()
    # cells that are on, but that no live cable joins with the PC, over whatever way
    cut_off: Collection[int] = ()
    # cells that are on and that cables join with the PC, but that have no way to it
    seeking: Collection[int] = ()
    # those of `seeking` that have not had a way since they were first switched on
    never: Collection[int] = ()
    since_s: float | None = None  # when the first of `cut_off` was cut off; None = unknown
    at_once: bool = True  # all of them were cut off then
    pc_off: bool = False  # the PC is switched off, or does not answer
    out: Collection[int] = ()  # running nodes only: cells whose identities are revoked
    pc_out: bool = False  # running nodes only: the PC's identity is revoked
    # running nodes only: cells whose way goes on by nodes that do not run here, and is believed
    beyond: Collection[int] = ()
    served: int = 0  # running nodes only: cells whose ways end at the PC, as it says itself
    of_cells: int | None = None  # running nodes only: how many there are, if the PC's file says it
    # running nodes only: those of `seeking` that nodes alone could join with the PC that do not
    # run here
    afar: Collection[int] = ()
    # most cells that were cut off at the same time, if that is more than are now; a live
    # page, which shows the moment, leaves it at 0
    cut_off_before: int = 0
    sent: int = 0  # tactile samples that cells took; 0 without data
    lost: int = 0  # those of them that were lost
    early: int = 0  # those of the lost that were taken before their cell first had a way
    # cells, over all commands of the PC, that had a way and did not get one for them
    missed: int = 0


def skin_headline(facts: SkinFacts | None, label: Callable[[int], str] = str) -> Headline:
    """The state of a skin in a word and a sentence.

    ok: every cell has a way to the PC, and no sample or command was lost, but for samples of cells
    that had not had a way yet. down: no cell has a way. no data: no cell answers. degraded:
    everything between.

    Args:
        facts: what is known; None = nothing, as nobody watched.
        label: a cell's name, for sentences about few of them.
    """
    if facts is None:
        return Headline(NO_DATA, "Nobody watched who had a way to the PC.")
    if not facts.cells:
        return _pc_alone(facts.served, facts.of_cells)
    if len(facts.silent) == facts.cells:
        return Headline(NO_DATA, "No cell answers: nothing is known of the skin.")
    troubled = (*facts.cut_off, *facts.seeking, *facts.silent, *facts.off, *facts.out)
    with_way = 0 if facts.pc_off or facts.pc_out else facts.cells - len(troubled)
    said = [*_reasons(facts, label), *_before(facts), *_samples(facts), *_commands(facts)]
    ending = [_others(facts, with_way, bool(troubled))] * bool(with_way or not said)
    text = sentence([*said, *ending, *_beyond(facts, label)])
    level = DOWN if not with_way else DEGRADED if said else OK
    return Headline(level, text, tuple(sorted(map(int, troubled))))


def _pc_alone(served: int, cells: int | None) -> Headline:
    """Of a PC whose cells run elsewhere; a cell that moves can be counted twice for a moment."""
    if not served:
        return Headline(NO_DATA, "No cell runs here, and none has a way to the PC.")
    who = f"{number_of(served, 'cell')} {verb(served, 'has')}"
    if cells is not None and served < cells:
        who = f"{served:,} of {number_of(cells, 'cell')} {verb(served, 'has')}"
        return Headline(DEGRADED, f"{who} a way to the PC, as it says; none of them runs here.")
    return Headline(OK, f"{who} a way to the PC, as it says; none of them runs here.")


def _reasons(facts: SkinFacts, label: Callable[[int], str]) -> list[str]:
    """Why cells have no way, the worst reason first."""
    found = []
    if facts.pc_off:
        found.append("the PC is switched off: no cell has a way to it")
    elif facts.pc_out:
        found.append(put_out("the PC", 1))
    elif facts.cut_off:
        first = "" if facts.at_once else ", the first"
        since = "" if facts.since_s is None else f"{first} since {facts.since_s:.3f} s"
        who, them = _who(facts, facts.cut_off, label, "is"), _them(facts.cut_off)
        why = f"no cable joins {them} with the PC any more"
        found.append(f"{who} cut off{since}: {why}")
    if facts.out:
        found.append(put_out(_who(facts, facts.out, label), len(facts.out)))
    old = [cell for cell in facts.seeking if cell not in {*facts.never, *facts.afar}]
    if facts.never:
        none = len(facts.never) == facts.cells
        who = "no cell ever" if none else f"{_who(facts, facts.never, label)} never"
        found.append(f"{who} got a way to the PC")
    if old and not facts.pc_off:
        joined = "it with the PC" if _them(old) == "it" else "them with it"
        who = _who(facts, old, label, "has")
        found.append(f"{who} no way to the PC, although cables join {joined}")
    if facts.afar:
        who = _who(facts, facts.afar, label, "has")
        found.append(f"{who} no way to the PC, nor do nodes that do not run here give one")
    if facts.silent:
        found.append(f"{_who(facts, facts.silent, label, 'does')} not answer")
    if facts.off:
        found.append(f"{_who(facts, facts.off, label, 'is')} switched off")
    return found


def _who(
    facts: SkinFacts, nodes: Collection[int], label: Callable[[int], str], does: str = ""
) -> str:
    """Some cells in words, and a verb of theirs if wanted: "2 of 20 cells (n1, n2) are"."""
    does = f" {verb(len(nodes), does)}" if does else ""
    if len(nodes) == facts.cells:
        return f"{every(facts.cells, 'cell')}{does}"
    names = ", ".join(label(node) for node in sorted(nodes))
    shown = f" ({names})" if len(nodes) <= NAMED_MAX else ""
    return f"{len(nodes):,} of {facts.cells:,} cells{shown}{does}"


def _them(nodes: Collection[int]) -> str:
    return "it" if len(nodes) == 1 else "them"


def _before(facts: SkinFacts) -> list[str]:
    if not facts.cut_off_before:
        return []
    who = part_of(facts.cut_off_before, facts.cells, "cell")
    was = verb(facts.cut_off_before, "was")
    if facts.cut_off:  # of those some still are
        return [f"at the worst moment {who} {was} cut off"]
    return [f"{who} {was} cut off from the PC for a time"]


def _samples(facts: SkinFacts) -> list[str]:
    sent, lost = facts.sent - facts.early, facts.lost - facts.early
    if not lost:
        return []
    shown = share_words(lost / sent if sent else 1.0)
    return [f"{lost:,} of {sent:,} samples {verb(lost, 'was')} lost ({shown})"]


def _commands(facts: SkinFacts) -> list[str]:
    if not facts.missed:
        return []
    times = "once" if facts.missed == 1 else f"{facts.missed:,} times"
    return [f"commands did not reach cells that had a way, {times}"]


def _beyond(facts: SkinFacts, label: Callable[[int], str]) -> list[str]:
    if not facts.beyond:
        return []
    who = _who(facts, facts.beyond, label, "has")
    return [f"{who} it by nodes that do not run here, and what is said of that is believed"]


def _others(facts: SkinFacts, with_way: int, some: bool) -> str:
    """Those that have a way; nothing to say if there is none."""
    if not with_way:
        return ""
    if not some:
        kept = ", and no sample was lost" if facts.sent and facts.lost == facts.early else ""
        since = " after the start" if kept and facts.early else ""
        return f"every cell has a way to the PC{kept}{since}"
    return f"{'every' if with_way > 1 else 'the'} other cell has a way to the PC"
