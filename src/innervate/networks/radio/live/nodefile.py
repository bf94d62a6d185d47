"""Node files of a radio team."""

from typing import ClassVar

from innervate.live.nodefile import NodeFile


class StationFile(NodeFile, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The file of a station on a shared channel."""

    roles: ClassVar[tuple[str, ...]] = ("station",)
