"""Networks that are folders: loaded, checked as they are written, taken anew when they are edited.

A folder is a package with a `network.py` whose `NETWORK` says what it is. Loading it runs its code.
"""

import ast
import importlib.util
import linecache
import shutil
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from importlib import import_module, invalidate_caches
from pathlib import Path
from types import ModuleType
from typing import Any

from innervate.dialect import bounded, clocks, counted, sends
from innervate.dialect import folder as checks
from innervate.dialect.checker import functions_of
from innervate.dialect.source import numbers_of, reached
from innervate.dialect.trees import every_node

NETWORK_FILE = "network.py"
MEDIA_ON_AIR = ("channel", "field")
# Words of the channel itself, among parameters and in a state.
CHANNEL_OWN = ("slot_us", "ta_us", "oracle", "full_duplex", "period_us", "per_turn")
CHANNEL_STATE = ("queued",)
TABLES = ("STATE", "FRAME", "PARAMS")
LOOPING = ("protocol", "invariants")  # parts whose loops have to end

_in_plain: ContextVar[bool] = ContextVar("_in_plain", default=False)
_stamps: dict[str, tuple[tuple[str, int, int], ...]] = {}  # of the files of what is loaded, by name


class NetworkError(Exception):
    """A network that was named cannot be loaded, or is not as it must be; one line."""


@contextmanager
def for_plain(is_plain: bool) -> Iterator[None]:
    """Networks that are loaded meanwhile are to run plain: what a person debugs with may stay."""
    token = _in_plain.set(is_plain)
    try:
        yield
    finally:
        _in_plain.reset(token)


def refused(found: list[checks.Finding]) -> list[checks.Finding]:
    """Those findings for which a network is not loaded."""
    return [one for one in found if not (one.in_plain and _in_plain.get())]


def is_one(folder: Path) -> bool:
    """True if a folder is a network by its looks; none has a name too long for a folder."""
    try:
        return folder.name.isidentifier() and (folder / NETWORK_FILE).is_file()
    except OSError:
        return False


def load(folder: Path) -> Any:
    """What `network.py` of a folder calls NETWORK; read again if a file of it was edited.

    Raises:
        NetworkError: it cannot be loaded; the file and line of what is wrong in it.
    """
    folder = folder.resolve()
    name, stamp = folder.name, _stamp(folder)
    if _home(name) != folder or _stamps.get(name, stamp) != stamp:
        if name in _stamps:
            # Python tells a file from its translation by whole seconds and its length.
            shutil.rmtree(folder / "__pycache__", ignore_errors=True)
        _forget(folder)
        _begin(folder)
    _stamps[name] = stamp
    try:
        return import_module(f"{name}.network").NETWORK
    except Exception as error:
        _forget(folder)
        raise NetworkError(blamed(error, folder) or f"{folder}: {_words(error)}") from None


def is_stale(folder: Path) -> bool:
    """True if a file of a folder that was loaded is another by now."""
    folder = folder.resolve()
    return _home(folder.name) == folder and _stamps.get(folder.name) != _stamp(folder)


def edition(folder: Path) -> tuple[tuple[str, int, int], ...]:
    """What tells a folder as it was loaded from the same one before and after edits."""
    return _stamps.get(folder.name, ())


def _stamp(folder: Path) -> tuple[tuple[str, int, int], ...]:
    files = sorted(folder.glob("*.py"))
    return tuple((str(f), (at := f.stat()).st_mtime_ns, at.st_size) for f in files)


def _home(name: str) -> Path | None:
    """Where a package that was loaded lies."""
    places = list(getattr(sys.modules.get(name), "__path__", ()))
    return Path(places[0]).resolve() if places else None


def _forget(folder: Path) -> None:
    """Let go of a folder's modules, or of those of another folder that had its name.

    Raises:
        NetworkError: its name is that of a module that is no network.
    """
    name = folder.name
    if name not in _stamps and _home(name) != folder:
        known = sys.modules.get(name) or importlib.util.find_spec(name)
        origin = getattr(known, "__file__", None) or getattr(known, "origin", None)
        if known is not None and (origin is None or Path(origin).parent.resolve() != folder):
            where = f"{folder / NETWORK_FILE}:1"
            raise NetworkError(f"{where}: the name {name} is taken by a Python module; "
                               "give the folder another")  # fmt: skip
    for module in [one for one in sys.modules if f"{one}.".startswith(f"{name}.")]:
        del sys.modules[module]
    _stamps.pop(name, None)
    invalidate_caches()
    linecache.checkcache()


def _begin(folder: Path) -> None:
    """The folder's package, without any of its files but `__init__.py`."""
    first = folder / "__init__.py"
    if first.is_file():
        places = [str(folder)]
        spec = importlib.util.spec_from_file_location(
            folder.name, first, submodule_search_locations=places
        )
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[folder.name] = module
        try:
            spec.loader.exec_module(module)
        except Exception as error:
            del sys.modules[folder.name]
            raise NetworkError(blamed(error, folder) or _words(error)) from None
    else:
        module = ModuleType(folder.name)
        module.__path__ = [str(folder)]
        sys.modules[folder.name] = module


