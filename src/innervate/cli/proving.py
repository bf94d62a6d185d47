"""`innervate prove`: what holds of a protocol for any number of nodes, and what does not."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from innervate.cli import errors
from innervate.cli.options import Flag, Json
from innervate.cli.progress import Display
from innervate.cli.verifying import hunted, named
from innervate.kernel.stop import Stop
from innervate.kernel.words import number_of
from innervate.network import Network, first

if TYPE_CHECKING:
    from innervate.prove.mutants import Mutant
    from innervate.prove.theory import Outcome


def prove(system: str | None = None, /, *, faults: Flag = False, as_json: Json = False) -> int:
    """Prove a network's theories; 1 if one does not come out as it should.

    Args:
        system: Which protocol: skin (if left out), radio, mesh, or one of your own, by its folder.
        faults: Plant small mistakes in the protocol, one after the other: each must be refuted.
        as_json: Print the results as JSON and nothing else.
    """
    network = named(first() if system is None else system, "prove knows")
    if faults:
        return _faults(network, as_json)
    return _theories(network, as_json)


def _theories(network: Network, as_json: bool) -> int:
    from innervate.prove.theory import prove as attempt

    done: list[Outcome] = []
    theories = network.prove.theories(network)
    with Display(as_json) as display, Stop() as stop:

        def tell(what: str, part: int, of: int) -> bool:
            display.show(what, part, of, None)
            return stop.asked

        for theory in theories:
            done.append(attempt(theory, tell))
            if not as_json:
                print("\n".join([*lines(done[-1]), ""]), flush=True)
            stop.asked = stop.asked or done[-1].ended == "stopped"
            if stop.asked:
                break
    if as_json:
        print(json.dumps([outcome.as_dict() for outcome in done], indent=2))
    else:
        print(_verdict(done, len(theories)))
    if stop.asked:
        return errors.INTERRUPTED
    return 0 if all(outcome.is_as_expected for outcome in done) else 1


def lines(outcome: Outcome) -> list[str]:
    """What came of a theory, for people."""
    theory = outcome.theory
    told = [f"{theory.name}: {theory.claim}"]
    told += [f"  assumed: {one}" for one in theory.assumed]
    for one in outcome.checked:
        count = number_of(len(one.goals), "lemma")
        held = f"{len(one.refuted)} REFUTED" if one.refuted else "hold"
        told.append(f"  {one.name:52} {count:>10} {held:10} {one.wall_s:6.2f} s")
        for bad in one.refuted:
            told.append(f"    {bad.goal}")
            told += [f"      {sentence}" for sentence in bad.sentences]
    told += [f"  NOT REACHED: {_way(way)}" for way in outcome.unreached]
    told.append(f"  {_summary(outcome)}")
    return told


def _way(way: tuple[str, int, bool]) -> str:
    return f"{way[0]}, line {way[1]}, {'taken' if way[2] else 'not taken'}"


def _summary(outcome: Outcome) -> str:
    if outcome.theory.refuted_by:
        return "Refuted, as it must be." if outcome.is_as_expected else "NOT REFUTED."
    if outcome.ended != "complete":
        return "Stopped."
    if outcome.is_refuted:
        return "Does NOT hold."
    branches = {way for one in outcome.checked for way in one.reached}
    words = f"Holds: {number_of(outcome.lemmas, 'lemma')}"
    if branches:
        words += f"; {number_of(len(branches), 'way')} of branches reached"
    if outcome.named:
        words += f", {len(outcome.named)} cannot be, as said"
    return f"{words}." if not outcome.unreached else f"{words}; some are not."


def _verdict(done: list[Outcome], asked: int) -> str:
    """The last line: what came of all theories that were asked for, as far as they were tried."""
    bad = [one for one in done if not one.is_as_expected and one.ended == "complete"]
    tried = [one for one in done if one.is_as_expected or one.ended == "complete"]
    lemmas = sum(outcome.lemmas for outcome in done)
    wall_s = sum(one.wall_s for outcome in done for one in outcome.checked)
    much = f"{number_of(lemmas, 'lemma')} in {wall_s:.1f} s"
    all_ = "theory" if asked == 1 else "theories"
    cut = "" if len(tried) == asked else f"; interrupted after {len(tried)} of {asked} {all_}"
    if bad:
        names = ", ".join(outcome.theory.name for outcome in bad)
        return f"NOT as it should be: {names} ({much}){cut}."
    return f"As it should be so far: {much}{cut}." if cut else f"All as it should be: {much}."


def _faults(network: Network, as_json: bool) -> int:
    """Plant every mistake; 1 if one is not refuted."""
    from innervate.prove.faults import faults_of, hunt

    def refuted(fault: Mutant) -> tuple[dict[str, str], str]:
        step, goal = hunt(network, fault)
        return {"fault": fault.name, "step": step, "refuted": goal}, goal and f"{goal} ({step})"

    planted = [(fault, refuted) for fault in faults_of(network)]
    return hunted(network.name, planted, as_json, "NOT REFUTED")
