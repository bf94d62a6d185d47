"""The published figures: one file each with scenario, run, measure, draw, claim and measurement.

`main("skin", out)` runs, draws and tabulates a paper; see book.py. Nothing heavy is loaded before.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from innervate.papers.book import Step as Step
    from innervate.papers.book import main as main
    from innervate.papers.book import papers as papers
    from innervate.papers.errors import PapersError as PapersError

__all__ = ["PapersError", "Step", "main", "papers"]

_HOMES = {"main": "book", "papers": "book", "Step": "book", "PapersError": "errors"}


def __getattr__(name: str) -> Any:
    """Load what is asked for."""
    if name in _HOMES:
        return getattr(import_module(f"innervate.papers.{_HOMES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
