"""What `innervate verify skin` does: which graphs, rules and updates, and what it says of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from typing import Any

from innervate.kernel import compilation
from innervate.kernel.stop import ends_at_once
from innervate.kernel.words import number_of
from innervate.networks.skin.verify import assumptions, fair, graphs, retrace, story
from innervate.networks.skin.verify import system as system
from innervate.networks.skin.verify.mutants import MUTANTS, hunt
from innervate.topology import Graph
from innervate.verify import cases as common
from innervate.verify import explore
from innervate.verify.cases import Case, Explore, Tell
from innervate.verify.errors import VerifyError
from innervate.verify.tally import Tally

__all__ = ["MUTANTS", "hunt"]

COMPILING = "compiling the explorer, once on this machine: about half a minute"
COMPILED = "explorer"
CELLS_MAX = 4
PLAYED = ("complete", "memory", "limit")  # ends of a search that a fair schedule goes on from
TICKS = {"ticks=any": ("ticks", system.ANY)}  # what else a budget may be


@dataclass(slots=True)
class SkinCase:
    """One exploration and what came of it."""

    model: system.SkinModel  # what is explored
    cables: str  # its graph as text
    tally: Tally  # how far the search came
    # the fair schedule; None where it was not asked for or something broke before
    fair: fair.Fair | None = None
    story: story.Story | None = None  # the counterexample, if something is broken

    @property
    def is_broken(self) -> bool:
        """True if a property does not hold."""
        return self.broken is not None

    @property
    def is_complete(self) -> bool:
        """True if every state was looked at, and none left out for want of room."""
        return self.tally.ended == "complete" and not self.left_out and (
            self.fair is None
            or (self.fair.ended == "complete" and self.fair.starts == self.fair.of)
        )  # fmt: skip

    @property
    def left_out(self) -> int:
        """Successors and rounds with more frames in flight than there is room for."""
        return self.tally.left_out + (self.fair.left_out if self.fair is not None else 0)

    @property
    def broken(self) -> str | None:
        """What does not hold, in one line."""
        if self.story is not None:
            return self.story.title
        return (self.fair.broken or None) if self.fair is not None else None

    def as_dict(self) -> dict[str, Any]:
        """The case as `innervate verify --json` prints it."""
        budget = asdict(self.model.budget)
        if budget["ticks"] == system.ANY:
            budget["ticks"] = "any"
        found = {
            "graph": self.cables,
            "rule": self.model.rule,
            "updates": self.model.updates,
            "budget": budget,
            **{name: getattr(self.tally, name) for name in ("states", "expanded", "generated")},
            "left_out": self.left_out,
            "depth": self.tally.depth,
            "wall_s": round(self.tally.wall_s, 3),
            "ended": self.tally.ended,
            "broken": self.broken,
            "story": self.story.sentences if self.story else None,
            "fair": None,
        }
        if self.fair is not None:
            names = ("bound", "rounds", "starts", "calm", "played", "ended")
            found["fair"] = {name: getattr(self.fair, name) for name in names}
        return found


Told = Callable[[str, Tally], bool]  # of a search by its name; true = stop


@dataclass(frozen=True, slots=True)
class Wanted:
    """What was asked for (see `innervate verify --help`)."""

    rules: tuple[str, ...] = ("feasible",)
    updates: tuple[str, ...] = system.UPDATES
    graphs: tuple[Graph, ...] = ()
    budget: system.Budget = field(default_factory=system.Budget)
    prompt: bool = False
    live: bool = True
    starts: int = 0
    walks: int = 0
    seed: int = 1
    states: int = 0
    memory: int = explore.MEMORY
    plain: bool = False
    lean: bool = True


def graphs_of(text: str, cells: int) -> tuple[Graph, ...]:
    """The graphs that --graph and --cells mean: "all" of up to so many cells, or one by name.

    Raises:
        VerifyError: there is no such graph, or the cells are too many.
    """
    if text != "all":
        return (graphs.parse(text),)
    if not 1 <= cells <= CELLS_MAX:
        raise VerifyError(f"--cells must be 1 to {CELLS_MAX}, not {cells}")
    return tuple(graph for count in range(1, cells + 1) for graph in graphs.all_graphs(count))


def notice(options: Any) -> str:
    """What to say before the first."""
    return "" if options.plain or compilation.is_compiled(COMPILED) else COMPILING


def explorations(_network: Any, options: Any) -> Iterator[Explore]:
    """All that the options of the command line ask for."""
    wanted = Wanted(
        rules=common.choices("rule", options.rule or "feasible", system.RULES),
        updates=common.choices("updates", options.updates, system.UPDATES),
        graphs=graphs_of(options.graph, options.cells or 2),
        budget=common.budget_of(options.budget, system.Budget(), TICKS),
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
    asked = enumerate(models(wanted))
    return (partial(_case, model, wanted, number == 0) for number, model in asked)


def models(wanted: Wanted) -> Iterator[system.SkinModel]:
    """Everything that is asked for, in order.

    Raises:
        VerifyError: things that do not go together.
    """
    if wanted.budget.ticks == system.ANY and (wanted.prompt or not wanted.lean):
        raise VerifyError("ticks=any goes neither with --no-reduce nor with --prompt")
    for graph in wanted.graphs:
        for rule in wanted.rules:
            for updates in wanted.updates:
                yield system.SkinModel(
                    graph, rule, updates, wanted.budget, prompt=wanted.prompt,
                    keep=wanted.live and rule == "feasible", lean=wanted.lean,
                )  # fmt: skip


def run(model: system.SkinModel, wanted: Wanted, tell: Told) -> SkinCase:
    """Explore one model; then, under the recommended rule, play the fair schedule.

    Raises:
        VerifyError: the protocol does not keep what the reductions rest on.
    """
    with ends_at_once():
        taken = assumptions.broken(model) if model.lean else ""
    if taken:
        raise VerifyError(f"{taken}; --no-reduce explores it without resting on the rule")
    cables = graphs.cables(model.graph)
    name = f"{cables}, {model.rule}, {model.updates}"
    if wanted.walks:
        found = explore.wander(
            model, wanted.walks, seed=wanted.seed, plain=wanted.plain,
            progress=lambda tally: tell(name, tally),
        )  # fmt: skip
    else:
        found = _explore(model, wanted, name, tell)
    case = SkinCase(model, cables, found.tally, story=_tell(found, wanted, name, tell))
    plays = wanted.live and not wanted.walks and model.rule == "feasible"
    if plays and found.tally.ended in PLAYED:
        case.fair = _settle(found, wanted, name, tell)
        if case.fair.ended == "broken" and model.lean:
            case.fair = _settle_whole(case.fair, found, wanted, name, tell)
    return case


def _tell(found: explore.Result, wanted: Wanted, name: str, tell: Told) -> story.Story | None:
    """The story, told of states with all that is in them; of a search the shortest one."""
    if not found.broken:
        return None
    whole = retrace.retrace(found) if found.model.lean else found
    if not wanted.walks and (whole is None or len(whole.path) > len(found.path)):
        shorter = _explore(_whole(found), wanted, name, tell)
        whole = shorter if shorter.broken else whole
    return story.tell(whole) if whole is not None else story.in_short(found)


def _settle_whole(
    broken: fair.Fair, found: explore.Result, wanted: Wanted, name: str, tell: Told
) -> fair.Fair:
    """What the unreduced search says of a schedule that ends badly: a reduced one starts from
    more than can happen. Unless it says all there is to say, the finding stands.
    """
    whole = _explore(_whole(found), wanted, name, tell)
    again = _settle(whole, wanted, name, tell)
    is_all = (
        whole.model.budget == found.model.budget
        and whole.tally.ended == again.ended == "complete"
        and again.starts == again.of
        and whole.tally.left_out + again.left_out == 0
    )
    return again if again.ended == "broken" or is_all else broken


def _settle(found: explore.Result, wanted: Wanted, name: str, tell: Told) -> fair.Fair:
    return fair.check(
        found, plain=wanted.plain, starts=wanted.starts, memory=wanted.memory,
        progress=lambda _: tell(f"{name}: the fair schedule", found.tally),
    )  # fmt: skip


def _whole(found: explore.Result) -> system.SkinModel:
    """The same with nothing forgotten, and no more ticks than it took."""
    model = found.model
    ticks = min(model.budget.ticks, found.tally.depth + 1)
    return model.changed(lean=False, budget=replace(model.budget, ticks=ticks))


def _explore(model: system.SkinModel, wanted: Wanted, name: str, tell: Told) -> explore.Result:
    return explore.explore(
        model, plain=wanted.plain, memory=wanted.memory, states=wanted.states,
        progress=lambda tally: tell(name, tally),
    )  # fmt: skip


def _case(model: Any, wanted: Wanted, first: bool, tell: Tell) -> Case:
    def progress(name: str, tally: Tally) -> bool:
        what = f"{name}: {tally.states:,} states, {tally.depth} events deep"
        return tell(f"{what}, {tally.per_s / 1e6:.2f} M/s", 0, 0)

    case = run(model, wanted, progress)
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


def _lines(case: SkinCase) -> list[str]:
    """What came of one exploration."""
    tally = case.tally
    name = f"{case.cables:32} {case.model.rule:9} {case.model.updates:10}"
    much = f" {common.many(tally, 2)} {tally.wall_s:7.1f} s"
    lines = common.lines_of(f"{name}{much}", case.story, partial(_extent, case))
    if case.story is None and case.broken:
        lines.append(f"    BROKEN: {case.broken}")
    return lines


def _extent(case: SkinCase) -> str:
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
