"""`innervate verify`: explore small networks, tell what breaks."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import partial
from itertools import count as numbers
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from innervate.cli import errors
from innervate.cli.options import Json, VerifyOptions
from innervate.cli.progress import Display
from innervate.export import files
from innervate.kernel.stop import Stop
from innervate.kernel.words import number_of
from innervate.network import Network, find, first, networks, use

if TYPE_CHECKING:
    from innervate.prove.mutants import Mutant
    from innervate.verify.cases import Case

    # Hunts a mistake: what --json says of that, and what finds it; "" nothing.
    Hunt = Callable[[Mutant], tuple[dict[str, str], str]]


def verify(
    system: str | None = None,
    /,
    *,
    options: Annotated[VerifyOptions, Parameter(name="*")] = VerifyOptions(),
    as_json: Json = False,
    out: Path | None = None,
) -> int:
    """Explore a protocol with the options of the command line; 1 if something is broken.

    Args:
        system: Which protocol: skin (if left out), radio, mesh, or one of your own, by its folder.
        options: What to explore, and how much of it.
        as_json: Print the results as JSON and nothing else.
        out: Folder for counterexamples: scenario, story, picture.
    """
    network = named(first() if system is None else system)
    for name in ("cells", "starts", "states", "walks", "count"):
        if getattr(options, name) < 0:
            raise errors.UserError(f"--{name} must be 0 or more, not {getattr(options, name)}")
    if out is not None:
        files.check_folder(out)
    if options.random and options.mutants:
        raise errors.UserError("--random and --mutants exclude each other; name one")
    if options.random:
        return search(options.seed, options.count, as_json, out)
    if options.mutants:
        return _mutants(network.name, as_json, options.count)
    return _explore(network, options, as_json, out)


def named(system: str, knows: str = "verify explores") -> Network:
    """The network of a name, or of a folder: by its path, or of that name in the present one.

    Raises:
        UserError: there is none.
    """
    if system and Path(system).is_dir() and system not in networks():
        return use(Path(system))
    found = find(system, Path())
    if found is None:
        names = list(networks())
        listed = f"{', '.join(names[:-1])} or {names[-1]}"
        raise errors.UserError(f'{knows} {listed}, not "{system[:40]}"')
    return found


def _explore(network: Network, options: VerifyOptions, as_json: bool, out: Path | None) -> int:
    from innervate.verify.cases import notice_of, verdict

    done: list[Case] = []
    wanted = iter(network.verify.explorations(network, options))
    with Display(as_json) as display, Stop() as stop:
        if notice := notice_of(network, options):
            display.begin(notice, line=True)

        def tell(what: str, part: int, of: int) -> bool:
            display.show(what, part, of, None)
            return stop.asked

        for explore in wanted:
            try:
                done.append(explore(tell))
            except KeyboardInterrupt:  # before it began to look
                if not done:
                    raise
                stop.asked, wanted = True, iter([explore])
                break
            if not as_json:
                for line in done[-1].lines:
                    print(line, flush=True)
            if done[-1].story is not None and out is not None:
                _write(network, done[-1], out / f"{done[-1].stem}-{len(done)}", as_json)
            if stop.asked:
                break
        is_cut = next(wanted, None) is not None
    if as_json:
        print(json.dumps([case.record for case in done], indent=2))
    elif last := verdict(done, is_cut):
        print(last)
    if stop.asked:
        return errors.INTERRUPTED
    return 1 if any(case.is_broken for case in done) else 0


def _write(network: Network, case: Case, stem: Path, quiet: bool) -> None:
    """Scenario, story and picture of a counterexample."""
    files.make_folder(stem.parent)
    story, made = case.story, []
    if case.play is not None:
        story.scenario = case.play()
    if story.scenario:
        files.write_text(stem.with_suffix(".toml"), story.scenario)
        made.append(".toml (innervate run plays it)")
    files.write_text(stem.with_suffix(".txt"), "\n".join([*story.lines(), ""]))
    made.append(".txt")
    if story.sentences and network.has("counterexample"):
        network.counterexample(story, stem.with_suffix(".svg"))
        made.append(".svg")
    if not quiet:
        print(f"    Written: {stem}{', '.join(made)}")


def _hunts(system: str) -> list[tuple[Any, Any]]:
    """All mutants of a protocol, or of all where it is the first, and what hunts each."""
    known = networks()
    wanted = known if system == next(iter(known)) else [system]
    rooms = [known[name].verify for name in wanted]
    return [(mutant, room.hunt) for room in rooms for mutant in getattr(room, "MUTANTS", ())]


def _mutants(system: str, as_json: bool, count: int = 0) -> int:
    """Try the explorer on copies of the protocol with a mistake in each; 1 if one is missed."""
    hunts = [(mutant, partial(_caught, hunt)) for mutant, hunt in _hunts(system)[: count or None]]
    return hunted(system, hunts, as_json, "NOT CAUGHT")


def _caught(hunt: Any, mutant: Mutant) -> tuple[dict[str, str], str]:
    catch = hunt(mutant)
    row = {"mutant": mutant.name, "by": catch.by, "where": catch.where}
    return row, catch.by and f"{catch.by} ({catch.where})"


def hunted(system: str, hunts: Sequence[tuple[Mutant, Hunt]], as_json: bool, missed: str) -> int:
    """Hunt mistakes that are planted in a protocol, and say what finds each; 1 if one is missed.

    Args:
        system: its name.
        hunts: each mistake, and what hunts it.
        as_json: print what was found as JSON and nothing else.
        missed: what is said of one that nothing finds.

    Raises:
        KeyboardInterrupt: Ctrl-C; it says after how many.
    """
    found = []
    with Stop() as stop, Display(as_json) as display:
        for number, (mutant, hunt) in enumerate(hunts):
            display.show(mutant.name, number, len(hunts), None)
            try:
                found.append(hunt(mutant))
            except KeyboardInterrupt:  # while it was sought
                stop.asked = True
            else:
                if not as_json:
                    print(f"{mutant.name}: {found[-1][1] or missed}", flush=True)
            if stop.asked:
                much = f"{len(found)} of {number_of(len(hunts), 'mistake')}"
                raise KeyboardInterrupt(f"interrupted after {much}")
    if as_json:
        print(json.dumps([row for row, _ in found], indent=2))
    elif not found:
        print(f"No mistakes are listed for {system}.")
    return 0 if all(by for _, by in found) else 1


def search(seed: int | None, count: int, as_json: bool, out: Path | None) -> int:
    """Run whole networks `seed`, `seed` + 1, ...; 1 with the first that breaks something."""
    from innervate.running import fuzz

    first, done, broken = 1 if seed is None else seed, 0, None
    with Stop() as stop, Display(as_json) as display:
        for number in numbers(first):
            display.show(f"network {number}: {done} fine so far", done, count, None)
            broken = fuzz.attempt(number)
            done += 1
            if broken is not None or stop.asked or done == count:
                break
    result = {"first": first, "networks": done, "broken": None}
    if broken is None:
        if as_json:
            print(json.dumps(result))
        else:
            last = f" to {first + done - 1}" if done > 1 else ""
            print(f"Nothing broken in {number_of(done, 'network')}, {first}{last}.")
        return errors.INTERRUPTED if stop.asked and done != count else 0
    path = broken.save(out or Path("runs"))
    if as_json:
        print(json.dumps(result | {"broken": broken.why, "seed": broken.seed, "file": str(path)}))
    else:
        print(f"Network {broken.seed} breaks: {broken.why}")
        tries = "1 try" if broken.tries == 1 else f"{broken.tries} tries"
        print(f"Made smaller in {tries}. Play it: innervate run {path}")
        print(f"As drawn: innervate verify --random --seed {broken.seed} --count 1")
    return 1
