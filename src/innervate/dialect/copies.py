"""Copies of protocols with a text in them replaced: for mutants, and for tests that change a rule.

A copy is a package of its own, with the dialect and the protocols of all networks as they lie.
"""

import functools
import importlib
import itertools
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType

PACKAGE = "innervate"
HOME = Path(__file__).resolve().parents[1]
COPY = "innervate_copy_of_these_sources"  # until its name is known
_count = itertools.count()


def sources() -> dict[str, str]:
    """The sources of the dialect and of all protocols, by their paths within the package."""
    folders = (HOME / "dialect", *sorted((HOME / "networks").glob("*/protocol")))
    return {
        path.relative_to(HOME).as_posix(): path.read_text(encoding="utf-8")
        for folder in folders
        for path in sorted(folder.rglob("*.py"))
    }


def changed_copy(
    changes: Iterable[tuple[str, str]], *names: str, beside: Iterable[str] = ()
) -> list[ModuleType]:
    """Modules of a copy in which texts are replaced.

    Args:
        changes: (old, new) pairs; every old text stands in the sources exactly once.
        names: the modules wanted, as they are called in the package:
            "innervate.networks.skin.protocol.cell".
        beside: further modules of the package that are to use the copy, and not the original.

    Raises:
        ValueError: an old text does not stand exactly once in the sources.
    """
    texts = sources()
    for name in beside:
        path = Path(*name.split(".")[1:]).with_suffix(".py")
        texts[path.as_posix()] = (HOME / path).read_text(encoding="utf-8")
    for old, new in changes:
        places = [path for path, text in texts.items() if old in text]
        count = sum(text.count(old) for text in texts.values())
        if count != 1:
            raise ValueError(f"{old!r} stands {count} times in the protocols' sources: {places}")
        texts[places[0]] = texts[places[0]].replace(old, new)
    copy = f"innervate_copy_{next(_count)}"
    moved = frozenset(path.removesuffix(".py").replace("/", ".") for path in texts)
    with tempfile.TemporaryDirectory() as folder:
        for path, text in texts.items():
            _write(Path(folder, copy, path), _renamed(text, moved).replace(COPY, copy))
        return _imported(folder, copy, names)


@functools.lru_cache(1000)
def _renamed(text: str, moved: frozenset[str]) -> str:
    """A source that imports from COPY what is in the copy."""
    for name in sorted(moved, key=len, reverse=True):
        parent, _, leaf = name.rpartition(".")
        text = text.replace(f"from {PACKAGE}.{name} import", f"from {COPY}.{name} import")
        text = text.replace(f"from {PACKAGE}.{parent} import {leaf}\n",
                            f"from {COPY}.{parent} import {leaf}\n")  # fmt: skip
    for folder in {name.rpartition(".")[0] for name in moved}:
        if folder.endswith("protocol") or folder == "dialect":
            text = text.replace(f"from {PACKAGE}.{folder} import", f"from {COPY}.{folder} import")
    return text


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def _imported(folder: str, copy: str, names: Iterable[str]) -> list[ModuleType]:
    sys.path.insert(0, folder)
    importlib.invalidate_caches()
    try:
        return [importlib.import_module(copy + name.removeprefix(PACKAGE)) for name in names]
    finally:
        sys.path.remove(folder)
        for name in [name for name in sys.modules if name.partition(".")[0] == copy]:
            del sys.modules[name]