def _words(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}"


def blamed(error: BaseException, folder: Path) -> str:
    """The last line of a folder that an error came by: "ring/protocol.py:12: ..."; "" if none."""
    if isinstance(error, SyntaxError) and error.filename:
        path = Path(error.filename)
        if path.is_relative_to(folder):
            return f"{shown(path)}:{error.lineno}: is no Python: {error.msg}"
    places = [frame for frame in traceback.extract_tb(error.__traceback__)
              if Path(frame.filename).is_relative_to(folder)]  # fmt: skip
    if not places:
        return ""
    last = places[-1]
    words, where = _words(error), f"in {last.name}"
    told = "" if last.name == "<module>" or where in words else f", {where}"
    return f"{shown(Path(last.filename))}:{last.lineno}: {words}{told}"


def line_of(folder: Path, text: str) -> str:
    """Where a text stands first in a folder's `network.py`: "ring/network.py:5"."""
    path = folder / NETWORK_FILE
    lines = path.read_text(encoding="utf-8").splitlines()
    return f"{shown(path)}:{next((n for n, line in enumerate(lines, 1) if text in line), 1)}"


def shown(path: Path) -> str:
    """A path as it is said: relative to the working folder where it lies below it."""
    here = Path.cwd()
    return str(path.relative_to(here) if path.is_relative_to(here) else path)


def sources(folder: Path, network: Any) -> list[Path]:
    """The files of a folder that its protocol is written in: itself, and what they import."""
    entry = _file_of(folder, network, "protocol")
    found, waiting = [], [entry]
    while waiting:
        path = waiting.pop()
        if path in found or not path.is_file():
            continue
        found.append(path)
        try:
            tree = ast.parse(path.read_text(encoding="utf-8"))
        except (SyntaxError, ValueError):
            continue
        for node in every_node(tree):
            if isinstance(node, ast.ImportFrom):
                module = (node.module or "").rpartition(f"{folder.name}.")[2]
                is_folder = not module or (module == folder.name and not node.level)
                inside = "" if is_folder else f"{module}."
                names = [module, *(f"{inside}{alias.name}" for alias in node.names)]
                waiting += [folder / f"{name.replace('.', '/')}.py" for name in names]
    return found


def _file_of(folder: Path, network: Any, part: str) -> Path:
    place = network.parts.get(part, part).partition(":")[0].rpartition(f"{folder.name}.")[2]
    return folder / f"{place.replace('.', '/')}.py"


def findings(folder: Path, network: Any) -> list[checks.Finding]:
    """All that is wrong with a network as it is written, protocol first."""
    files, known = sources(folder, network), _dialects()
    for path in files:
        known |= _functions(path)
    on_air = network.medium in MEDIA_ON_AIR and not network.over
    handlers = checks.HANDLERS | (checks.ON_AIR if on_air else {})
    found = []
    for place, path in enumerate(files):
        found += checks.of_source(path, known, folder.name, {} if place else handlers)
    if not files:
        found = [checks.Finding(_file_of(folder, network, "protocol"), 1, "there is no such file")]
    if network.has("invariants"):
        path = _file_of(folder, network, "invariants")
        wrong = checks.of_source(path, known, folder.name, {})
        found += wrong or checks.of_rules(path)
    found += [] if found else _of_declared(folder, network, files)
    for one in found:
        one.path = shown(Path(one.path))
    return list({str(one): one for one in found}.values())


def _of_declared(folder: Path, network: Any, files: list[Path]) -> list[checks.Finding]:
    try:
        fields = network.fields
        if lacks := [name for name in TABLES if not hasattr(fields, name)]:
            what = f"has no {lacks[0]}; add {lacks[0]} = ()"
            return [checks.Finding(_file_of(folder, network, "fields"), 1, what)]
        tables = [(name, getattr(fields, name)) for name in TABLES]
    except NetworkError:
        raise
    except Exception as error:
        path = _file_of(folder, network, "fields")
        raise NetworkError(blamed(error, folder) or f"{shown(path)}:1: {_words(error)}") from None
    place = _file_of(folder, network, "fields")
    found: list[checks.Finding] = checks.of_fields(place, tables)
    found += [] if found else _of_values(folder, network, files)
    if not found and network.has("frames") and not hasattr(network.frames, "encode"):
        frames, path = network.frames, _file_of(folder, network, "frames")
        unsent = _handed(fields) - sends.put_in(files)
        looked_at = checks.LOOKED_AT[network.medium]
        found += checks.of_layouts(
            path, frames.LAYOUTS, frames.KIND_BITS, fields.FRAME, looked_at, unsent
        )
        if hasattr(frames, "ENDS"):
            found += sends.of_ends(path, frames.ENDS, fields.FRAME)
        laid = {kind: {one[0] for one in fields} for kind, _name, fields in frames.LAYOUTS}
        found += sends.of_kinds(files, laid)
    return found


