"""Texts that lie in c/: the sections of them that somebody has, with a network's names."""

import re
from collections.abc import Mapping
from importlib import resources

# A line at which a part of a text begins, by its name, or ends.
SECTION = re.compile(r"(?:/\*|#) ?([+-]) ?(\w*)(?: \*/)?")


def shipped(file: str, prefix: str = "", having: frozenset[str] = frozenset()) -> str:
    """A file that lies here; one of the driver's with a network's names.

    Of sections, which stand between `/*+ name */` and `/*- */` (or `# + name`, `# -`) on lines of
    their own, those are kept that are in `having`.
    """
    text = (resources.files("innervate.firmware") / "c" / file).read_text(encoding="utf-8")
    kept, inside = [], []  # type: ignore[var-annotated]
    for line in text.splitlines(keepends=True):
        found = SECTION.fullmatch(line.rstrip())
        if found is None:
            kept += [line] * all(inside)
        elif found[1] == "+":
            inside.append(found[2] in having)
        else:
            inside.pop()
    text = "".join(kept)
    return renamed(text, prefix) if prefix else text


def renamed(text: str, prefix: str) -> str:
    """A text with a network's names for the word role."""
    text = re.sub(r"(?<![a-z])role(?![a-z])", prefix, text)
    return re.sub(r"(?<![A-Z])ROLE(?![A-Z])", prefix.upper(), text)


def filled(text: str, words: Mapping[str, str]) -> str:
    """A text with something else for some words."""
    for old, new in words.items():
        text = text.replace(old, new)
    return text
