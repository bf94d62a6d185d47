"""Why a node of an imported network is not in the mesh, and what would keep it."""

from bisect import bisect_left

from innervate.networks.mesh.scenario.model import ImportTable
from innervate.scenario.source import shown
from innervate.topology.measured import Measured

STEPS = 100  # min_tq is proposed in hundredths


def left_out(table: ImportTable, whole: Measured, name: str, most: int) -> str:
    """Why an [import] leaves a node of its file out; "" if the file does not name it, either.

    The mesh may have `most` nodes.
    """
    if name not in whole.names:
        return ""
    node = whole.names.index(name)
    links = [min(both) for pair, both in whole.links.items() if node in pair]
    if not links:
        kinds = f" of type {' or '.join(table.types)}" if table.file and table.types else ""
        return f"{shown(name)} is left out: it has no link{kinds}"
    if max(links) == 0:
        return f"{shown(name)} is left out: its links work one way only; name another"
    if max(links) < table.min_tq:
        why = (
            f"no link of {shown(name)} has a quality of {table.min_tq:g} or better both ways, "
            f"the best has {max(links):g}"
        )
    elif table.nodes is not None:
        why = f"{shown(name)} is left out: it is not among the nearest {table.nodes} nodes"
    else:
        why = f"{shown(name)} is left out: no links of {table.min_tq:g} or better join it with most"
    return f"{why}; {_remedy(table, whole, name, most)}"


def _remedy(table: ImportTable, whole: Measured, name: str, most: int) -> str:
    """What to set so that a node is there: the greatest min_tq that does, and more nodes."""
    below = (step / STEPS for step in range(int(STEPS * table.min_tq), -1, -1))
    for least in [table.min_tq, *(one for one in below if one < table.min_tq)]:
        needed = _needed(table, whole.kept(least), name)
        if needed is None:
            continue
        changed = [] if least == table.min_tq else [f"import.min_tq = {least:g}"]
        if needed > most:
            changed.append(f"import.around = {shown(name)}")
        elif table.nodes is not None and needed > table.nodes:
            changed.append(f"import.nodes = {needed}")
        return f"{' and '.join(changed)} keep{'' if len(changed) > 1 else 's'} it"
    return f"import.around = {shown(name)} takes those about it"


def _needed(table: ImportTable, found: Measured, name: str) -> int | None:
    """How many nodes are taken of these until a node is among them; None: it never is."""
    if table.around is None and table.nodes is None:
        whole = found.largest() if table.largest_component else found
        return len(whole.names) if name in whole.names else None
    around = None if table.around is None else str(table.around)
    if around is not None and around not in found.names:
        return None
    middle = found.best_connected() if around is None else found.names.index(around)
    sizes = range(1, len(found.around(middle, len(found.names)).names) + 1)
    place = bisect_left(sizes, True, key=lambda size: name in found.around(middle, size).names)
    return sizes[place] if place < len(sizes) else None
