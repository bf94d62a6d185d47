"""What `innervate verify mesh` does: messages, alarms and gateways, on a few nodes."""

from collections.abc import Iterator
from functools import partial
from typing import Any

from innervate.kernel.words import number_of
from innervate.networks.mesh.verify import cases, replay
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify.mutants import MUTANTS, hunt
from innervate.networks.mesh.verify.shape import FEW
from innervate.verify import cases as common
from innervate.verify.cases import Case, Explore, Tell
from innervate.verify.errors import VerifyError
from innervate.verify.tally import Tally

__all__ = ["MUTANTS", "hunt"]


def notice(options: Any) -> str:
    """What to say before the first: nothing is compiled."""
    return ""


def wanted_of(options: Any) -> cases.MeshWanted:
    """What the options of the command line ask for."""
    common.only("mesh", options, "rule", "graph", "budget", "walks")
    known = mesh_model.FAILOVERS
    rule = options.rule
    if rule and rule not in (*known, "all"):
        raise VerifyError(
            f'--rule is a failover for a mesh, {", ".join(known)} or all, not "{rule[:40]}"'
        )
    usual = cases.MeshWanted()
    links = () if options.graph == "all" else mesh_model.parse(options.graph)
    common.budget_of(options.budget, mesh_model.MeshBudget())  # says now what is wrong with it
    return cases.MeshWanted(
        failovers=usual.failovers if not rule else known if rule == "all" else (rule,),
        links=links,
        budget=options.budget,
        live=options.liveness,
        states=options.states,
        walks=options.walks,
        seed=options.seed or 1,
        memory=common.bytes_of(options.memory),
    )


def explorations(_network: Any, options: Any) -> Iterator[Explore]:
    """All that the options of the command line ask for."""
    wanted = wanted_of(options)
    return (partial(_explore, name, model, wanted) for name, model in cases.models(wanted))


def _explore(name: str, model: Any, wanted: cases.MeshWanted, tell: Tell) -> Case:
    def progress(name: str, tally: Tally) -> bool:
        what = f"{name}: {tally.states:,} states, {tally.depth} events deep"
        return tell(f"{what}, {tally.per_s / 1e3:.0f} k/s", 0, 0)

    case = cases.run(name, model, wanted, progress)
    return Case(
        lines=_lines(case),
        record=case.as_dict(),
        is_broken=case.story is not None,
        is_complete=case.found.tally.ended == "complete",
        but=_but(case),
        story=case.story,
        play=None if case.story is None else partial(replay.write, case.story),
        stem="mesh-counterexample",
    )


def _lines(case: cases.MeshCase) -> list[str]:
    """What came of one exploration."""
    found, tally = case.found, case.found.tally
    head = f"{cases.text_of(found.model.links):24} {found.model.failover:9} {case.name:12}"
    head += f"{common.many(tally)} {tally.wall_s:7.1f} s"
    return common.lines_of(head, case.story, partial(_extent, case))


def _but(case: cases.MeshCase) -> str:
    """What was not looked at in all that was; "" nothing."""
    found = case.found
    if found.tally.ended == "walked" or not found.wide:
        return ""
    return f"with one value for each node's draws out of more than {FEW}"


def _extent(case: cases.MeshCase) -> str:
    found, words = case.found, common.extent(case.found.tally)
    if _but(case):
        words += f", {_but(case)}"
    if not found.fair:
        return words
    part = "" if found.fair >= found.tally.states else f" from {found.fair:,} of them"
    if found.model.beats:
        return f"{words}; one gateway{part} after {found.longest / 1e6:.1f} s at most"
    return f"{words}; settled{part} in {number_of(found.longest, 'event')} at most"
