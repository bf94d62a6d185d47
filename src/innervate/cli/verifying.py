"""`innervate verify`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from innervate.cli import errors
from innervate.cli.progress import Display

if TYPE_CHECKING:
    from collections.abc import Callable

    from innervate.cli.verify_options import VerifyOptions
    from innervate.verify.cases import Case, Wanted

COMPILING = "compiling the explorer, once on this machine: about half a minute"


def skin(wanted: Wanted, as_json: bool, out: Path | None) -> int:
    """Explore what is wanted; 1 if something is broken."""
    from innervate.kernel import door
    from innervate.kernel.stop import Stop
    from innervate.verify import cases

    done: list[Case] = []
    with Display(as_json) as display, Stop() as stop:
        if not wanted.plain and not door.is_compiled("explorer"):
            display.begin(COMPILING, line=True)

        def tell(name: str, tally: Any) -> bool:
            what = f"{name}: {tally.states:,} states, {tally.depth} events deep"
            display.show(f"{what}, {tally.per_s / 1e6:.2f} M/s", 0, 1 << 40, None)
            return stop.asked

        for model in cases.models(wanted):
            done.append(cases.run(model, wanted, tell))
            if not wanted.plain:
                door.mark_compiled("explorer")
            if not as_json:
                for line in case_lines(done[-1]):
                    print(line, flush=True)
            if done[-1].story is not None and out is not None:
                _write(done[-1], out, len(done), as_json)
            if stop.asked:
                break
    if as_json:
        print(json.dumps([case.as_dict() for case in done], indent=2))
    else:
        print(_verdict(done))
    if stop.asked:
        return errors.INTERRUPTED
    return 1 if any(case.is_broken for case in done) else 0


def case_lines(case: Case) -> list[str]:
    """What came of one exploration."""
    tally = case.tally
    name = f"{case.cables:32} {case.model.rule:9} {case.model.updates:10}"
    unit = "walks " if tally.ended == "walked" else "states"
    much = f"{tally.states:>11,} {unit} {tally.generated:>12,} successors {tally.wall_s:7.1f} s"
    if case.story is not None:
        head = f"{name}{much}  BROKEN after {len(case.story.sentences)} events"
        return [head, *(f"    {line}" for line in case.story.lines())]
    lines = [f"{name}{much}  {_extent(case)}"]
    if case.fair is not None and case.fair.ended == "broken":
        lines.append(f"    BROKEN: routes are not shortest after {case.fair.bound} fair rounds")
    return lines


def _extent(case: Case) -> str:
    tally = case.tally
    words = {
        "complete": "all states",
        "memory": f"first {tally.expanded:,} states, to {tally.depth} events: memory is full",
        "limit": f"first {tally.expanded:,} states, to {tally.depth} events, as asked",
        "interrupted": f"first {tally.expanded:,} states, to {tally.depth} events: interrupted",
        "walked": "a sample of random walks",
    }[tally.ended]
    if tally.left_out:
        words += f" but {tally.left_out:,} successors with too many frames in flight"
    if case.fair is None:
        return words
    part = "" if case.fair.starts == case.fair.of else f" from {case.fair.starts:,} of them"
    if case.fair.ended != "complete":
        return f"{words}; fair schedule{part}: {case.fair.ended} after {case.fair.rounds} rounds"
    return f"{words}; settled{part} in {case.fair.rounds} of {case.fair.bound} rounds"


def _verdict(done: list[Case]) -> str:
    """The last line."""
    broken = sum(case.is_broken for case in done)
    part = sum(not case.is_complete and not case.is_broken for case in done)
    if broken:
        return f"{broken} of {len(done)} broken."
    sampled = f"; {part} of them only in part" if part else ", all completely"
    return f"Nothing broken in {len(done)} explorations{sampled}."


def _write(case: Case, out: Path, number: int, quiet: bool) -> None:
    """Scenario, story and picture of a counterexample."""
    from innervate.plot import counterexample

    assert case.story is not None
    out.mkdir(parents=True, exist_ok=True)
    stem = out / f"counterexample-{number}"
    stem.with_suffix(".toml").write_text(case.story.scenario, encoding="utf-8")
    stem.with_suffix(".txt").write_text("\n".join([*case.story.lines(), ""]), encoding="utf-8")
    counterexample.save(case.story, stem.with_suffix(".svg"))
    if not quiet:
        print(f"    Written: {stem}.toml (innervate run plays it), .txt, .svg")


def verify(system: str, options: VerifyOptions, as_json: bool, out: Path | None) -> int:
    """Explore a protocol with the options of the command line."""
    if system not in ("skin", "radio", "mesh"):
        raise errors.UserError(f'verify explores skin, radio or mesh, not "{system[:40]}"')
    for name in ("cells", "starts", "states", "walks", "count"):
        if getattr(options, name) < 0:
            raise errors.UserError(f"--{name} must be 0 or more, not {getattr(options, name)}")
    if options.random:
        from innervate.cli import verifying_random

        return verifying_random.search(options.seed, options.count, as_json, out)
    if options.mutants:
        return _mutants(system, as_json)
    if system == "radio":
        from innervate.cli import verifying_radio

        return verifying_radio.search(options, as_json)
    if system == "mesh":
        from innervate.cli import verifying_mesh

        wanted_mesh = verifying_mesh.wanted_of(options, _bytes(options.memory))
        return verifying_mesh.search(wanted_mesh, as_json, out)
    from innervate.verify import cases

    wanted = cases.Wanted(
        rules=_choices("rule", options.rule or "feasible", cases.RULES),
        updates=_choices("updates", options.updates, cases.UPDATES),
        graphs=cases.graphs_of(options.graph, options.cells or 2),
        budget=cases.budget_of(options.budget),
        prompt=options.prompt,
        live=options.liveness,
        starts=options.starts,
        walks=options.walks,
        seed=options.seed or 1,
        states=options.states,
        memory=_bytes(options.memory),
        plain=options.plain,
        lean=options.reduce,
    )
    return skin(wanted, as_json, out)


def _hunts(system: str) -> list[tuple[Any, Callable[[Any], Any]]]:
    """All mutants of a protocol, or of all three where none was named, and what hunts each."""
    from innervate.running import radio_mutants
    from innervate.verify import mesh_mutants, mutants

    rooms = {"skin": mutants, "mesh": mesh_mutants, "radio": radio_mutants}
    wanted = rooms if system == "skin" else {system: rooms[system]}
    return [(mutant, room.hunt) for room in wanted.values() for mutant in room.MUTANTS]


def _mutants(system: str, as_json: bool) -> int:
    """Try the explorer on copies of the protocol with a mistake in each; 1 if one is missed."""
    from innervate.kernel.stop import Stop

    caught, hunts = [], _hunts(system)
    with Stop() as stop, Display(as_json) as display:
        for number, (mutant, hunt) in enumerate(hunts):
            display.show(mutant.name, number, len(hunts), None)
            caught.append(hunt(mutant))
            if not as_json:
                by = f"{caught[-1].by} ({caught[-1].where})" if caught[-1].by else "NOT CAUGHT"
                print(f"{mutant.name}: {by}", flush=True)
            if stop.asked:
                return errors.INTERRUPTED
    if as_json:
        rows = [{"mutant": c.mutant.name, "by": c.by, "where": c.where} for c in caught]
        print(json.dumps(rows, indent=2))
    return 0 if all(catch.by for catch in caught) else 1


def _choices(name: str, text: str, known: tuple[str, ...]) -> tuple[str, ...]:
    """One of several words, or all of them."""
    if text == "all":
        return known
    if text not in known:
        raise errors.UserError(f'--{name} is {", ".join(known)} or all, not "{text[:40]}"')
    return (text,)


def _bytes(text: str) -> int:
    """Memory like "800M" or "4G"."""
    unit = {"M": 1 << 20, "G": 1 << 30}.get(text[-1:].upper())
    number = text[:-1] if unit else text
    if unit is None or not (number.isascii() and number.isdigit() and int(number) > 0):
        raise errors.UserError(f'--memory takes a size like 800M or 4G, not "{text[:40]}"')
    return int(number) * unit
