"""Commands that read and write files, and nothing else: what is said before anything is loaded."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from innervate.cli.options import ExportOptions, Flag, MeasuredOptions, OwnOptions, Seed, Sets


def scenarios(*, json: Flag = False) -> int:
    """List the bundled scenarios, each with what it shows.

    Args:
        json: Print names, sentences and files as JSON.
    """
    from innervate.cli import files as command

    return command.scenarios(json)


def schema(*, out: Path | None = None) -> int:
    """Print the JSON Schema of scenario files, for editors.

    Args:
        out: File to write it to.
    """
    from innervate.cli import files as command

    return command.schema(out)


def docs(page: str = "", /) -> int:
    """Print a page of the documentation, or the list of them.

    Args:
        page: Its name, as the list has it.
    """
    from innervate.cli import pages as command

    return command.show(page)


def doctor(*, json: Flag = False) -> int:
    """Say what is installed, what is missing and what will be slow; 1 if nothing can be simulated.

    Args:
        json: Print it as JSON and nothing else.
    """
    from innervate.cli import doctor as command

    return command.doctor(json)


def new(
    kind: str,
    file: Path | None = None,
    /,
    *,
    measured: Annotated[MeasuredOptions, Parameter(name="*")] = MeasuredOptions(),
    own: Annotated[OwnOptions, Parameter(name="*")] = OwnOptions(),
) -> int:
    """Write a commented scenario to start from, or a network of one's own.

    Args:
        kind: What it describes: skin, radio or mesh. network: a folder with a network of your own.
        file: Where to write it; a scenario is printed if left out. Of a network, its folder: NAME.
        measured: Which nodes and links of a measured network count.
        own: What a network of your own is joined by.
    """
    from innervate.cli import files as command

    if kind == "network":
        from innervate.cli import making

        command.check_unused(measured, "a measured network, not for your own")
        return making.make(file, own.on, own.over)
    command.check_unused(own, "a network of your own: innervate new network NAME")
    return command.new(kind, file, measured)


def check(file: str, /, *, set_: Sets = None, seed: Seed = None, json: Flag = False) -> int:
    """Check a scenario without running it; says what it holds.

    Args:
        file: A scenario file, or the name of a bundled one.
        set_: Change a key, as for run.
        seed: Root seed in place of the scenario's.
        json: Print it as JSON and nothing else.
    """
    from innervate.cli import files as command

    return command.check(file, set_ or [], seed, json)


def compare(first: Path, second: Path, /, *, json: Flag = False) -> int:
    """Compare two run folders: scenario, summary, first event that differs.

    The exit code is 0 if both were the same, event by event, and 1 if not.

    Args:
        first: A run folder.
        second: Another one.
        json: Print all that differs as JSON and nothing else.
    """
    from innervate.cli import comparing as command

    return command.compare(first, second, json)


def check_protocol(
    folder: Path,
    /,
    *,
    tests: bool = True,
    json: Flag = False,
) -> int:
    """Check a network of your own: dialect, ranges, frames, outbox, what no test reaches.

    Args:
        folder: The network's folder.
        tests: Run its tests, and say which functions of the protocol they do not reach.
        json: Print what was found as JSON and nothing else.
    """
    from innervate.cli import making as command

    return command.check_protocol(folder, json, tests)


def export(
    source: str | None = None,
    /,
    *,
    options: Annotated[ExportOptions, Parameter(name="*")] = ExportOptions(),
) -> int:
    """Write a run or a scenario as files for other tools.

    Args:
        source: A run folder, a scenario file, or the name of a bundled one; with --dissector alone
            the
            folder for that, Wireshark's own if left out.
    """
    from innervate.cli import exporting as command

    return command.export(source, options)


def fit(
    capture: Path,
    /,
    *,
    out: Path | None = None,
    json: Flag = False,
) -> int:
    """Make a scenario out of a capture of a mesh or a skin; 1 if its simulation has other links.

    Args:
        capture: A capture by innervate, of a run or of live nodes; or what `live status --json`
            said.
        out: The scenario file to write; it is printed if left out.
        json: Print the scenario and how well it matches as JSON and nothing else.
    """
    from innervate.cli import fitting as command

    return command.fit(capture, out, json)
