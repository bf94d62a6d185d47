"""The command `innervate`: which commands there are, and what is done when one fails."""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import App, Parameter

import innervate
from innervate.cli import errors

HELP = """Describe and simulate the networks inside and between robots.

Start with: innervate demo. The first run on a machine compiles for about half a minute."""

_SET = Parameter(name=["--set"], negative="", allow_leading_hyphen=True)
Sets = Annotated[list[str] | None, _SET]


def _whole_seed(_type: Any, tokens: Sequence[Any]) -> int:
    """What --seed takes: a library's guess at a number could run another seed than was meant."""
    text = tokens[0].value
    if not (text.isascii() and text.isdigit() and int(text) < 2**63):
        message = f'--seed must be a whole number from 0, below 2^63, not "{text[:40]}"'
        raise errors.UserError(message)
    return int(text)


Seed = Annotated[int | None, Parameter(converter=_whole_seed)]

app = App(
    name="innervate",
    help=HELP,
    help_format="plaintext",
    version=f"innervate {innervate.__version__}",
    version_flags=["--version"],
    suppress_keyboard_interrupt=False,
    result_action="return_value",
)


@app.command
def demo(
    *,
    seed: Seed = None,
    out: Path | None = None,
    open_: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """The main jobs: a robot skin mends itself, a radio team puts itself in order. Writes reports.

    Parameters
    ----------
    seed
        Root seed in place of the scenario's; same seed, same run.
    out
        Folder to write into, a run folder for each; runs/ if left out.
    open_
        Open the reports in a browser.
    """
    from innervate.cli import demo as command

    return command.demo(seed, out, open_)


@app.command
def run(
    file: str,
    /,
    *,
    set_: Sets = None,
    seed: Seed = None,
    out: Path | None = None,
    json: Annotated[bool, Parameter(negative="")] = False,
    report: bool = True,
) -> int:
    """Run a scenario; writes a folder with summary, tables, provenance and report.

    Parameters
    ----------
    file
        A scenario file, or the name of a bundled one (see: innervate scenarios).
    set_
        Change a key, like protocol.k=3 or event.0.at_s=1.5; may be given again.
    seed
        Root seed in place of the scenario's; same seed, same run.
    out
        Folder to write; runs/NAME-SEED if left out.
    json
        Print the summary as JSON and nothing else.
    report
        Write report.html as well.
    """
    from innervate.cli import running as command

    return command.run(file, set_ or [], seed, out, json, report)


@app.command
def papers(
    paper: str = "skin",
    /,
    *,
    only: Annotated[list[str] | None, Parameter(negative="")] = None,
    quick: Annotated[bool, Parameter(negative="")] = False,
    redraw: Annotated[bool, Parameter(negative="")] = False,
    out: Path = Path("papers"),
) -> int:
    """Draw and tabulate the published figures, each claim beside what was measured.

    Parameters
    ----------
    paper
        Which paper: skin or radio.
    only
        A figure by its name, like fig8a of the skin or fig12 of the radio; may be given again.
    quick
        Few seeds and settings: in about a minute.
    redraw
        Use kept results even if the sources have changed since.
    out
        Folder for pictures, tables and kept results.
    """
    from innervate.cli import papers as command

    return command.papers(paper, only or [], quick, redraw, out)


@app.command
def scenarios() -> int:
    """List the bundled scenarios."""
    from innervate.cli import files as command

    return command.scenarios()


@app.command
def new(kind: str, file: Path | None = None, /) -> int:
    """Write a commented scenario to start from.

    Parameters
    ----------
    kind
        What it describes: skin, radio or mesh.
    file
        Where to write it; it is printed if left out.
    """
    from innervate.cli import files as command

    return command.new(kind, file)


@app.command
def check(file: str, /, *, set_: Sets = None, seed: Seed = None) -> int:
    """Check a scenario without running it; says what it holds.

    Parameters
    ----------
    file
        A scenario file, or the name of a bundled one.
    set_
        Change a key, as for run.
    seed
        Root seed in place of the scenario's.
    """
    from innervate.cli import files as command

    return command.check(file, set_ or [], seed)


@app.command
def compare(first: Path, second: Path, /) -> int:
    """Compare two run folders: scenario, summary, first event that differs.

    Parameters
    ----------
    first
        A run folder.
    second
        Another one.
    """
    from innervate.cli import comparing as command

    return command.compare(first, second)


def main(tokens: Sequence[str] | None = None) -> int:
    """Carry out a command line; its exit code: 0, 1 our mistake, 2 the user's, 130 interrupted."""
    for stream in (sys.stdout, sys.stderr):  # a terminal that is not UTF-8 gets escapes
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        code = _parse_and_run(list(sys.argv[1:] if tokens is None else tokens))
        if sys.stdout is not None:  # it may be closed
            sys.stdout.flush()
    except BaseException as error:
        return errors.conclude(error)
    return code


def _parse_and_run(tokens: list[str]) -> int:
    result: Any = app(tokens, exit_on_error=False, print_error=False, verbose=False)
    return result if isinstance(result, int) else 0
