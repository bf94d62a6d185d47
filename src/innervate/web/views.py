"""Which view draws which kind of network."""

from __future__ import annotations

from importlib import import_module

from innervate.web.engine import Engine
from innervate.web.history import History
from innervate.web.view import View


def view_of(engine: Engine, history: History) -> View:
    """The view of an engine's network."""
    kind = engine.plan.kind
    made: View = getattr(import_module(f"innervate.web.{kind}_view"), f"{kind.capitalize()}View")(
        engine, history
    )
    return made
