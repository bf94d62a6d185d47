"""The explorer can fail: it runs on copies of the protocol with a small mistake in each.

A mistake is a text of the protocol's sources replaced by another. The copy is a package of its own
in a temporary folder and runs uncompiled; the real protocol is not touched.
"""

from __future__ import annotations

import importlib
import itertools
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from innervate import protocol as protocol_room
from innervate.verify import explore, fair, graphs, story
from innervate.verify import skin_system as system

ROOM = Path(protocol_room.__file__).parent
_count = itertools.count(1)


@dataclass(frozen=True, slots=True)
class Mutant:
    """A mistake: `old` stands once in the sources and becomes `new`."""

    name: str
    old: str
    new: str


@dataclass(frozen=True, slots=True)
class Catch:
    """What the explorer found of a mutant; `by` is empty if it found nothing."""

    mutant: Mutant
    by: str
    where: str
    states: int


def copy_of(mutant: Mutant) -> system.System:
    """The skin's system on a copy of the protocol with the mistake in it.

    Raises:
        ValueError: the text does not stand exactly once in the sources.
    """
    package = f"innervate_mutant_{next(_count)}"
    sources = {path.name: path.read_text(encoding="utf-8") for path in ROOM.glob("*.py")}
    count = sum(text.count(mutant.old) for text in sources.values())
    if count != 1:
        raise ValueError(f"{mutant.old!r} stands {count} times in the protocol's sources")
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder, package)
        home.mkdir()
        for name, text in sources.items():
            changed = text.replace(mutant.old, mutant.new)
            changed = changed.replace("innervate.protocol", package)
            (home / name).write_text(changed, encoding="utf-8")
        sys.path.insert(0, folder)
        importlib.invalidate_caches()
        try:
            cell = importlib.import_module(f"{package}.skin")
            sink = importlib.import_module(f"{package}.skin_sink")
            return system.system_of(cell, sink)
        finally:
            sys.path.remove(folder)
            for name in [name for name in sys.modules if name.partition(".")[0] == package]:
                del sys.modules[name]


def models() -> Iterator[system.SkinModel]:
    """What each mutant is tried on, smallest first."""
    calm = system.Budget(loss=0, cut=1, heal=0, false=0, restart=0, faults=1)
    small = system.Budget(loss=0, cut=1, heal=1, false=1, restart=1, faults=1)
    for graph, rule, updates, budget in (
        ("pc-1 1-2", "feasible", "periodic", small),
        ("pc-1", "feasible", "triggered", small),
        ("pair", "feasible", "periodic", small),
        ("triangle", "feasible", "periodic", calm),
        ("triangle", "strict", "periodic", calm),
        ("pair", "feasible", "triggered", system.Budget(2, 2, 0, 1, 0, 0, 0, 1)),
    ):
        yield system.SkinModel(graphs.parse(graph), rule, updates, budget, keep=rule == "feasible")


def hunt(mutant: Mutant, starts: int = 60) -> Catch:
    """Try a mutant on all models until something is broken; liveness from `starts` states."""
    changed = copy_of(mutant)
    states = 0
    for model in models():
        where = f"{graphs.cables(model.graph)}, {model.rule}, {model.updates}"
        try:
            found = explore.explore(model, plain=True, system=changed, states=40_000)
            states += found.tally.states
            if found.broken:
                return Catch(mutant, story.tell(found, changed).title, where, states)
            if model.keep:
                settled = fair.check(found, plain=True, system=changed, starts=starts)
                if settled.ended == "broken":
                    by = f"no shortest routes after {settled.bound} fair rounds"
                    return Catch(mutant, by, where, states)
        except (ArithmeticError, IndexError, ValueError) as error:
            return Catch(mutant, f"{type(error).__name__}: a value out of range", where, states)
    return Catch(mutant, "", "", states)
