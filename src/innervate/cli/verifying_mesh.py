"""`innervate verify mesh`: messages, alarms and gateways, in every order of a few nodes' events."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from innervate.cli import errors
from innervate.cli.progress import Display

if TYPE_CHECKING:
    from innervate.cli.verify_options import VerifyOptions
    from innervate.verify.mesh_cases import MeshCase, MeshWanted


def wanted_of(options: VerifyOptions, memory: int) -> MeshWanted:
    """What the options of the command line ask for."""
    from innervate.verify import mesh_cases, mesh_model

    known = mesh_model.FAILOVERS
    rule = options.rule
    if rule and rule not in (*known, "all"):
        raise errors.UserError(
            f'--rule is a failover for a mesh, {", ".join(known)} or all, not "{rule[:40]}"'
        )
    usual = mesh_cases.MeshWanted()
    failovers = usual.failovers if not rule else known if rule == "all" else (rule,)
    links = () if options.graph == "all" else mesh_model.parse(options.graph)
    mesh_cases.budget_of(options.budget, mesh_model.MeshBudget())  # says now what is wrong with it
    return mesh_cases.MeshWanted(
        failovers=failovers,
        links=links,
        budget=options.budget,
        live=options.liveness,
        states=options.states,
        walks=options.walks,
        seed=options.seed or 1,
        memory=memory,
    )


def search(wanted: MeshWanted, as_json: bool, out: Path | None) -> int:
    """Explore what is wanted; 1 if something is broken."""
    from innervate.kernel.stop import Stop
    from innervate.verify import mesh_cases

    done: list[MeshCase] = []
    with Display(as_json) as display, Stop() as stop:

        def tell(name: str, tally: Any) -> bool:
            what = f"{name}: {tally.states:,} states, {tally.depth} events deep"
            display.show(f"{what}, {tally.per_s / 1e3:.0f} k/s", 0, 1 << 40, None)
            return stop.asked

        for name, model in mesh_cases.models(wanted):
            done.append(mesh_cases.run(name, model, wanted, tell))
            if not as_json:
                for line in case_lines(done[-1]):
                    print(line, flush=True)
            if done[-1].story is not None and out is not None:
                _write(done[-1], out, len(done), as_json)
            if stop.asked:
                break
    broken = sum(case.story is not None for case in done)
    if as_json:
        print(json.dumps([case.as_dict() for case in done], indent=2))
    else:
        print(_verdict(done, broken))
    if stop.asked:
        return errors.INTERRUPTED
    return 1 if broken else 0


def case_lines(case: MeshCase) -> list[str]:
    """What came of one exploration."""
    from innervate.verify.mesh_cases import text_of

    found, tally = case.found, case.found.tally
    cables = text_of(found.model.links)
    unit = "walks " if tally.ended == "walked" else "states"
    head = f"{cables:24} {found.model.failover:9} {case.name:12}"
    head += f"{tally.states:>10,} {unit} {tally.generated:>10,} successors {tally.wall_s:7.1f} s"
    if case.story is not None:
        told = [f"    {line}" for line in case.story.lines()]
        return [f"{head}  BROKEN after {len(case.story.sentences)} events", *told]
    return [f"{head}  {_extent(case)}"]


def _extent(case: MeshCase) -> str:
    found, tally = case.found, case.found.tally
    first = f"first {tally.expanded:,} states, to {tally.depth} events"
    words = {
        "complete": "all states",
        "memory": f"{first}: memory is full",
        "limit": f"{first}, as asked",
        "interrupted": f"{first}: interrupted",
        "walked": "a sample of random walks",
    }[tally.ended]
    if not found.fair:
        return words
    part = "" if found.fair >= tally.states else f" from {found.fair:,} of them"
    if found.model.beats:
        return f"{words}; one gateway{part} after {found.longest / 1e6:.1f} s at most"
    return f"{words}; settled{part} in {found.longest} events at most"


def _verdict(done: list[MeshCase], broken: int) -> str:
    part = sum(case.found.tally.ended not in ("complete", "broken") for case in done)
    if broken:
        return f"{broken} of {len(done)} broken."
    sampled = f"; {part} of them only in part" if part else ", all completely"
    return f"Nothing broken in {len(done)} explorations{sampled}."


def _write(case: MeshCase, out: Path, number: int, quiet: bool) -> None:
    """Scenario, story and picture of a counterexample."""
    from innervate.plot import mesh_counterexample
    from innervate.running import mesh_replay

    assert case.story is not None
    out.mkdir(parents=True, exist_ok=True)
    stem = out / f"mesh-counterexample-{number}"
    case.story.scenario = mesh_replay.write(case.story)
    made = [".txt", ".svg"]
    if case.story.scenario:
        stem.with_suffix(".toml").write_text(case.story.scenario, encoding="utf-8")
        made.insert(0, ".toml (innervate run plays it)")
    stem.with_suffix(".txt").write_text("\n".join([*case.story.lines(), ""]), encoding="utf-8")
    mesh_counterexample.save(case.story, stem.with_suffix(".svg"))
    if not quiet:
        print(f"    Written: {stem}{', '.join(made)}")
