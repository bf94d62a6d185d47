"""Counts as people read them."""


def number_of(count: int, thing: str) -> str:
    """A count with its noun: "1 cell", "12 cells"."""
    return f"{count:,} {thing}{'' if count == 1 else 's'}"
