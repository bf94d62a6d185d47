"""What all runs of a sweep have in common: a scenario's text and changes to it."""

from __future__ import annotations

import hashlib
import os
import shlex
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import msgspec

from innervate import scenario as scenarios
from innervate.scenario import Scenario, ScenarioError, given, inline
from innervate.scenario.overrides import parse_value

Settings = tuple[tuple[str, Any], ...]
Source = given.Given
PLAN_FILE = "sweep.toml"
# What a sweep's folder holds besides the scenario, which is called otherwise there if need be.
TAKEN = (PLAN_FILE, "jobs.sqlite", "results.parquet", "points.parquet", "timings.parquet",
         "provenance.json")  # fmt: skip


@dataclass(frozen=True, slots=True)
class Base:
    """A scenario that is run many times."""

    text: str  # its TOML
    file: str  # what its copy in the results is called
    folder: str  # where relative paths in it start
    settings: Settings = ()  # (dotted key, value) that hold for every run
    kind: str = ""  # of network
    name: str = ""  # of a scenario that is no file, which the copy's name says nothing of

    def scenario(self, settings: Iterable[tuple[str, Any]] = (), seed: int | None = None) -> Any:
        """The scenario with these settings besides; a ScenarioError if it is not valid."""
        changes = [*self.settings, *settings]
        return scenarios.loads(self.text, changes, seed, self.file, self.folder)

    def mark(self) -> str:
        """A text that tells it from other bases."""
        told = repr((self.text, self.folder, self.settings)).encode()
        return hashlib.blake2b(told, digest_size=12).hexdigest()

    def command(self, settings: Settings, seed: int) -> str:
        """The one command that runs it again, in the folder of the results."""
        words = ["innervate", "run", self.file]
        for key, value in (*self.settings, *settings):
            words += ["--set", f"{key}={_as_word(value)}"]
        return shlex.join([*words, "--seed", str(seed)])

    def anywhere(self, settings: Settings) -> Base:
        """The same, valid as it is, with full paths for relative ones: it can be run elsewhere."""
        made = self.scenario(settings)
        plain = msgspec.to_builtins(made.model)
        full = tomllib.loads(scenarios.dump(made))
        mine = {key for key, _ in settings}
        paths = [pair for pair in _moved(plain, full) if pair[0] not in mine]
        kept = [pair for pair in self.settings if pair[0] not in dict(paths)]
        return replace(self, settings=(*kept, *paths))


def base_of(source: Source, changes: Iterable[str] | Mapping[str, Any]) -> Base:
    """The base that a file, a bundled name, tables or a Scenario give.

    Raises:
        ScenarioError: no such file, or unreadable, or a change that is no key=value.
    """
    if isinstance(source, dict | msgspec.Struct):
        source = given.load(source)
    if isinstance(source, Scenario):
        text, label = scenarios.dump(source, whole=False), "scenario.toml"
        folder, name = source.source.folder, source.name
    else:
        text, label, folder = scenarios.read(source)
        name = ""
    file = Path(label).name
    pairs = changes.items() if isinstance(changes, Mapping) else map(_setting, changes)
    settings = tuple(pairs)
    if file in TAKEN:
        file, settings = "scenario.toml", (("name", Path(file).stem), *settings)
    kind = dict(settings).get("kind") or _kind(text)
    return Base(text, file, os.path.abspath(folder or "."), settings, str(kind), name)


def _kind(text: str) -> Any:
    try:
        return tomllib.loads(text).get("kind")
    except (ValueError, RecursionError):  # what is wrong with it is said when it is read
        return ""


def _setting(text: str) -> tuple[str, Any]:
    key, equals, value = text.partition("=")
    if not equals:
        raise ScenarioError("write it as key=value, like protocol.k=3", f"--set {text}")
    return key.strip(), parse_value(value.strip())


def of_vary(error: ScenarioError, keys: Iterable[str]) -> ScenarioError:
    """An error of what is varied, which a run of its own tells as of its --set, as of --vary."""
    if not error.path.startswith(tuple(f"--set {key}=" for key in keys)):
        return error
    path = error.path.replace("--set", "--vary", 1)
    return ScenarioError(error.message, path, error.line, error.key)


def _as_word(value: Any) -> str:
    """A value as `--set` reads it back; plain words need no quotes of their own."""
    if isinstance(value, str) and value == value.strip() and parse_value(value) == value:
        return value
    return inline(value)


def _moved(plain: Any, full: Any) -> list[tuple[str, str]]:
    """Texts that a dump writes otherwise than they were given, by dotted key."""
    written = dict(leaves(full))
    return [(key, written[key]) for key, given in leaves(plain)
            if isinstance(given, str) and isinstance(written.get(key), str)
            and written[key] != given]  # fmt: skip


def leaves(
    value: Any, key: str = "", into: type | tuple[type, ...] = (Mapping, list, tuple)
) -> Iterator[tuple[str, Any]]:
    """(dotted key, value) of everything in nested tables and lists, or `into` tables alone.

    a.b = 1 and "a.b" = 1 are the same.
    """
    if not isinstance(value, into):
        yield key, value
        return
    nested: Any = value
    pairs = nested.items() if isinstance(value, Mapping) else enumerate(nested)
    for name, inner in pairs:
        yield from leaves(inner, f"{key}.{name}" if key else str(name), into)
