"""What the user of a proof is told in one line."""

from __future__ import annotations


class ProveError(Exception):
    """What is asked for cannot be turned into a formula, or cannot be proved at all."""
