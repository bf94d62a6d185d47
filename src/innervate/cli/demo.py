"""`innervate demo`: one chapter for each kind of network that has one."""

import webbrowser
from pathlib import Path
from typing import Any

from innervate.cli import errors
from innervate.cli.options import Flag, Seed
from innervate.cli.running import simulate
from innervate.network import networks


def demo(*, seed: Seed = None, out: Path | None = None, open_: Flag = False) -> int:
    """Run all chapters; print what happened and where the reports are.

    Args:
        seed: Root seed in place of the scenario's; same seed, same run.
        out: Folder to write into, a run folder for each; runs/ if left out.
        open_: Open the reports in a browser.
    """
    able = {name: network.demo for name, network in networks().items() if network.has("demo")}
    for i, (name, chapter) in enumerate(able.items()):
        if i:
            print()
        report, interrupted = _tell(chapter, seed, None if out is None else out / name)
        if open_:
            webbrowser.open(report.resolve().as_uri())
        if interrupted:
            return errors.INTERRUPTED
    print()
    print("Next:")
    first, *others = able
    own = f"a scenario of your own, with comments; also: {', '.join(others)}"
    for command, what in (
        *(line for chapter in able.values() for line in chapter.NEXT),
        (f"innervate new {first} my-{first}.toml", own),
        ("innervate scenarios", "what else is here"),
    ):
        print(f"  {command:<57}{what}")
    return 0


def _tell(chapter: Any, seed: int | None, out: Path | None) -> tuple[Path, bool]:
    """Run and tell a chapter; its report, and whether it was ended early."""
    for line in chapter.INTRODUCTION:
        print(line)
    print(flush=True)
    run = simulate(chapter.SCENARIO, [], seed, out)
    report = run.write(out) / "report.html"
    for line in chapter.lines(run):
        print(f"  {line}" if line else "")
    print(f"  {chapter.LOOK}: {report}")
    return report, run.interrupted
