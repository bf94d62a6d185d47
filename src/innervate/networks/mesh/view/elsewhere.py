"""Nodes of a running mesh that do not run here: what those here say of them has to do.

On a robot one node runs, and whoever asks there hears of the others from it alone. All of them are
one node more, behind the last place: whoever hears one of them, and is answered, is linked with it.
"""

from collections.abc import Collection, Iterable

import numpy as np

from innervate.analysis.ways import NOWHERE, Flags, follow, reach
from innervate.networks.mesh.analysis.headline import Elsewhere
from innervate.networks.mesh.analysis.reach import Choices, Ways
from innervate.web.live_map import Status


def elsewhere(said: Iterable[Status], here: Collection[int], all_known: bool) -> Elsewhere:
    """Of whom these speak that are none of those `here`, by their numbers.

    `all_known`: of everybody here the number is known, of the silent ones too.
    """
    said = list(said)
    near = {other["node"] for one in said for other in one.get("neighbours", ())}
    led = {one["gateway"] for one in said if one.get("gateway") is not None} - set(here)
    heard = {one["gateway"] for one in said if not one.get("gateway_silent")} & led
    nodes = tuple(sorted(near - set(here) | led))
    silent = bool(led) and not heard
    paths = [path for one in said for path in one.get("paths", ())]
    carried = any(path["up"] and not path.get("broken") for path in paths)
    return Elsewhere(nodes, bool(heard), silent, all_known, (bool(near) and carried) or not paths)


def hand_on(known: Choices, links: Flags, leads: Flags) -> None:
    """Those elsewhere, the last of all, hand on to whoever is nearest to a gateway that runs here.

    What they would do is not known: they are believed to find the way, if there is one.
    """
    last = len(leads) - 1
    if leads[last] or not leads.any():
        return
    known.gateway[last] = int(np.argmax(leads))
    here = links.copy()
    here[last] = here[:, last] = False
    for hops in range(last):
        nearest = np.flatnonzero(reach(here, leads, hops) & links[last])
        if len(nearest):
            known.named[last, 0] = nearest[0]
            return


def without_it(found: Ways) -> Ways:
    """The ways of those who run here; of ways by others neither hop nor length is known."""
    count = len(found.on) - 1
    cut = Ways._make(part[:count] for part in found)
    hop = np.where(cut.hop == count, NOWHERE, cut.hop)
    root, _ = follow(hop, cut.leads)
    return cut._replace(hop=hop, depth=np.where(root == NOWHERE, NOWHERE, cut.depth))
