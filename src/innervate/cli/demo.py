"""`innervate demo`: one chapter for each kind of network that has one."""

import webbrowser
from pathlib import Path
from typing import Any

from innervate.cli import errors
from innervate.cli.running import simulate
from innervate.network import networks


def demo(seed: int | None, out: Path | None, open_report: bool) -> int:
    """Run all chapters; print what happened and where the reports are."""
    able = {name: network.demo for name, network in networks().items() if network.has("demo")}
    for i, (name, chapter) in enumerate(able.items()):
        if i:
            print()
        report, interrupted = _tell(chapter, seed, None if out is None else out / name)
        if open_report:
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
