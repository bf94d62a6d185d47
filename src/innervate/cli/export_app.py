"""`innervate export`: what is said before anything is loaded."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from innervate.cli.options import EXPORT_DEFAULTS, ExportOptions


def export(
    source: str | None = None,
    /,
    *,
    options: Annotated[ExportOptions, Parameter(name="*")] = EXPORT_DEFAULTS,
) -> int:
    """Write a run or a scenario as files for other tools.

    Parameters
    ----------
    source
        A run folder, a scenario file, or the name of a bundled one; with --dissector alone the
        folder for that, Wireshark's own if left out.
    """
    from innervate.cli import exporting as command

    return command.export(source, options)


def fit(
    capture: Path,
    /,
    *,
    out: Path | None = None,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Make a scenario out of a capture of a mesh or a skin; 1 if its simulation has other links.

    Parameters
    ----------
    capture
        A capture by innervate, of a run or of live nodes; or what `live status --json` said.
    out
        The scenario file to write; it is printed if left out.
    json
        Print the scenario and how well it matches as JSON and nothing else.
    """
    from innervate.cli import fitting as command

    return command.fit(capture, out, json)
