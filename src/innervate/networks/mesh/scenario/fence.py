"""The fence of a mesh: a polygon with holes, as whole numbers in its own coordinates [mesh 6]."""

from collections.abc import Iterable, Sequence
from typing import Any

from innervate.networks.mesh import rings
from innervate.networks.mesh.protocol.fields import POINTS
from innervate.networks.mesh.rings import Point
from innervate.networks.mesh.scenario.model import FenceTable
from innervate.scenario.lines import Key
from innervate.scenario.source import Source

EXTENT_MAX = 23_000  # units: squares stay below 2^29
UNITS_CM = (1, 10, 100)
FLOODS = {"never": 0, "crossings": 1, "all": 2}
Ring = list[Point]


def rings_cm(fence: FenceTable) -> list[Ring]:
    """The polygon and its holes, corners in cm; a last corner that repeats the first is dropped."""
    polygons = (fence.polygon, *fence.holes)
    return [rings.opened([(round(100 * x), round(100 * y)) for x, y in ring]) for ring in polygons]


def ring_key(index: int) -> Key:
    """The key of ring `index`: the polygon is 0, holes follow."""
    return ("fence", "polygon") if index == 0 else ("fence", "holes", index - 1)


def check(source: Source, fence: FenceTable) -> None:
    """Raise ScenarioError if no area is inside, or nobody could say which."""
    found = rings_cm(fence)
    corners = sum(len(ring) for ring in found)
    if corners > POINTS:
        message = f"the fence has {corners} corners, more than {POINTS}; leave some out"
        raise source.error(("fence", "polygon"), message)
    _check_rings(source, found)


def _check_rings(source: Source, found: list[Ring]) -> None:
    keys = [ring_key(index) for index in range(len(found))]
    wrong = rings.mistake(found, [".".join(str(part) for part in key) for key in keys])
    if wrong is not None:
        raise source.error(keys[wrong[0]], wrong[1])


def is_outside(fence: FenceTable, point: Point) -> bool:
    """True if a point, cm, is beyond the polygon or in a hole; an edge is inside."""
    return rings.is_outside(point, rings_cm(fence))


def origin_of(found: Sequence[Ring]) -> Point:
    """The fence's corner: least x and least y, cm."""
    return min(x for x, _ in found[0]), min(y for _, y in found[0])


def parameters(
    source: Source, fence: FenceTable, visited: Iterable[Point], robots: int
) -> dict[str, Any]:
    """The fence's part of the protocol's parameters.

    It is checked already. Where robots come (`visited`, cm) must fit into coordinates, too.

    Raises:
        ScenarioError: the unit is too small for the extent, or too large for the corners.
    """
    found = rings_cm(fence)
    x0, y0 = origin_of(found)
    unit = _unit_cm(source, fence, [*found[0], *visited])
    scaled = [[(round((x - x0) / unit), round((y - y0) / unit)) for x, y in ring]
              for ring in found]  # fmt: skip
    if unit > 1:
        _check_rings(source, scaled)
    return {
        "watch": int(fence.watch and robots > 0),
        "lost": fence.lost_beacons,
        "flood": FLOODS[fence.flood],
        "instances": fence.floods,
        "clear_margin": round(100 * fence.clear_m / unit),
        "predict_ms": round(1000 * fence.predict_s),
        "unit_cm": unit,
        **rings.table(scaled, POINTS),
        "fence": fence.number,
    }


def _unit_cm(source: Source, fence: FenceTable, points: list[Point]) -> int:
    """The unit asked for, or the smallest in which all points can be told."""
    extent = max(max(p[i] for p in points) - min(p[i] for p in points) for i in (0, 1))
    fitting = [unit for unit in UNITS_CM if extent <= EXTENT_MAX * unit]
    if not fitting:
        message = f"the fence and its robots spread over {extent / 100:g} m; 23 km is the most"
        raise source.error(("fence", "polygon"), message)
    unit = fence.unit_cm or fitting[0]
    if unit < fitting[0]:
        message = (
            f"fence.unit_cm = {unit} reaches {EXTENT_MAX * unit // 100} m, but the fence and its "
            f"robots spread over {extent / 100:g} m; make it {fitting[0]}"
        )
        raise source.error(("fence", "unit_cm"), message)
    return unit
