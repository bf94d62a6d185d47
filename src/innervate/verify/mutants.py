"""The explorer can fail: it runs on copies of the protocol with a small mistake in each.

A mistake is a text of the protocol's sources replaced by another. The copy is a package of its own
in a temporary folder and runs uncompiled; the real protocol is not touched.
"""

from dataclasses import dataclass
from types import ModuleType

from innervate.dialect.copies import changed_copy


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


def copies(mutant: Mutant, *names: str) -> list[ModuleType]:
    """Modules of a copy of the protocols with the mistake in it.

    Raises:
        ValueError: the text does not stand exactly once in the sources: no mutant any more.
    """
    return changed_copy([(mutant.old, mutant.new)], *names)
