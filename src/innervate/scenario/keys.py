"""Keys that scenarios of several networks have."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

SCHEMA = 1

Micros = Annotated[
    int, Meta(ge=0, le=1_000_000, description="a whole number of microseconds, 0 to 1000000")
]
