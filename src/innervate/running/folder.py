"""Run folders: written whole or not at all, replaced only where a run was before."""

import hashlib
import json
import os
import re
import secrets
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from innervate import scenario as scenarios
from innervate.network import first, networks
from innervate.running.errors import RunError
from innervate.scenario import Scenario, ScenarioError

SCENARIO = "scenario.toml"
SUMMARY = "summary.json"
PROVENANCE = "provenance.json"
REPORT = "report.html"
REQUIRED = (SCENARIO, SUMMARY, PROVENANCE)

FOLDERS_MAX = 1000  # beyond, the last is replaced
_UNSUITABLE = re.compile(r"[^\w.+-]+")


@cache
def table_files() -> tuple[str, ...]:
    """The files of all tables that runs of any network can have."""
    tables = [table for network in networks().values() for table in network.tables]
    return tuple(dict.fromkeys(f"{table.name}.parquet" for table in tables))


def default_folder(name: str, seed: int) -> Path:
    """Where a run goes if nobody says: runs/<name>-<seed>."""
    return Path("runs") / f"{plain_name(name) or first()}-{seed}"


def plain_name(name: str) -> str:
    """A name as a folder can have it, without a way to other folders; perhaps nothing is left."""
    return _UNSUITABLE.sub("-", name).strip("-.")[:80]


def free_folder(scenario: Scenario) -> Path:
    """Where a run goes if nobody says, past folders that hold runs of other settings.

    runs/<name>-<seed>, or with -2, -3, ... behind it. A run of the same settings is replaced.
    """
    first = default_folder(scenario.name, scenario.seed)
    for number in range(1, FOLDERS_MAX + 1):
        folder = first if number == 1 else first.with_name(f"{first.name}-{number}")
        if not (folder / SCENARIO).is_file() or _is_run_of(folder, scenario):
            return folder
    return folder


def _is_run_of(folder: Path, scenario: Scenario) -> bool:
    try:
        return scenarios.dump(scenarios.load(folder / SCENARIO)) == scenarios.dump(scenario)
    except ScenarioError:  # of another version, or damaged: no run of this one
        return False


def check_target(folder: str | os.PathLike[str]) -> Path:
    """The folder, if a run may be written there: new, empty, or a run folder with nothing else.

    Raises:
        RunError: it is a file, holds something else, or cannot be written.
    """
    path = Path(folder)
    shown = _shown(path)
    try:
        target = path.resolve()
        if target.exists():
            _check_content(target, shown)
        home = next(parent for parent in target.parents if parent.exists())
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or "no such path can be"
        raise RunError(f"{shown}: {why}; choose another folder") from None
    if not home.is_dir():
        raise RunError(f"{_shown(home)} is a file; choose another folder")
    if not os.access(home, os.W_OK | os.X_OK):
        raise RunError(f"no permission to write in {_shown(home)}; choose another folder")
    return target


def _check_content(target: Path, shown: str) -> None:
    """That a folder may be replaced."""
    if not target.is_dir():
        raise RunError(f"{shown} is a file; choose another folder")
    names = {entry.name for entry in target.iterdir()}
    if names and not names.issuperset(REQUIRED):
        raise RunError(f"{shown} is not a run folder and not empty; choose another folder")
    strange = sorted(names - {*REQUIRED, REPORT, *table_files()})
    if strange:
        what = _shown(Path(strange[0])) + (" and more" if len(strange) > 1 else "")
        raise RunError(f"{shown} also holds {what}; move it away or choose another folder")


@contextmanager
def replacing(folder: str | os.PathLike[str]) -> Iterator[Path]:
    """A new folder beside `folder` that takes its place when all went well, and goes if not.

    Raises:
        RunError: see check_target(), or the disk is full, or ...
    """
    target = check_target(folder)
    fresh: Path | None = None
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        place = target.with_name(f".{target.name[:40]}-{secrets.token_hex(4)}")
        place.mkdir()
        fresh = place
        yield fresh
        _swap(fresh, target)
    except OSError as error:
        why = error.strerror or type(error).__name__
        raise RunError(f"{_shown(Path(folder))} cannot be written: {why}") from error
    finally:
        if fresh is not None and fresh.exists():
            shutil.rmtree(fresh, ignore_errors=True)


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write JSON for people and programs."""
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


def read_json(folder: Path, name: str) -> dict[str, Any]:
    """One of the JSON files of a run folder.

    Raises:
        RunError: it is missing or damaged.
    """
    try:
        content = json.loads((folder / name).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise RunError(f"{_shown(folder)} is not a run folder: it has no {name}") from None
    except OSError as error:
        raise RunError(f"{_shown(folder / name)} cannot be read: {error.strerror}") from None
    except (ValueError, RecursionError):
        raise RunError(f"{_shown(folder / name)} is damaged; run the scenario again") from None
    if not isinstance(content, dict):
        raise RunError(f"{_shown(folder / name)} is damaged; run the scenario again")
    return content


def digests(folder: Path) -> dict[str, str]:
    """The SHA-256 of every table in a run folder, by file name."""
    return {name: _digest(folder / name) for name in table_files() if (folder / name).exists()}


def check_tables(folder: Path, recorded: Any) -> None:
    """That the tables are as they were written; `recorded` is what digests() said then.

    Parquet itself has no checksums here: a flipped bit can read as another number.

    Raises:
        RunError: one is missing or damaged.
    """
    for name, digest in recorded.items() if isinstance(recorded, dict) else ():
        if name not in table_files():
            continue
        shown = _shown(folder / name)
        try:
            same = _digest(folder / name) == digest
        except FileNotFoundError:
            raise RunError(f"{shown} is missing; run the scenario again") from None
        except OSError as error:
            raise RunError(f"{shown} cannot be read: {error.strerror}") from None
        if not same:
            raise RunError(f"{shown} is damaged; run the scenario again")


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _swap(fresh: Path, target: Path) -> None:
    """Put `fresh` in the place of `target`; what stood there goes last."""
    if not target.exists():
        fresh.rename(target)
        return
    check_target(target)  # nobody else put something there meanwhile
    old = fresh.with_name(f"{fresh.name}.old")
    target.rename(old)
    try:
        fresh.rename(target)
    except BaseException:
        old.rename(target)
        raise
    shutil.rmtree(old, ignore_errors=True)


def _shown(path: Path) -> str:
    text = str(path)
    return text if text.isprintable() else text.encode("unicode_escape").decode()
