"""`innervate export`: its options, checked before anything is loaded."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from innervate.cli.seeds import Seed, Sets


def export(
    source: str | None = None,
    /,
    *,
    pcapng: Path | None = None,
    mcap: Path | None = None,
    rerun: Path | None = None,
    graph: Path | None = None,
    tables: Path | None = None,
    csv: Annotated[bool, Parameter(negative="")] = False,
    dissector: Annotated[bool, Parameter(negative="")] = False,
    from_: Annotated[float, Parameter(name=["--from"])] = 0.0,
    to: float | None = None,
    set_: Sets = None,
    seed: Seed = None,
) -> int:
    """Write a run or a scenario as files for other tools (see docs/export.md).

    Parameters
    ----------
    source
        A run folder, a scenario file, or the name of a bundled one; with --dissector alone the
        folder for that, Wireshark's own if left out.
    pcapng
        Capture of all frames, for Wireshark.
    mcap
        Recording of states, touch, routes and alarms, for Foxglove and PlotJuggler.
    rerun
        Recording in space, for the viewer of rerun.io.
    graph
        The network, a file ending in .graphml or .json (node-link).
    tables
        Folder for the run's tables, as Parquet.
    csv
        Tables as CSV instead.
    dissector
        Install the dissector that makes Wireshark read captures.
    from_
        Capture from this time on, s.
    to
        Capture up to this time, s.
    set_
        Change a key of a scenario, as for run.
    seed
        Root seed in place of the scenario's.
    """
    from innervate.cli import exporting as command

    wanted = command.Wanted(
        pcapng=pcapng,
        mcap=mcap,
        rerun=rerun,
        graph=graph,
        tables=tables,
        csv=csv,
        from_s=from_,
        to_s=to,
    )
    return command.export(source, set_ or [], seed, wanted, dissector)


def fit(capture: Path, /, *, out: Path | None = None) -> int:
    """Make a scenario out of a capture of a mesh or a skin; 1 if its simulation has other links.

    Parameters
    ----------
    capture
        A capture by innervate, of a run or of live nodes; or what `live status --json` said.
    out
        The scenario file to write; it is printed if left out.
    """
    from innervate.cli import fitting as command

    return command.fit(capture, out)
