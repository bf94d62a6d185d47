"""Mistakes that are planted in protocols: explorers have to find and proofs to refute them."""

from dataclasses import dataclass
from types import ModuleType

from innervate.dialect.copies import changed_copy


@dataclass(frozen=True, slots=True)
class Mutant:
    """A mistake: `old` stands once in the protocols' sources and becomes `new`."""

    name: str
    old: str
    new: str

    def copies(self, *names: str) -> list[ModuleType]:
        """Modules of a copy of the protocols with the mistake in it.

        Raises:
            ValueError: the text does not stand exactly once in the sources: no mutant any more.
        """
        made: list[ModuleType] = changed_copy([(self.old, self.new)], *names)
        return made


def planted(*texts: tuple[str, str, str]) -> tuple[Mutant, ...]:
    """Mistakes by their names and texts, old and new."""
    return tuple(Mutant(*text) for text in texts)
