"""What the user of a proof is told in one line."""

from importlib.util import find_spec


class ProveError(Exception):
    """What is asked for cannot be turned into a formula, or cannot be proved at all."""


class UnsureError(ProveError):
    """The solver could not say: it would have to think longer than it may."""


def can_prove() -> bool:
    """True if the solver is installed."""
    try:
        return find_spec("z3") is not None
    except ValueError:  # somebody hides it
        return False
