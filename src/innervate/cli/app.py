"""The command `innervate`: which commands there are, and what is done when one fails."""

import io
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import App, Parameter

import innervate
from innervate.cli import errors, examples
from innervate.cli.files_app import (
    check,
    check_protocol,
    compare,
    docs,
    doctor,
    export,
    fit,
    new,
    scenarios,
    schema,
)
from innervate.cli.flowing import Flowing
from innervate.cli.live_app import live_app
from innervate.cli.options import (
    Flag,
    PageOptions,
    RunOptions,
    Seed,
    Sets,
    SizeOptions,
    SweepOptions,
    Texts,
    VerifyOptions,
    Whole,
)
from innervate.network import first

HELP = """Describe and simulate the networks inside and between robots.

Start with: innervate demo. Where no loops came with the toolkit (see doctor), the first run
compiles for about half a minute."""


app = App(
    name="innervate",
    help=HELP,
    help_format="plaintext",
    help_formatter=Flowing(),
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
    open_: Flag = False,
) -> int:
    """The main jobs: a skin mends itself, radios get in order, an alarm gets through. With reports.

    Args:
        seed: Root seed in place of the scenario's; same seed, same run.
        out: Folder to write into, a run folder for each; runs/ if left out.
        open_: Open the reports in a browser.
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
    json: Flag = False,
    how: Annotated[RunOptions, Parameter(name="*")] = RunOptions(),
) -> int:
    """Run a scenario; writes a folder with summary, tables, provenance and report.

    Args:
        file: A scenario file, or the name of a bundled one (see: innervate scenarios).
        set_: Change a key, like protocol.k=3 or event.0.at_s=1.5; may be given again.
        seed: Root seed in place of the scenario's; same seed, same run.
        out: Folder to write; runs/NAME-SEED if left out.
        json: Print the summary as JSON and nothing else.
    """
    from innervate.cli import running as command

    return command.run(file, set_ or [], seed, out, json, how)


@app.command
def sweep(
    file: str,
    /,
    *,
    options: Annotated[SweepOptions, Parameter(name="*")] = SweepOptions(),
) -> int:
    """Run a scenario for every combination of some settings, many times each.

    Give the same command again after an interrupt, a crash or with more values: what is done is
    not done twice. The exit code is 1 if no run succeeded, or a figure could not be drawn.

    Args:
        file: A scenario file, the name of a bundled one, or a plan file (see: innervate docs
            sweeps).
    """
    from innervate.cli import sweeping as command

    return command.sweep(file, options)


@app.command
def size(robot: str, /, *, options: Annotated[SizeOptions, Parameter(name="*")]) -> int:
    """Say how many interface ports a robot's skin needs, and where, by simulation.

    The exit code is 1 if at some rate none of the numbers of ports that were tried is enough.

    Args:
        robot: A URDF file, or package:NAME/ROBOT like package:icub-models/iCubGenova02.
    """
    from innervate.cli import sizing as command

    return command.size(robot, options)


@app.command
def papers(
    paper: str | None = None,
    /,
    *,
    only: Texts = None,
    quick: Flag = False,
    redraw: Flag = False,
    page: Path | None = None,
    out: Path = Path("papers"),
) -> int:
    """Draw and tabulate the published figures, each claim beside what was measured.

    Args:
        paper: Which paper: skin (if left out), radio or mesh; or compare: networks beside others.
        only: A figure by its name, like fig8a of the skin, fig12 of the radio or skin of compare;
            may be given again.
        quick: Few seeds and settings: in about a minute.
        redraw: Use kept results even if the sources have changed since.
        page: Of compare: a page of Markdown whose tables are made anew between its marks.
        out: Folder for pictures, tables and kept results.
    """
    from innervate.cli import papers as command

    how = {"quick": quick, "only": only or [], "redraw": redraw}
    return command.papers(first() if paper is None else paper, out, page, how)


@app.command
def verify(
    system: str | None = None,
    /,
    *,
    options: Annotated[VerifyOptions, Parameter(name="*")] = VerifyOptions(),
    json: Flag = False,
    out: Path | None = None,
) -> int:
    """Explore every interleaving of the protocol on small networks; 1 if something is broken.

    Args:
        system: Which protocol: skin (if left out), radio, mesh, or one of your own, by its folder.
        json: Print the results as JSON and nothing else.
        out: Folder for counterexamples: scenario, story, picture.
    """
    from innervate.cli import verifying as command

    return command.verify(first() if system is None else system, options, json, out)


@app.command
def prove(
    system: str | None = None,
    /,
    *,
    faults: Flag = False,
    json: Flag = False,
) -> int:
    """Prove what holds for any number of nodes, from the protocol's own source; 1 if it does not.

    Args:
        system: Which protocol: skin (if left out), radio, mesh, or one of your own, by its folder.
        faults: Plant small mistakes in the protocol, one after the other: each must be refuted.
        json: Print the results as JSON and nothing else.
    """
    from innervate.cli import proving as command

    return command.prove(first() if system is None else system, faults, json)


@app.command
def watch(
    what: str,
    /,
    *nodes: str,
    set_: Sets = None,
    seed: Seed = None,
    speed: float | None = None,
    page: Annotated[PageOptions, Parameter(name="*")] = PageOptions(),
) -> int:
    """Serve a page to watch a network on and to break it, until Ctrl-C.

    Args:
        what: A scenario, the name of a bundled one, a run folder, or live: nodes that run.
        nodes: With live: names or sockets; all nodes of this user if left out.
        set_: Change a key of the scenario, as for run.
        seed: Root seed in place of the scenario's.
        speed: Seconds of the network per second; 0 is as fast as possible.
    """
    from innervate.cli import watching as command

    return command.watch(what, list(nodes), command.Settings(set_ or [], seed, speed), page)


@app.command
def firmware(
    network: str,
    /,
    *settings: str,
    out: Path = Path("lib"),
    nodes: Whole | None = None,
    prefix: str = "",
    sealed: Flag = False,
    json: Flag = False,
) -> int:
    """Write a node's protocol as C99 for a microcontroller: one .c and one .h.

    Args:
        network: skin, radio, mesh, csma, or a folder with a network of your own.
        settings: Parameters of the protocol in place of the usual ones, like beacon_us=20000.
        out: Folder to write into.
        nodes: How many a network of this kind has at most, where arrays depend on it.
        prefix: In front of all names; the network's name if left out.
        sealed: With a driver that shakes hands and seals, with a network's key, as live nodes do.
        json: Print what was written as JSON and nothing else.
    """
    from innervate.cli import firmware as command
    from innervate.firmware import library

    files = library.made_of(network, list(settings), nodes, prefix, sealed)
    return command.write(files, out, json)


app.command(scenarios)
app.command(new)
app.command(check)
app.command(check_protocol)
app.command(schema)
app.command(docs)
app.command(doctor)
app.command(compare)
app.command(export)
app.command(fit)
app.command(live_app)
app.register_install_completion_command()
examples.add_to(app)


def main(tokens: Sequence[str] | None = None) -> int:
    """Carry out a command line; its exit code, see docs/commands.md."""
    if sys.stderr is None:  # closed: what would be said there is no part of the answer
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115
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
    result: Any = app(_with_networks(tokens), exit_on_error=False, print_error=False, verbose=False)
    return result if isinstance(result, int) else 0


def _with_networks(tokens: list[str]) -> list[str]:
    """A command line without its --network DIR, whose network is known from now on.

    Of `new` it is a measured network, and stays.
    """
    from innervate.network import use

    left: list[str] = []
    while tokens:
        one, *tokens = tokens
        if left[:1] == ["new"] or (one != "--network" and not one.startswith("--network=")):
            left.append(one)
            continue
        _, _, given = one.partition("=")
        if not given and not tokens:
            raise errors.UserError("--network needs a folder; see: innervate docs own-network")
        if not given:
            given, *tokens = tokens
        use(Path(given))
    return left
