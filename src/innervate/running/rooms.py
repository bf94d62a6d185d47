"""What is particular to a kind of network stands in a module of its name, here in this room."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def room_of(kind: str) -> Any:
    """The module of a kind: simulate, summarize, tables_of, columns, trail, call_words."""
    return import_module(f"innervate.running.{kind}")
