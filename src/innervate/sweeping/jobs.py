"""The job table: what was run, in SQLite beside the results.

A run stands in it once it is done, in the same moment as its figures; whatever does not stand in
it has still to be run. One process writes; a second one that tries is told so.
"""

from __future__ import annotations

import json
import os
import shutil
import sqlite3
from collections.abc import Generator, Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple

from innervate.sweeping.errors import DamagedError, SweepError
from innervate.sweeping.work import Outcome

SCHEMA = 1
FILE = "jobs.sqlite"
_TABLES = Path(__file__).with_name("jobs.sql").read_text(encoding="utf-8")
_INSERT = "INSERT OR IGNORE INTO runs VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)"
_DELETE = "DELETE FROM runs WHERE point = ? AND repeat = ?"


class Stored(NamedTuple):
    """A run of the table: its figures, or why it failed; and what it took, where."""

    seed: int
    figures: dict[str, Any] | None
    reason: str
    wall_s: float
    began_s: float
    place: int


class Jobs:
    """An open job table; use it as a context manager.

    A row that is torn costs that run, and no other: it counts as not run, and the next outcome of
    it takes its place.

    Args:
        folder: where it lies, made if it is not there; None keeps it in memory.

    Raises:
        SweepError: it cannot be written, is damaged, or somebody else is at work on it.
    """

    def __init__(self, folder: Path | None) -> None:
        self.torn: set[tuple[str, int]] = set()  # runs whose rows were found torn, (point, repeat)
        self.torn_places: set[int] = set()  # numbers of those of which nothing is known any more
        self._name = ":memory:" if folder is None else str(folder / FILE)
        with self._errors():
            self._db = sqlite3.connect(self._name, timeout=0.2, isolation_level=None)
            self._db.text_factory = _text
        try:
            with self._errors():
                self._db.execute("PRAGMA locking_mode = EXCLUSIVE")
                self._db.execute("PRAGMA journal_mode = WAL")
                self._db.execute("PRAGMA synchronous = NORMAL")
                self._db.execute("BEGIN EXCLUSIVE")
                for statement in filter(str.strip, _TABLES.split(";")):
                    self._db.execute(statement)
                self._db.execute("COMMIT")
        except BaseException:
            self._db.close()
            raise

    def __enter__(self) -> Jobs:
        return self

    def __exit__(self, *_: object) -> None:
        self._db.close()

    @contextmanager
    def _errors(self) -> Iterator[None]:
        """SQLite's errors in one line each."""
        try:
            yield
        except sqlite3.Error as error:
            code = getattr(error, "sqlite_errorname", "") or ""
            kind = DamagedError if code.startswith("SQLITE_CORRUPT") else SweepError
            raise kind(_in_words(self._name, error)) from error

    def claim(self, identity: Mapping[str, str], files: Mapping[str, str] | None = None) -> None:
        """Begin a sweep of this identity here, or go on with it.

        Args:
            identity: what it is known by, in words: all of it has to be as it was.
            files: what it reads besides; other ones may come later.

        Raises:
            SweepError: what is here is another one's; it says what differs.
        """
        wanted = {"schema": str(SCHEMA), **identity}
        with self._errors():
            found = dict(self._db.execute("SELECT name, value FROM meta"))
            if not found:
                self._db.executemany("INSERT INTO meta VALUES (?, ?)", wanted.items())
        known = found or wanted
        differs = [name for name, value in wanted.items() if known.get(name) != value]
        fresh = dict(files or {})
        differs += [name for name, value in fresh.items() if found.get(name, value) != value]
        if differs:
            folder = Path(self._name).parent
            raise SweepError(
                f"{' and '.join(differs)} changed since the sweep in {folder} was begun; "
                "give it as it was, or choose another folder"
            )
        with self._errors():
            self._db.executemany("INSERT OR IGNORE INTO meta VALUES (?, ?)", fresh.items())

    def add(self, outcomes: Iterable[Outcome], place: str) -> None:
        """Keep these, all or none.

        Raises:
            SweepError: the disk is full, ...; what was kept before is not touched.
        """
        with self._errors():
            self._db.execute("BEGIN")
            try:
                self._db.execute("INSERT OR IGNORE INTO places (facts) VALUES (?)", (place,))
                row = self._db.execute("SELECT id FROM places WHERE facts = ?", (place,))
                (number,) = row.fetchone()
                outcomes = list(outcomes)
                again = [(o.point, o.repeat) for o in outcomes if (o.point, o.repeat) in self.torn]
                self._db.executemany(_DELETE, again)
                rows = [(o.point, o.repeat, o.seed, "failed" if o.row is None else "done", o.row,
                         o.reason, o.wall_s, o.began_s, number) for o in outcomes]  # fmt: skip
                self._db.executemany(_INSERT, rows)
                self._db.execute("COMMIT")
            except BaseException:
                if self._db.in_transaction:
                    self._db.execute("ROLLBACK")
                raise

    def take_over(self, old: sqlite3.Connection, wanted: Mapping[str, int]) -> bool:
        """Keep what can be read of a damaged table; False if not even whose it is."""
        with self._errors():
            self._db.execute("BEGIN")
            for table, columns in (("meta", 2), ("places", 2), ("runs", 9)):
                marks = ", ".join("?" * columns)
                self._db.executemany(f"INSERT OR IGNORE INTO {table} VALUES ({marks})",
                                     _readable(old, table, wanted))  # fmt: skip
            self._db.execute("COMMIT")
            return bool(self._db.execute("SELECT count(*) FROM meta").fetchone()[0])

    def forget_failed(self) -> int:
        """Forget the failed runs, so that they are run again; how many."""
        with self._errors():
            return self._db.execute("DELETE FROM runs WHERE state = 'failed'").rowcount

    def runs(self, point: str, behind: int) -> dict[int, Stored]:
        """The runs of a point, by repeat, those before `behind`."""
        return dict(self.each(point, behind))

    def each(self, point: str, behind: int) -> Iterator[tuple[int, Stored]]:
        """The same one by one, in order of repeat: a point may have a million."""
        query = (
            "SELECT repeat, state, seed, figures, reason, wall_s, began_s, place FROM runs "
            "WHERE point = ? AND repeat < ? ORDER BY repeat"
        )
        with self._errors():
            for repeat, *row in self._db.execute(query, (point, behind)):
                run = _run(*row)
                if run is None:
                    self.torn.add((point, repeat))
                else:
                    yield repeat, run

    def count(self) -> int:
        """How many runs there are, of this sweep and of others in the same folder."""
        with self._errors():
            found: int = self._db.execute("SELECT count(*) FROM runs").fetchone()[0]
        return found

    def places(self) -> dict[int, dict[str, Any]]:
        """What is known of the machines and processes, by number."""
        with self._errors():
            rows = self._db.execute("SELECT id, facts FROM places").fetchall()
        found = {number: _object(facts) for number, facts in rows}
        self.torn_places |= {number for number, facts in found.items() if facts is None}
        return {number: facts or {} for number, facts in found.items()}


