"""From a file, a text or a dict to a validated scenario."""

import os
import re
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from innervate.network import NetworkError, find, networks
from innervate.scenario.bundled import bundled
from innervate.scenario.errors import ScenarioError, one_line
from innervate.scenario.explain import alternatives, convert, nearest
from innervate.scenario.keys import SCHEMA
from innervate.scenario.lines import key_lines
from innervate.scenario.overrides import Override, apply
from innervate.scenario.source import Source, check_plain, keys_of, shown

SIZE_MAX = 64 * 1024 * 1024
KEY_PARTS_MAX = 100
_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")


@dataclass(frozen=True, slots=True)
class Scenario:
    """A validated scenario.

    Attributes:
        model: its tables, overrides and defaults filled in; the `model` of its network.
        source: where it came from, for error messages.
    """

    model: Any
    source: Source = field(default_factory=Source, compare=False)

    @property
    def kind(self) -> str:
        """What kind of network it describes, by its name."""
        return str(self.model.kind)

    @property
    def name(self) -> str:
        """Its name, in one line that can be printed; the file's if it gives none."""
        return one_line(self.model.name)

    @property
    def duration_s(self) -> float:
        """Simulated time in seconds, > 0."""
        return float(self.model.duration_s)

    @property
    def seed(self) -> int:
        """The root seed, 0 .. 2^63-1."""
        return int(self.model.seed)

    @property
    def path(self) -> str:
        """The file as the user named it; "" for one made in code."""
        return self.source.path


def load(
    path_or_name: str | os.PathLike[str],
    overrides: Iterable[Override] = (),
    seed: int | None = None,
) -> Scenario:
    """The scenario of a TOML file, or a bundled one by name.

    Args:
        path_or_name: a file, or a name that `bundled()` knows ("demo", "setup-1").
        overrides: "a.b=c" texts or (key, value) pairs (see overrides.py).
        seed: the root seed in place of the scenario's.

    Raises:
        ScenarioError: no such file, unreadable, or not a valid scenario; one line.
    """
    text, label, folder = read(path_or_name)
    return loads(text, overrides, seed, label, folder)


def read(path_or_name: str | os.PathLike[str]) -> tuple[str, str, str]:
    """(text, what to call it, its folder) of a scenario file or a bundled scenario.

    Raises:
        ScenarioError: no such file, or unreadable.
    """
    path, label = _find(os.fspath(path_or_name))
    return _read(path, label), label, str(path.parent)


def loads(
    text: str,
    overrides: Iterable[Override] = (),
    seed: int | None = None,
    path: str = "",
    folder: str = "",
) -> Scenario:
    """The scenario of a TOML text; `path` is what errors call it.

    Raises:
        ScenarioError: see load().
    """
    source = Source(path, folder)
    for number, line in enumerate(text.splitlines(), 1):
        if line.partition("=")[0].count(".") > KEY_PARTS_MAX and not line.lstrip().startswith("#"):
            source.lines = {(): number}
            raise source.error((), f"a key has more than {KEY_PARTS_MAX} parts; none is that long")
    try:
        raw = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _syntax(source, text, str(error)) from None
    except ValueError:
        raise source.error((), "a number is too long to be read") from None
    except RecursionError:
        raise source.error((), "lists or tables are nested too deeply") from None
    source.lines = key_lines(text)
    return _build(source, raw, overrides, seed)


def from_dict(
    tables: dict[str, Any],
    overrides: Iterable[Override] = (),
    seed: int | None = None,
    folder: str = "",
) -> Scenario:
    """The scenario of nested dicts and lists, laid out like a TOML file.

    Raises:
        ScenarioError: see load().
    """
    if not isinstance(tables, dict):
        raise ScenarioError(f"a scenario is a dict of tables, not a {type(tables).__name__}")
    return _build(Source("", folder), tables, overrides, seed)


