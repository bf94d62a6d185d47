"""Node files of a skin."""

from typing import Annotated, ClassVar

from msgspec import Meta

from innervate.live.nodefile import NodeFile

PortNumber = Annotated[int, Meta(ge=0, le=3)]


class SkinFile(NodeFile, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A cell, or the PC; `ports` are a cell's port of each path, `rate_hz` its own samples'."""

    roles: ClassVar[tuple[str, ...]] = ("cell", "sink")

    ports: Annotated[list[PortNumber], Meta(max_length=4)] = []  # noqa: RUF012
    rate_hz: Annotated[float, Meta(ge=0, le=1000)] = 0.0