def rescue(folder: Path, wanted: Mapping[str, int]) -> tuple[int, str]:
    """Put what can be read of a damaged table into a new one.

    Args:
        folder: where it lies; the table as it was stays there under another name.
        wanted: the points that are looked for run by run, and below which repeat; of others only
            those are kept that are found before the first damaged page or behind the last.

    Returns:
        How many runs are kept; what the file as it was is called now.

    Raises:
        DamagedError: not even whose table it is can be read.
        SweepError: there is no room for another.
    """
    path, fresh = folder / FILE, folder / "rescued"
    fresh.mkdir(exist_ok=True)
    with closing(sqlite3.connect(path)) as old, Jobs(fresh) as new:
        old.text_factory = _text
        is_known, kept = new.take_over(old, wanted), new.count()
    if not is_known:
        (fresh / FILE).unlink()
        fresh.rmdir()
        error = sqlite3.DatabaseError()
        error.sqlite_errorname = "SQLITE_CORRUPT"
        raise DamagedError(_in_words(str(path), error))
    names = (folder / f"{FILE}.damaged-{k}" for k in count(1))
    aside = next(name for name in names if not name.exists())
    shutil.copyfile(path, aside)  # whoever is killed here finds one table or the other
    for rest in ("-wal", "-shm"):
        (folder / f"{FILE}{rest}").unlink(missing_ok=True)
    os.replace(fresh / FILE, path)
    fresh.rmdir()
    return kept, aside.name


def _readable(old: sqlite3.Connection, table: str, wanted: Mapping[str, int]) -> Iterator[Any]:
    """The rows of a table that can be read: from its beginning, from its end, and one by one."""
    key = {"meta": "name", "places": "id", "runs": "point"}[table]
    if (yield from _until_damaged(old, f"SELECT * FROM {table} ORDER BY {key}")):
        return
    yield from _until_damaged(old, f"SELECT * FROM {table} ORDER BY {key} DESC")
    if table == "runs":
        one = "SELECT * FROM runs WHERE point = ? AND repeat = ?"
        for point, behind in wanted.items():
            for repeat in range(behind):
                yield from _until_damaged(old, one, point, repeat)


def _until_damaged(
    old: sqlite3.Connection, query: str, *given: Any
) -> Generator[tuple[Any, ...], None, bool]:
    """The rows that come before damage; returns that there was none."""
    try:
        yield from old.execute(query, given)
    except sqlite3.DatabaseError:
        return False
    return True


def _run(state: str, seed: Any, text: Any, *rest: Any) -> Stored | None:
    """A run as its row has it; None if that is torn."""
    figures = None if text is None else _object(text)
    kinds = [type(value) for value in (seed, *rest)]
    whole = kinds == [int, str, float, float, int] and (figures is None) == (state == "failed")
    return Stored(seed, figures, *rest) if whole else None


def _object(text: Any) -> dict[str, Any] | None:
    """A JSON object that was kept as text; None if it is none."""
    try:
        found = json.loads(str.encode(text))  # what is no text at all is no JSON either
    except (ValueError, TypeError):
        return None
    return found if isinstance(found, dict) else None


def _text(raw: bytes) -> str:
    """Text, torn or not: an error here would be that of the whole table."""
    return raw.decode(errors="surrogateescape")


def _in_words(name: str, error: sqlite3.Error) -> str:
    code = getattr(error, "sqlite_errorname", "") or ""
    if code.startswith(("SQLITE_BUSY", "SQLITE_LOCKED")):
        folder = Path(name).parent
        return f"another sweep is at work in {folder}; wait for it, or choose another folder"
    if code.startswith(("SQLITE_READONLY", "SQLITE_CANTOPEN", "SQLITE_PERM")):
        return f"{name} cannot be written; choose another folder"
    if code.startswith(("SQLITE_FULL", "SQLITE_IOERR")):
        return (
            f"{name}: no space left on the disk, or it fails; make room and give the same "
            "command again, what is done is kept"
        )
    if code.startswith(("SQLITE_NOTADB", "SQLITE_CORRUPT")):
        return (
            f"{name} is no job table, or damaged so that nothing of it can be kept; move it away "
            "and all is run anew, or choose another folder"
        )
    return f"{name}: {error}"
