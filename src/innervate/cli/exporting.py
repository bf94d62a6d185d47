"""`innervate export`: runs and scenarios as files for other tools."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from innervate import scenario as scenarios
from innervate.cli.errors import UserError
from innervate.cli.options import ExportOptions
from innervate.cli.progress import Progress, uncompiled
from innervate.export import dissector
from innervate.network import networks


def export(
    source: str | None = None,
    /,
    *,
    wanted: Annotated[ExportOptions, Parameter(name="*")] = ExportOptions(),
) -> int:
    """Write what is wanted of a run folder or a scenario; with nothing else, only the dissector.

    Args:
        source: A run folder, a scenario file, or the name of a bundled one; with --dissector alone
            the folder for that, Wireshark's own if left out.
        wanted: Which files are written.
    """
    folder = None if wanted.has_files or source is None else Path(source)
    if wanted.has_files:
        _write_files(source, wanted)
    elif not wanted.dissector:
        if wanted.csv:
            raise UserError("--csv needs --tables FOLDER, where the tables go")
        names = "--pcapng, --mcap, --rerun, --graph, --tables or --dissector"
        raise UserError(f"nothing to export; name one of {names}")
    if wanted.dissector:  # last, as networks beside a scenario are known once it was loaded
        file = dissector.install(folder)
        print(f"Written: {file}. Wireshark and tshark load it from there.")
    return 0


def _write_files(source: str | None, wanted: ExportOptions) -> None:
    if source is None:
        raise UserError("of what? name a run folder or a scenario; see: innervate export --help")
    if wanted.csv and wanted.tables is None:
        raise UserError("--csv is for tables; name their folder with --tables")
    if wanted.pcapng is None and (wanted.from_s or wanted.to_s is not None):
        raise UserError("--from and --to are of --pcapng; other files hold the whole run")
    _Source(source, wanted.set_ or [], wanted.seed).write(wanted)


class _Source:
    """A run folder, or a scenario that is run here."""

    def __init__(self, source: str, sets: list[str], seed: int | None) -> None:
        self.folder = Path(source) if Path(source).is_dir() else None
        self.fingerprint = ""
        if self.folder is None:
            self.plan: Any = scenarios.plan(scenarios.load(source, sets, seed))
            return
        if sets or seed is not None:
            raise UserError(f"{source} was run as it is; export its scenario.toml to change it")
        from innervate.running.recorded import RecordedRun

        run = RecordedRun(self.folder)
        run.check_tables()
        if run.interrupted_s is None:
            self.fingerprint = str(run.summary.get("fingerprint", ""))
        self.plan = run.plan()

    def write(self, wanted: ExportOptions) -> None:
        """Write all that is wanted."""
        plan = self.plan
        self._check(wanted)
        if wanted.graph is not None:
            from innervate.export import graphs

            graphs.write(plan, wanted.graph)
            print(f"Written: {wanted.graph}")
        if wanted.pcapng is not None:
            self._capture(wanted)
        if wanted.tables is not None:
            from innervate.export import tables

            files = tables.write(self._tables(), wanted.tables, wanted.csv)
            print(f"Written: {', '.join(str(file) for file in files)}")
        if wanted.mcap is not None:
            from innervate.export import recording

            count = recording.write(plan, self._frames(), wanted.mcap)
            print(f"Written: {wanted.mcap}, {count} messages")
        if wanted.rerun is not None:
            from innervate.export import rrd

            count = rrd.write(plan, self._frames(), wanted.rerun)
            print(f"Written: {wanted.rerun}, {count} rows; look at it with: rerun {wanted.rerun}")

    def _check(self, wanted: ExportOptions) -> None:
        """What cannot be written is said before anything is simulated for it."""
        if wanted.mcap is not None:
            import mcap.writer  # noqa: F401 - a missing package is said by errors.main
        if wanted.rerun is not None:
            from innervate.export import rrd

            rrd.check(self.plan)
        if wanted.pcapng is not None:
            self._window(wanted)

    def _capture(self, wanted: ExportOptions) -> None:
        from innervate.export import capture

        assert wanted.pcapng is not None
        with Progress(uncompiled(self.plan)) as progress:
            written = capture.write(
                self.plan,
                wanted.pcapng,
                window_us=self._window(wanted),
                fingerprint=self.fingerprint,
                progress=progress,
            )
        print(f"Written: {wanted.pcapng}, {written.frames} packets: "
              f"{written.sent} sent, {written.received} received")  # fmt: skip
        for why, count in written.dropped.items():
            print(f"  dropped: {why} {count}")

    def _window(self, wanted: ExportOptions) -> tuple[int, int] | None:
        last = self.plan.duration_us
        begin = round(1e6 * wanted.from_s)
        end = last if wanted.to_s is None else round(1e6 * wanted.to_s)
        if begin >= last:
            raise UserError(f"the run ends at {last / 1e6:g} s; choose an earlier --from")
        if not 0 <= begin < end:
            raise UserError("nothing lies in that window; let --from be less than --to")
        return begin, end

    def _frames(self) -> dict[str, Any]:
        return {name: table.collect() for name, table in self._tables().items()}

    def _tables(self) -> dict[str, Any]:
        """The run's tables: from its folder, or of a run made now, once."""
        if self.folder is None:
            from innervate import running as room

            if not hasattr(self, "_run"):
                with Progress(uncompiled(self.plan)) as progress:
                    self._run = room.run(self.plan.scenario, progress=progress)
            return dict(self._run.tables)
        from innervate.trace import tables

        here = self.folder
        return {
            table.name: tables.read(table, here)
            for network in networks().values()
            for table in network.tables
            if (here / f"{table.name}.parquet").exists()
        }
