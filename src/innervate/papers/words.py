"""What claims are worded with: shares, lists, spans of numbers; and sentences for labels."""

import re
from collections.abc import Iterable, Sequence
from typing import Any


def percent(share: float, digits: int = 0) -> str:
    """A share, 0 to 1, as "12 %"."""
    return f"{100 * share:.{digits}f} %"


def joined(words: Iterable[Any], between: str = ", ") -> str:
    """Things as text, with `between` between them."""
    return between.join(str(word) for word in words)


def spans(numbers: Sequence[int]) -> str:
    """Ascending numbers with runs joined, as "2-45,50,70"."""
    parts: list[list[int]] = []
    for n in numbers:
        if parts and parts[-1][-1] == n - 1:
            parts[-1].append(n)
        else:
            parts.append([n])
    return ",".join(str(p[0]) if len(p) == 1 else f"{p[0]}-{p[-1]}" for p in parts)


def sentences(text: str) -> dict[str, str]:
    """Sentences by the labels that lines begin with: "E1: ..."; a sentence may go over lines."""
    parts = re.split(r"(?m)^([A-Z]\d+): ", text)
    return {
        label: " ".join(said.split()) for label, said in zip(parts[1::2], parts[2::2], strict=True)
    }
