"""Robot descriptions: where the links of a URDF file lie, every joint at zero.

Standard library only. Lengths in a URDF are metres, angles radians (roll, pitch, yaw about the
fixed axes of the parent); positions come back in mm.
"""

import fnmatch
import math
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import NamedTuple

from innervate.topology.errors import TopologyError
from innervate.topology.unseen import unseen

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
PACKAGE = "package:"
SIZE_MAX = 64 * 1024 * 1024
NUMBER_MAX = 1e6  # m or rad: no robot is that large
_HERE: tuple[Matrix, Vector] = (((1, 0, 0), (0, 1, 0), (0, 0, 1)), (0, 0, 0))


def find_urdf(text: str, folder: Path) -> Path:
    """The file a scenario means by `urdf`.

    Args:
        text: a path (relative ones start at `folder`), or "package:<distribution>/<robot>" for a
            file of an installed Python package.
        folder: where the scenario file lies.

    Raises:
        TopologyError: no such package, or no such robot in it.
    """
    if not text.startswith(PACKAGE):
        return folder / text
    from importlib import metadata  # slow to import, and seldom needed

    name, _, robot = text.removeprefix(PACKAGE).partition("/")
    try:
        files = metadata.files(name) or []
    except (metadata.PackageNotFoundError, ValueError):
        hint = f"install it with: pip install {name}" if name else "write package:<name>/<robot>"
        raise TopologyError(f'package "{name}" is not installed; {hint}', "urdf") from None
    found = [file for file in files if file.suffix == ".urdf"]
    for file in found:
        if robot and (robot in (file.parent.name, file.stem) or file.as_posix().endswith(robot)):
            return Path(str(file.locate()))
    there = ", ".join(sorted({file.parent.name for file in found})) or "none"
    raise TopologyError(f'package "{name}" has no robot "{robot}"; it has {there}', "urdf")


def read_positions(path: Path, pattern: str) -> tuple[list[str], list[Vector]]:
    """(names, positions in mm) of the links that match, in the file's order.

    Args:
        path: a URDF file.
        pattern: a glob ("r_forearm_skin_*"); a regular expression if no link matches it as glob.

    Raises:
        TopologyError: the file cannot be read or is no URDF, or nothing matches.
    """
    placed = read_links(path, pattern)
    metres = [link.place for link in placed]
    return [link.name for link in placed], [(1e3 * x, 1e3 * y, 1e3 * z) for x, y, z in metres]


class Link(NamedTuple):
    """A link of a robot description: its element, and how and where (m) its frame lies."""

    name: str
    element: ElementTree.Element
    turn: Matrix
    place: Vector


def read_links(path: Path, pattern: str) -> list[Link]:
    """The links that match, in the file's order, placed in the root's frame; see read_positions.

    Raises:
        TopologyError: see read_positions().
    """
    root = _parse(path)
    links = [link.get("name", "") for link in root.findall("link")]
    names = _matching(links, pattern)
    if not names:
        some = ", ".join(links[:3]) or "none at all"
        some += ", ..." if len(links) > 3 else ""
        message = f'no link of {path.name} matches "{pattern}"; it has {len(links)}: {some}'
        raise TopologyError(message, "links")
    if wrong := next(filter(None, map(unseen, names)), ""):
        raise TopologyError(f"the name of a link of {path.name} {wrong}", "urdf")
    twice = next((name for name in names if links.count(name) > 1), None)
    if twice is not None:
        message = f'{path.name} has {links.count(twice)} links called "{twice}"; name them apart'
        raise TopologyError(message, "urdf")
    joints = {}
    for joint in root.findall("joint"):
        parent, child = joint.find("parent"), joint.find("child")
        if parent is not None and child is not None:
            joints[child.get("link", "")] = (parent.get("link", ""), joint.find("origin"))
    poses: dict[str, tuple[Matrix, Vector]] = {}
    elements = {link.get("name", ""): link for link in root.findall("link")}
    return [Link(name, elements[name], *_pose(name, joints, poses)) for name in names]


