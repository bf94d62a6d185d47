"""Cells spread evenly over a robot's surface, where its description has no skin of its own.

Points are drawn on the triangles of a link's mesh and thinned so that none is nearer to another
than the pitch (trimesh); same mesh, same pitch, same cells. A mesh is taken as it is: cells
also lie on walls inside of it, if it has some.
"""

import math
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from itertools import product
from pathlib import Path
from typing import Any
from warnings import catch_warnings, simplefilter
from xml.etree.ElementTree import Element

from innervate.topology.errors import TopologyError
from innervate.topology.urdf import NUMBER_MAX, Link, Vector, moved, read_links

SUFFIXES = (".stl", ".obj", ".ply", ".off", ".glb")
COLLADA = ".dae"  # takes pycollada; such a mesh is read where a link has no other shape
SEED = 1
DRAWN = 25  # points a square of the pitch; with more, hardly any more are kept
CELLS_MAX = 5000
NAMED_MAX = 8  # links in a message
Cell = tuple[str, Vector, Vector]  # its name, place in mm, where its surface faces (length 1)


def has_surface(link: Link) -> bool:
    """Whether a link has a shape, rather than being a mere frame."""
    return link.element.find("visual/geometry") is not None or (
        link.element.find("collision/geometry") is not None
    )


def surfaces(path: Path, pattern: str) -> Iterator[Any]:
    """Shapes (trimesh) of the links that match, mm, in the root's frame: those that can be read.

    Raises:
        TopologyError: no link matches, or a mesh is missing or broken.
    """
    for link in read_links(path, pattern):
        yield from _meshes(path, link)


def _say_unreadable(path: Path, links: Sequence[Link]) -> None:
    """Raise if some links have a shape, but none that can be read: they would carry no cells."""
    nameless = [link.name for link in links
                if not all(mesh.get("filename") for mesh in link.element.iter("mesh"))]  # fmt: skip
    if nameless:
        message = f"{path.name}: a <mesh> of link {nameless[0]} names no file; give it a filename"
        raise TopologyError(message, "urdf")
    lost = [link for link in links if has_surface(link) and not _parts(link)]
    if lost:
        names = ", ".join(link.name for link in lost[:NAMED_MAX])
        more = f" and {len(lost) - NAMED_MAX} more" if len(lost) > NAMED_MAX else ""
        meshes = (part.get("filename", "") for link in lost for part in link.element.iter("mesh"))
        kinds = ", ".join(sorted({Path(mesh).suffix or "no suffix" for mesh in meshes}))
        raise TopologyError(
            f"{path.name}: no shape of {names}{more} can be read (meshes: {kinds or 'none'}); "
            f"convert them to one of {', '.join((*SUFFIXES, COLLADA))}, or choose other links",
            "links",
        )


def cells_on_surfaces(path: Path, pattern: str, pitch_mm: float) -> list[Cell]:
    """Cells on the surfaces of the links that match.

    Two cells of a link are at least the pitch, > 0, apart; as read_positions() otherwise.

    Raises:
        TopologyError: no link matches, none has a shape, one has only shapes that cannot be read,
            or too many cells.
    """
    found: list[Cell] = []
    links = read_links(path, pattern)
    _say_unreadable(path, links)
    for link in links:
        for number, (place, normal) in enumerate(_cells(path, link, pitch_mm)):
            found.append((f"{link.name}_{number}", place, normal))
        if len(found) > CELLS_MAX:
            message = f"a pitch of {pitch_mm:g} mm makes more than {CELLS_MAX} cells; take a wider"
            raise TopologyError(message, "pitch_mm")
    if not found:
        message = f'no link of {path.name} that matches "{pattern}" has a surface to put cells on'
        raise TopologyError(message, "links")
    return found


def _cells(path: Path, link: Link, pitch_mm: float) -> Iterator[tuple[Vector, Vector]]:
    facing: dict[Vector, Vector] = {}  # of all shapes together: they may touch, or lie in another
    for mesh in _meshes(path, link):
        from trimesh.sample import sample_surface

        area = float(mesh.area)
        if not 0 < area < math.inf:
            raise TopologyError(f"a mesh of link {link.name} has no surface", "urdf")
        wanted = math.ceil(DRAWN * area / pitch_mm**2)
        if wanted > DRAWN * CELLS_MAX:
            message = (
                f"a pitch of {pitch_mm:g} mm is too fine for link {link.name}, whose surface is "
                f"{area / 1e6:,.2f} m2; take a wider (lengths in a URDF are metres)"
            )
            raise TopologyError(message, "pitch_mm")
        drawn, faces = sample_surface(mesh, wanted + 1, seed=SEED)
        normals = mesh.face_normals[faces].tolist()
        for (x, y, z), (nx, ny, nz) in zip(drawn.round(3).tolist(), normals, strict=True):
            facing.setdefault((x, y, z), (nx, ny, nz))
    for point in thinned(list(facing), pitch_mm):
        yield point, facing[point]


def thinned(points: list[Vector], pitch_mm: float) -> list[Vector]:
    """The points in order, without those nearer than the pitch to one that is kept."""
    kept: dict[tuple[int, ...], list[Vector]] = {}  # by the cube of one pitch that they lie in
    made = []
    for point in points:
        cube = tuple(math.floor(value / pitch_mm) for value in point)
        near = product(*((i - 1, i, i + 1) for i in cube))
        if all(math.dist(point, other) >= pitch_mm for at in near for other in kept.get(at, ())):
            kept.setdefault(cube, []).append(point)
            made.append(point)
    return made


