"""Nodes that a folder knows of besides those that answer: who died before anybody looked.

`live up` leaves the file of every node beside their sockets. A node that was killed leaves its
socket, one that ended does not; its file says where it would be, what it is and whom it has cables
to, so that it has its place on the map.
"""

import re
from collections.abc import Collection, Iterable
from pathlib import Path

from innervate.live import status
from innervate.live.addresses import without_interface
from innervate.live.errors import LiveError
from innervate.live.nodefile import Loaded, SerialTable, UdpTable, load
from innervate.web.live_map import Status
from innervate.web.live_view import LiveView


def missing(folder: Path, there: Iterable[Path]) -> list[Path]:
    """Sockets that nodes of a folder had and that are not among those that are there.

    A node that was never started is none of them: a scenario's event may still do so. `live up`
    begins a log with each.
    """
    found, known = set(there), files(folder)
    return [path for path in known if path not in found and path.with_suffix(".log").exists()]


def files(folder: Path) -> dict[Path, Loaded]:
    """The node files of a folder whose nodes have their sockets there, by those."""
    found = {}
    for path in sorted(folder.glob("*.toml"), key=status.in_order):
        try:
            node = load(path)
        except LiveError:  # a scenario, or anything else
            continue
        at = folder / (node.table.socket or f"{node.name}.sock")
        if at.parent.resolve() == folder.resolve():
            found[folder / at.name] = node
    return found


def silent(view: LiveView, heard: list[Status], sockets: list[Path]) -> dict[Path, Status]:
    """What stands for nodes that have not answered, by socket, beside those that have.

    It is what their files say, or else what can be guessed. Nodes of other kinds are left out.
    """
    folders = {path.parent for path in sockets}
    known = {at: node for folder in folders for at, node in files(folder).items()}
    kind = heard[0]["kind"]
    found = {at: unheard(known[at]) for at in sockets
             if at in known and known[at].table.kind == kind}  # fmt: skip
    others = [at for at in sockets if at not in known]
    known_ones = [*heard, *found.values()]
    made = view.unknown(known_ones, [at.stem for at in others])
    taken = {one.get("number") for one in known_ones}
    return found | {
        at: {**_numbered(at.stem, taken), **one, "name": at.stem}
        for at, one in zip(others, made, strict=True)
    }


def _numbered(name: str, taken: Collection[int | None]) -> Status:
    """The number of a node that is called as one whose file gives it no name."""
    found = re.fullmatch(r"n(0|[1-9]\d{0,8})", name)
    return {"number": int(found[1])} if found and int(found[1]) not in taken else {}


def unheard(node: Loaded) -> Status:
    """What stands for the words of a node that has not answered yet: what its file says."""
    table = node.table
    paths = [
        {"port": port, "name": far, "own": own, "up": True, "counters": {}}
        for port, (own, far) in enumerate(ends for link in table.link for ends in _ends(link))
    ]
    role = {} if table.role is None else {"role": table.role}
    common = {"kind": table.kind, "name": node.name, "number": table.number, "paths": paths}
    return {**common, **role, "neighbours": [], "counters": {}}


def _ends(link: object) -> list[tuple[str, str]]:
    """The two ends of each path of a link, as its status calls them."""
    if isinstance(link, UdpTable):
        own = f"udp {without_interface(link.bind)}"
        return [(own, f"udp {without_interface(peer)}") for peer in link.peers]
    if isinstance(link, SerialTable) and link.far:
        name = f"serial {link.device} to {link.far}"
        return [(f"serial {link.far} to {link.device}", name)]
    return []
