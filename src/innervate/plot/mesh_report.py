"""The part of a report that is about meshes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def body(result: Any, summary: Mapping[str, Any]) -> str:
    """Headline, status, numbers and pictures of a mesh run, as HTML."""
    return ""