def _meshes(path: Path, link: Link) -> Iterator[Any]:
    """The shapes of a link, mm, in the root's frame: those to see if they can be read."""
    for part in _parts(link):
        mesh = _shape(path, link, part)
        turn, place = moved(link.turn, link.place, part.find("origin"), link.name)
        frame = [[*row, at] for row, at in zip(turn, place, strict=True)]
        mesh.apply_transform([*frame, [0, 0, 0, 1]])
        mesh.apply_scale(1000)
        yield mesh


def _parts(link: Link) -> list[Element]:
    """The shapes of a link that are used: to see or else for collisions, in Collada only if all."""
    for suffixes in (SUFFIXES, (*SUFFIXES, COLLADA)):
        for kind in ("visual", "collision"):
            parts = [part for part in link.element.findall(kind) if _readable(part, suffixes)]
            if parts:
                return parts
    return []


def _readable(part: Element, suffixes: tuple[str, ...]) -> bool:
    mesh = part.find("geometry/mesh")
    if mesh is not None:
        return mesh.get("filename", "").lower().endswith(suffixes)
    return any(part.find(f"geometry/{shape}") is not None for shape in _SOLIDS)


def _shape(path: Path, link: Link, part: Element) -> Any:
    """A mesh, m, in the frame of its own <origin>."""
    import trimesh

    mesh = part.find("geometry/mesh")
    if mesh is None:
        name, solid = next(
            (name, found)
            for name in _SOLIDS
            if (found := part.find(f"geometry/{name}")) is not None
        )
        return _SOLIDS[name](trimesh.creation, _sizes(solid, link))
    file = find_mesh(mesh.get("filename", ""), path)
    if file.suffix.lower() == COLLADA and find_spec("collada") is None:
        message = f"{file.name} of link {link.name} is a Collada mesh, which takes pycollada"
        raise TopologyError(f"{message}; install it with: pip install pycollada", "urdf")
    try:
        with catch_warnings():  # NumPy's, of numbers that are refused below
            simplefilter("ignore", RuntimeWarning)
            made: Any = trimesh.load(file, force="mesh", process=False)
    except Exception as error:  # whatever a reader of a dozen formats may raise
        told = isinstance(error, ImportError | ValueError | OSError)
        reason = error if told else "it is damaged or incomplete"
        raise TopologyError(
            f"{file.name} of link {link.name} is no mesh: {reason}", "urdf"
        ) from None
    if file.suffix.lower() == COLLADA:
        made.apply_scale(_metres(file))
    if not bool((abs(made.vertices) <= NUMBER_MAX).all()):
        message = f"{file.name} of link {link.name} has points farther than {NUMBER_MAX:g} away"
        raise TopologyError(f"{message}, or that are no numbers", "urdf")
    made.process()  # not before: it leaves out faces with such points
    made.apply_scale(_numbers(mesh.get("scale", "1 1 1"), 3, mesh, link))
    return made


def _metres(file: Path) -> float:
    """Of a Collada file, the length that its numbers count in, m; trimesh leaves that to us."""
    import collada

    unit = collada.Collada(str(file), ignore=[collada.common.DaeError]).assetInfo.unitmeter
    return 1.0 if unit is None else float(unit)


def _sizes(solid: Element, link: Link) -> dict[str, list[float]]:
    """The sizes of a solid shape, all of them above 0."""
    wanted = _SIZES[solid.tag]
    return {key: _numbers(solid.get(key, ""), count, solid, link) for key, count in wanted.items()}


def _numbers(text: str, count: int, element: Element, link: Link) -> list[float]:
    """So many numbers above 0 (a mesh's scale may mirror it)."""
    try:
        found = [float(word) for word in text.split()]
    except ValueError:
        found = []
    least = -NUMBER_MAX if element.tag == "mesh" else 0.0
    if len(found) != count or not all(least <= x <= NUMBER_MAX and x for x in found):
        what = f"{count} numbers" if count > 1 else "a number"
        message = f'link {link.name} has a {element.tag} of size "{text}"; it takes {what} above 0'
        message += f", up to {NUMBER_MAX:g}"
        raise TopologyError(message, "urdf")
    return found


_SIZES = {"box": {"size": 3}, "cylinder": {"radius": 1, "length": 1}, "sphere": {"radius": 1}}
_SOLIDS: dict[str, Any] = {
    "box": lambda make, size: make.box(extents=size["size"]),
    "cylinder": lambda make, size: make.cylinder(size["radius"][0], size["length"][0]),
    "sphere": lambda make, size: make.icosphere(radius=size["radius"][0]),
}


def find_mesh(name: str, urdf: Path) -> Path:
    """The file that a URDF means: beside it, or package://NAME/... below a folder above it.

    Raises:
        TopologyError: there is none.
    """
    inner = name.removeprefix("package://").removeprefix("file://")
    for folder in (urdf.parent, *urdf.resolve().parents):
        if (folder / inner).is_file():
            return folder / inner
    raise TopologyError(f"the mesh {name} is not there; install the robot's meshes too", "urdf")
