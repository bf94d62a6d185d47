"""What `innervate verify skin` does: which explorations, and what it says of them."""

from collections.abc import Iterator
from functools import partial
from typing import Any

from innervate.kernel import compilation
from innervate.kernel.words import number_of
from innervate.networks.skin.verify import assumptions, cases
from innervate.networks.skin.verify.mutants import MUTANTS, hunt
from innervate.verify import cases as common
from innervate.verify.cases import Case, Explore, Tell
from innervate.verify.tally import Tally

__all__ = ["MUTANTS", "hunt"]

COMPILING = "compiling the explorer, once on this machine: about half a minute"
COMPILED = "explorer"


def notice(options: Any) -> str:
    """What to say before the first."""
    return "" if options.plain or compilation.is_compiled(COMPILED) else COMPILING


def explorations(_network: Any, options: Any) -> Iterator[Explore]:
    """All that the options of the command line ask for."""
    wanted = cases.Wanted(
        rules=common.choices("rule", options.rule or "feasible", cases.RULES),
        updates=common.choices("updates", options.updates, cases.UPDATES),
        graphs=cases.graphs_of(options.graph, options.cells or 2),
        budget=cases.budget_of(options.budget),
        prompt=options.prompt,
        live=options.liveness,
        starts=options.starts,
        walks=options.walks,
        seed=options.seed or 1,
        states=options.states,
        memory=common.bytes_of(options.memory),
        plain=options.plain,
        lean=options.reduce,
    )
    models = enumerate(cases.models(wanted))
    return (partial(_explore, model, wanted, number == 0) for number, model in models)


def _explore(model: Any, wanted: cases.Wanted, first: bool, tell: Tell) -> Case:
    def progress(name: str, tally: Tally) -> bool:
        what = f"{name}: {tally.states:,} states, {tally.depth} events deep"
        return tell(f"{what}, {tally.per_s / 1e6:.2f} M/s", 0, 0)

    case = cases.run(model, wanted, progress)
    if not wanted.plain:
        compilation.mark_compiled(COMPILED)
    lines, words = _lines(case), assumptions.told(model)
    if first and words:
        lines.append(words)
    return Case(
        lines=lines,
        record=case.as_dict() | {"reductions": assumptions.grounds(model)},
        is_broken=case.is_broken,
        is_complete=case.is_complete,
        story=case.story,
    )


def _lines(case: cases.SkinCase) -> list[str]:
    """What came of one exploration."""
    tally = case.tally
    name = f"{case.cables:32} {case.model.rule:9} {case.model.updates:10}"
    much = f" {common.many(tally, 2)} {tally.wall_s:7.1f} s"
    lines = common.lines_of(f"{name}{much}", case.story, partial(_extent, case))
    if case.story is None and case.broken:
        lines.append(f"    BROKEN: {case.broken}")
    return lines


def _extent(case: cases.SkinCase) -> str:
    words = common.extent(case.tally)
    if case.left_out:
        words += f" but {number_of(case.left_out, 'successor')} with too many frames in flight"
    if case.fair is None:
        return words
    part = "" if case.fair.starts == case.fair.of else f" from {case.fair.starts:,} of them"
    if case.fair.ended != "complete":
        rounds = number_of(case.fair.rounds, "round")
        return f"{words}; fair schedule{part}: {case.fair.ended} after {rounds}"
    return f"{words}; settled{part} in {case.fair.rounds} of {number_of(case.fair.bound, 'round')}"