def _build(
    source: Source, raw: dict[str, Any], overrides: Iterable[Override], seed: int | None
) -> Scenario:
    check_plain(source, raw)
    raw = _copy(raw)
    apply(source, raw, [overrides] if isinstance(overrides, str) else overrides)
    check_plain(source, raw)
    if seed is not None:
        raw["seed"] = seed
        source.sets[("seed",)] = f"seed={seed}"
        check_plain(source, seed, ("seed",))
    schema = raw.get("schema", SCHEMA)
    if isinstance(schema, int) and schema > SCHEMA:
        message = f"schema = {schema} is newer than this version knows ({SCHEMA}); update innervate"
        raise source.error(("schema",), message)
    if "scenario" in raw and "kind" not in raw:
        raise source.error((), "this is a plan of many runs, no scenario: innervate sweep runs it")
    kind = _check_kind(source, raw.get("kind"))
    if not raw.get("name", "x"):
        del raw["name"]
    source.given = frozenset(keys_of(raw))
    raw.setdefault("name", Path(source.path).stem or kind)
    network = networks()[kind]
    model = convert(source, raw, network.model)
    network.check(source, model)
    return Scenario(model, source)


def _check_kind(source: Source, kind: object) -> str:
    """The kind, if this version runs it, or a folder of that name does: its code is loaded.

    Raises:
        ScenarioError: missing, unknown, or such a folder cannot be loaded.
    """
    if kind is None:
        usual, *others = networks()
        what = f'add kind = "{usual}" (or {", ".join(others)})'
        raise source.error((), f"the scenario has no kind; {what}")
    try:
        if isinstance(kind, str) and find(kind, Path(source.folder), Path()) is not None:
            return kind
    except NetworkError as error:
        raise ScenarioError(str(error)) from None
    one = alternatives([f'"{name}"' for name in networks()])
    hint = ""
    if isinstance(kind, str) and kind.isidentifier() and not get_close_matches(kind, networks()):
        hint = "; name the folder of one of your own: --network DIR"
    raise source.error(("kind",), f"kind must be {one}, not {shown(kind)}{hint}")


def _copy(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _copy(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_copy(inner) for inner in value]
    return value


def _find(name: str) -> tuple[Path, str]:
    """(file, what to call it) of a path or the name of a bundled scenario."""
    path = Path(name or "?")
    try:
        there, folder = path.exists(), path.is_dir()
    except (OSError, ValueError):
        there, folder = False, False
    if there and not folder:
        return path, name
    known = bundled()
    stem = name.removesuffix(".toml")
    if stem in known:
        return known[stem], known[stem].name
    if folder:
        raise ScenarioError("this is a folder; name a scenario file in it", name)
    if not name:
        raise ScenarioError("no scenario is named; name a file or a bundled scenario")
    if "/" in name or os.sep in name:
        raise ScenarioError("no such file", name[:200])
    hint = nearest(stem, list(known)).replace("it knows", "the bundled ones are")
    raise ScenarioError(f"no such file, and no bundled scenario {shown(stem)}{hint}", name[:200])


def _read(path: Path, label: str) -> str:
    try:
        with path.open("rb") as file:
            content = file.read(SIZE_MAX + 1)
    except OSError as error:
        raise ScenarioError(f"cannot be read: {error.strerror or error}", label) from None
    if len(content) > SIZE_MAX:
        raise ScenarioError("is too large for a scenario file (over 64 MiB)", label)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        message = "is not UTF-8 text; save it as UTF-8, or name a scenario file"
        raise ScenarioError(message, label, line) from None


def _syntax(source: Source, text: str, message: str) -> ScenarioError:
    match = _PLACE.search(message)
    line, where = 0, ""
    if match is not None:
        message = message[: match.start()]
        line = int(match[1]) if match[1] else text.rstrip().count("\n") + 1
        where = f", column {match[2]}" if match[2] else ", at the end"
    return ScenarioError(f"not valid TOML{where}: {message}", source.path, line)
