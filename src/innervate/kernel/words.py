"""Counts and names as people read them."""

from collections.abc import Sequence


def number_of(count: int, thing: str) -> str:
    """A count with its noun: "1 cell", "12 cells"."""
    return f"{count:,} {thing}{'' if count == 1 else 's'}"


def some(names: Sequence[str], most: int = 8) -> str:
    """Names in a sentence: "n1, n2 and n3", or the first `most` and how many more there are."""
    more = [f"{len(names) - most:,} more"] if len(names) > most else []
    *first, last = [*names[:most], *more]
    return f"{', '.join(first)} and {last}" if first else last


def without_middle(text: str, most: int) -> str:
    """A text of at most `most` letters: of a longer one the middle is left out."""
    half = most // 2
    return text if len(text) <= most else f"{text[: half - 2]}...{text[1 - half :]}"
