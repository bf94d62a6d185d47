"""Node files of a mesh."""

from typing import Annotated, ClassVar

from msgspec import Meta, Struct

from innervate.live.errors import LiveError
from innervate.live.nodefile import NodeFile


class DeliverTable(Struct, frozen=True, forbid_unknown_fields=True):
    """[deliver]: messages in the order in which they were sent."""

    in_order: bool = False
    wait_ms: Annotated[int, Meta(ge=1, le=60_000)] = 10_000
    buffer: Annotated[int, Meta(ge=1, le=4096)] = 256


Ring = Annotated[list[tuple[int, int]], Meta(min_length=3)]


class FenceTable(Struct, frozen=True, forbid_unknown_fields=True):
    """[fence]: corners in units of protocol.unit_cm from its origin; the same in every file."""

    polygon: Ring
    holes: list[Ring] = []


class MeshFile(NodeFile, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A node of a mesh; a standby's `rank` says which one takes over first."""

    roles: ClassVar[tuple[str, ...]] = ("node", "gateway", "standby")
    nodes_max: ClassVar[int] = 254

    rank: Annotated[int, Meta(ge=1, le=253)] = 1
    deliver: DeliverTable | None = None
    robot: bool = False
    fence: FenceTable | None = None

    def check(self, where: str) -> None:
        """Refuse a file without "nodes", then what any node's file must not be."""
        if self.nodes is None:
            raise LiveError(f'{where}: "nodes" is missing: how many ids the mesh has, 1 to 254')
        super().check(where)
