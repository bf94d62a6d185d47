"""`innervate run`: one scenario, its report and its files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from innervate.cli import errors
from innervate.cli.options import Json, RunOptions, Seed, Sets
from innervate.cli.progress import Progress, uncompiled
from innervate.folders import for_plain
from innervate.network import networks

if TYPE_CHECKING:
    from innervate.running import Run


def run(
    file: str,
    /,
    *,
    set_: Sets = None,
    seed: Seed = None,
    out: Path | None = None,
    as_json: Json = False,
    how: Annotated[RunOptions, Parameter(name="*")] = RunOptions(),
) -> int:
    """Run a scenario, write its folder, say what came of it.

    Args:
        file: A scenario file, or the name of a bundled one (see: innervate scenarios).
        set_: Change a key, like protocol.k=3 or event.0.at_s=1.5; may be given again.
        seed: Root seed in place of the scenario's; same seed, same run.
        out: Folder to write; runs/NAME-SEED if left out.
        as_json: Print the summary as JSON and nothing else.
        how: How it runs.
    """
    done = simulate(file, set_ or [], seed, out, as_json, how.plain)
    folder = done.write(out, report=how.report)
    if as_json:
        print(json.dumps(done.summary, indent=2, allow_nan=False))
    else:
        for line in networks()[done.plan.kind].summary_lines(done):
            print(line)
        print(f"Written: {folder / 'report.html' if how.report else folder}")
    return errors.INTERRUPTED if done.interrupted else 0


def simulate(
    file: str,
    sets: list[str],
    seed: int | None,
    out: Path | None,
    quiet: bool = False,
    plain: bool = False,
) -> Run:
    """Run a scenario behind a progress display; what is wrong with it is found out before."""
    from innervate import scenario as scenarios

    with for_plain(plain):
        loaded = scenarios.load(file, sets, seed)
    plan = scenarios.plan(loaded)  # the simulator takes a second to load: mistakes first
    from innervate import running as room
    from innervate.running import folder as folders

    if out is None:
        out = folders.free_folder(loaded)
        taken = folders.default_folder(loaded.name, loaded.seed)
        if out != taken:
            errors.say(f"{taken} holds a run of other settings, which is kept; writing {out}")
    folders.check_target(out)
    if plain:  # without a display, which would write over a debugger's lines
        return room.run(loaded, progress=lambda now_us, duration_us: None, plain=True)
    with Progress(uncompiled(plan), quiet) as progress:
        return room.run(loaded, progress=progress)