def _handed(fields: Any) -> set[str]:
    """Fields of FRAME that users hand in, as the explorer has it, and where robots are."""
    given = {name for _, item in getattr(fields, "GIVEN", ()) for name in item}
    return given | (checks.PLACES if hasattr(fields, "PLACED") else set())


def not_for_boards(network: Any) -> str:
    """Why the driver of boards cannot do as a folder's protocol says, with file and line; or ""."""
    if network.folder is None or network.medium in MEDIA_ON_AIR:
        return ""
    what = "boards send at once: give send a delay of 0, and send it from on_timer"
    found = sends.of_delays(sources(network.folder, network), what)
    for one in found:
        one.path = shown(Path(one.path))
    return str(found[0]) if found else ""


def _of_values(folder: Path, network: Any, files: list[Path]) -> list[checks.Finding]:
    """What values and names there are that the declarations have no room for."""
    fields, place = network.fields, _file_of(folder, network, "fields")
    usual = [(name, getattr(fields, name, {})) for name in ("DEFAULTS", "EXPLORED")]
    found: list[checks.Finding] = checks.of_usual(place, usual, fields.PARAMS)
    found += checks.of_given(place, getattr(fields, "GIVEN", ()), fields.FRAME)
    found += checks.of_messages(place, getattr(fields, "MESSAGES", ()))
    if hasattr(fields, "PLACED"):
        found += checks.of_placed(place, fields.PLACED, fields.FRAME)
    if network.medium in MEDIA_ON_AIR and not network.over:
        found += sends.of_delays(files)
    if network.medium == "channel":
        found += sends.of_channel(files)
        found += checks.of_taken(place, fields.PARAMS, CHANNEL_OWN)
        found += checks.of_taken(place, fields.STATE, CHANNEL_STATE, "STATE")
    tables = [*fields.STATE, *fields.FRAME, *fields.PARAMS]
    declared = {field[0] for field in tables}
    others = {one[0] for one in [*fields.STATE, *fields.FRAME]}
    params = {one[0] for one in fields.PARAMS} - others
    arrays = declared - {field[0] for field in tables if not field[1]}
    rules = [_file_of(folder, network, "invariants")] if network.has("invariants") else []
    for source in [*files, *rules]:
        found += checks.of_uses(source, declared, network.protocol.TIMERS, arrays)
        found += clocks.of_clocks(source, tables, params)
        found += checks.of_numbers(
            source, numbers_of(import_module(_name_of(source, folder, network)))
        )
    return found


def _name_of(source: Path, folder: Path, network: Any) -> str:
    inside = source.relative_to(folder).with_suffix("").parts
    return ".".join([network.package, *inside])


def bound_loops(entry: ModuleType, folder: Path) -> None:
    """Have loops of a folder's module, and of those of its own that it calls, stop at a bound."""
    for module in reached(entry.__name__):
        if Path(module.__file__ or "").is_relative_to(folder):
            bounded.bound(module)


def _dialects() -> set[str]:
    """Names of all functions of the dialect."""
    home = Path(checks.__file__).parent
    return {name for file in ("arith", "outbox", "rng") for name in _functions(home / f"{file}.py")}


def _functions(path: Path) -> set[str]:
    try:
        return {one.name for one in functions_of(ast.parse(path.read_text(encoding="utf-8")))}
    except (SyntaxError, ValueError):
        return set()


def invariants_of(network: Any, prefix: str) -> dict[str, Any]:
    """A network's own invariants whose names begin so, by what their first line says."""
    if not network.has("invariants"):
        return {}
    return {
        " ".join((thing.__doc__ or name).strip().splitlines()[:1]): thing
        for name, thing in vars(network.invariants).items()
        if name.startswith(prefix) and callable(thing)
    }


def actions_of(folder: Path, network: Any) -> dict[str, tuple[int | None, str]]:
    """Most actions of a call of each handler, None if it is not seen; and its file and line."""
    functions: dict[str, Any] = {}
    constants: dict[str, int] = {}
    files: dict[str, Path] = {}
    for path in sources(folder, network):
        tree = checks.parsed(path)
        constants |= numbers_of(import_module(_name_of(path, folder, network)))
        functions |= {one.name: one for one in functions_of(tree)}
        files |= {one.name: path for one in functions_of(tree)}
    found: dict[str, tuple[int | None, str]] = {}
    for name in (one for one in functions if one.startswith("on_")):
        line, most = functions[name].lineno, None
        try:
            most = counted.actions(name, functions, constants)
        except counted.Unknown as error:
            line = error.line
        found[name] = (most, f"{shown(files[name])}:{line}")
    return found