def _parse(path: Path) -> ElementTree.Element:
    try:
        with path.open("rb") as file:
            content = file.read(SIZE_MAX + 1)
        if len(content) > SIZE_MAX:
            raise TopologyError(f"{path} is too large for a URDF file (over 64 MiB)", "urdf")
        root = ElementTree.fromstring(content)
    except (OSError, ValueError, LookupError) as error:
        reason = getattr(error, "strerror", None) or "unreadable"
        raise TopologyError(f"cannot read the URDF file {path}: {reason}", "urdf") from None
    except ElementTree.ParseError as error:
        raise TopologyError(f"{path} is no XML: {error}", "urdf") from None
    if root.tag != "robot":
        raise TopologyError(f"{path} is no URDF: its root is <{root.tag}>, not <robot>", "urdf")
    return root


def _matching(links: list[str], pattern: str) -> list[str]:
    names = [name for name in links if fnmatch.fnmatchcase(name, pattern)]
    if names:
        return list(dict.fromkeys(names))
    try:
        expression = re.compile(pattern)
    except (re.error, RecursionError, OverflowError) as error:
        if not links or pattern[:1] in ("*", "?"):  # a glob, then, and it matches nothing
            return []
        message = f'"{pattern}" is neither a glob that matches nor a regular expression: {error}'
        raise TopologyError(message, "links") from None
    return list(dict.fromkeys(name for name in links if expression.fullmatch(name)))


def _pose(
    name: str,
    joints: dict[str, tuple[str, ElementTree.Element | None]],
    poses: dict[str, tuple[Matrix, Vector]],
) -> tuple[Matrix, Vector]:
    """Rotation and place (m) of a link in the root's frame, all joints at zero."""
    chain = []
    above = name
    while above not in poses and above in joints:
        if above in chain:
            raise TopologyError(f"the joints of link {above} form a ring", "urdf")
        chain.append(above)
        above = joints[above][0]
    turn, place = poses.setdefault(above, _HERE)
    for link in reversed(chain):
        turn, place = moved(turn, place, joints[link][1], link)
        poses[link] = (turn, place)
    return turn, place


def moved(
    turn: Matrix, place: Vector, origin: ElementTree.Element | None, link: str
) -> tuple[Matrix, Vector]:
    """A frame moved by an <origin> element of a link; None moves nothing.

    Raises:
        TopologyError: the element does not have three numbers.
    """
    xyz, rpy = _numbers(origin, "xyz", link), _numbers(origin, "rpy", link)
    x, y, z = _apply(turn, xyz)
    return _product(turn, _rotation(rpy)), (place[0] + x, place[1] + y, place[2] + z)


def _numbers(origin: ElementTree.Element | None, key: str, link: str) -> Vector:
    text = origin.get(key, "0 0 0") if origin is not None else "0 0 0"
    try:
        x, y, z = (float(word) for word in text.split())
    except ValueError:
        x = y = z = math.nan
    if not all(abs(value) <= NUMBER_MAX for value in (x, y, z)):
        message = f'the joint of link {link} has {key} = "{text}"; it takes three numbers, '
        message += f"from -{NUMBER_MAX:g} to {NUMBER_MAX:g}"
        raise TopologyError(message, "urdf")
    return x, y, z


def _rotation(rpy: Vector) -> Matrix:
    """The matrix of roll, pitch and yaw, rad: Rz(yaw) Ry(pitch) Rx(roll)."""
    (sr, sp, sy), (cr, cp, cy) = map(math.sin, rpy), map(math.cos, rpy)
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )


def _apply(m: Matrix, v: Vector) -> Vector:
    x, y, z = (row[0] * v[0] + row[1] * v[1] + row[2] * v[2] for row in m)
    return x, y, z


def _product(a: Matrix, b: Matrix) -> Matrix:
    columns = [_apply(a, (b[0][i], b[1][i], b[2][i])) for i in range(3)]
    first, second, third = ((columns[0][r], columns[1][r], columns[2][r]) for r in range(3))
    return first, second, third
