"""Options that a function takes by name, as a TypedDict lists them."""

from collections.abc import Collection, Iterable


def refuse_others(function: str, given: Iterable[str], known: Collection[str]) -> None:
    """Nothing passes unheard that a function has no use for.

    Raises:
        TypeError: one of these is no option of it.
    """
    unknown = sorted(set(given) - set(known))
    if unknown:
        raise TypeError(f"{function} takes no {', '.join(unknown)}; it takes {', '.join(known)}")
