"""Is all well with a mesh, in one sentence: for a finished run, a running one, running nodes."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from innervate.analysis.headline import (
    DEGRADED,
    DOWN,
    NO_DATA,
    OK,
    Headline,
    part_of,
    put_out,
    sentence,
    verb,
)
from innervate.analysis.ways import Flags
from innervate.kernel.words import number_of
from innervate.networks.mesh.analysis.alarms import Crossing, FalseAlarm
from innervate.networks.mesh.analysis.messages import DELIVERED, NEVER, UNASKED, Messages, counted
from innervate.networks.mesh.analysis.reach import Ways
from innervate.networks.mesh.scenario.nodes import listed
from innervate.scenario.actions.field import CUT, JAM, KILL, RESTART


class Traffic(NamedTuple):
    """What became of messages and alarms; running nodes do not know, and leave it at nothing."""

    decided: int = 0  # messages to one node of which it is known what became of them
    delivered: int = 0  # of those, how many came
    crossings: int = 0  # of the fence, of which it is known whether the monitor learned of them
    learned: int = 0  # of those, of how many it did
    broadcasts: int = 0  # messages to all of which it is known whom they reached
    partial: int = 0  # of those, how many did not reach every other node that was on
    doubled: int = 0  # messages that came twice
    looped: int = 0  # packets that met a node twice on their way
    flows: bool = False  # something came since the newest fault, or there was no fault
    # senders of what did not come, and robots that the monitor does not know are out
    about: tuple[int, ...] = ()
    false: int = 0  # alarms of robots that were inside


NOTHING_KNOWN = Traffic()


class Elsewhere(NamedTuple):
    """Whom the nodes that are asked name as neighbours or follow, and who is none of them."""

    nodes: tuple[int, ...] = ()  # their numbers
    leads: bool = False  # one of them is a gateway that is followed here
    silent: bool = False  # one was, and nothing comes from it any more
    surely: bool = True  # none of them is one of those here that are silent
    heard: bool = True  # those that are asked have neighbours and a path that carries, or no paths


ALL_HERE = Elsewhere()


def headline(
    ways: Ways,
    traffic: Traffic = NOTHING_KNOWN,
    absent: str = "off",
    elsewhere: Elsewhere = ALL_HERE,
    revoked: Flags | None = None,
) -> Headline:
    """The state of a mesh; of nodes that are missing it says `absent`: "off", "silent".

    `elsewhere` are nodes of which only others' words are known, which are believed. Of those whose
    identity is `revoked` nobody takes anything, whatever links there are.

    degraded: a message or an alarm was lost or came twice, an alarm was false, a broadcast missed
    somebody, a packet met a node twice, a node is off, cut off or without a way, the network is in
    parts. down: nobody's messages get through to a gateway, nor did anything come to anybody else
    since, or the only node hears nobody. no data: nobody has heard a gateway yet.
    """
    lost = traffic.crossings + traffic.decided - traffic.learned - traffic.delivered
    if not (ways.on & ways.joined).any() and not ways.off.any() and not lost:
        return Headline(NO_DATA, "No node leads as gateway yet.")
    if len(ways.on) == 1 and ways.leads.all() and not elsewhere.heard:
        return Headline(DOWN, "The only node leads, and hears nobody.", (0,))
    said = [*_undelivered(traffic), *_apart(ways, absent, elsewhere, revoked),
            *_twice(traffic), *_false(traffic)]  # fmt: skip
    came, afar = _came(traffic, len(ways.on)), _afar(elsewhere)
    if not said:
        return Headline(OK, sentence([*came, _reached(ways, elsewhere.leads), *afar]))
    about = np.flatnonzero(ways.without | ways.off).tolist()
    nodes = tuple(sorted({*about, *traffic.about}))
    level = DOWN if _is_down(ways, traffic, bool(afar)) else DEGRADED
    return Headline(level, sentence([*said, *came, *afar]), nodes)


def _is_down(ways: Ways, traffic: Traffic, others: bool) -> bool:
    """True if nothing gets through: nothing of all that was sent, or nothing from now on."""
    if not ways.on.any():
        return True
    if traffic.flows:
        return False
    if traffic.decided + traffic.crossings and not traffic.delivered + traffic.learned:
        return True
    served = ways.on & ~ways.without & ~ways.leads
    return not served.any() and (len(ways.on) > 1 or others)


def _undelivered(traffic: Traffic) -> list[str]:
    """Sentences on crossings and messages that did not come; none if all did."""
    found = []
    crossings, decided = traffic.crossings, traffic.decided
    unheard, lost = crossings - traffic.learned, decided - traffic.delivered
    if unheard == crossings > 1:
        found.append(
            f"the monitor learned of none of {number_of(crossings, 'crossing')} of the fence"
        )
    elif unheard:
        which = part_of(unheard, crossings, "crossing")
        found.append(f"the monitor never learned of {which} of the fence")
    if lost == decided > 1:
        found.append(f"none of {number_of(decided, 'message')} was delivered")
    elif lost:
        found.append(f"{part_of(lost, decided, 'message')} {verb(lost, 'was')} not delivered")
    if traffic.partial:
        which = part_of(traffic.partial, traffic.broadcasts, "broadcast")
        found.append(f"{which} did not reach every node that was on")
    return found


def _apart(
    ways: Ways, absent: str, elsewhere: Elsewhere, revoked: Flags | None = None
) -> list[str]:
    """Who has no way, is cut off, put out, or off."""
    count, found = len(ways.on), []
    out = np.zeros(count, np.bool_) if revoked is None else revoked & ways.on
    leading = int(ways.leads.sum()) + elsewhere.leads
    if not leading:
        none = "nothing comes from" if elsewhere.silent else "no node leads as"
        which = "the gateway any more" if elsewhere.silent else "gateway"
        found.append(f"{none} {which}, and what is sent to it does not get through")
    else:
        if leading > 1:
            found.append(
                f"{leading} nodes lead as gateways, each followed by a part of the network"
            )
        cut, astray = int((ways.cut_off & ~out).sum()), int((ways.astray & ~out).sum())
        if cut:
            who = f"{part_of(cut, count, 'node')} {verb(cut, 'is')}"
            found.append(f"{who} cut off from the gateway: "
                         f"no link that works leads to {'it' if cut == 1 else 'them'}")  # fmt: skip
        if astray:
            found.append(
                f"{part_of(astray, count, 'node')} {verb(astray, 'has')} no way to the gateway"
            )
    if gone := int(out.sum()):
        found.append(put_out(part_of(gone, count, "node"), gone))
    off = int(ways.off.sum())
    if off:
        found.append(f"{part_of(off, count, 'node')} {verb(off, 'is')} {absent}")
    return found


def _twice(traffic: Traffic) -> list[str]:
    found = []
    if traffic.doubled:
        found.append(f"{number_of(traffic.doubled, 'message')} came twice")
    if traffic.looped:
        found.append(f"{number_of(traffic.looped, 'packet')} met a node twice on the way")
    return found


def _false(traffic: Traffic) -> list[str]:
    if not traffic.false:
        return []
    each = "" if traffic.false == 1 else "each "
    return [f"{number_of(traffic.false, 'alarm')} {verb(traffic.false, 'was')} false, "
            f"{each}of a robot that was inside"]  # fmt: skip


def _came(traffic: Traffic, nodes: int) -> list[str]:
    """What came, as far as it all did; where there is nobody else, no broadcast did."""
    said = []
    if traffic.crossings and traffic.crossings == traffic.learned:
        which = part_of(traffic.crossings, traffic.crossings, "crossing")
        said.append(f"the monitor learned of {which} of the fence")
    if traffic.decided and traffic.decided == traffic.delivered:
        which = part_of(traffic.decided, traffic.decided, "message")
        said.append(f"{which} {verb(traffic.decided, 'was')} delivered")
    if traffic.broadcasts and not traffic.partial and nodes > 1:
        which = part_of(traffic.broadcasts, traffic.broadcasts, "broadcast")
        said.append(f"{which} reached every node that was on")
    return said


def _reached(ways: Ways, leads_elsewhere: bool) -> str:
    """That everybody has a way."""
    count = len(ways.on)
    if int(ways.on.sum()) < count:  # some have not been switched on yet
        return "every node that is on has a way to the gateway"
    if count == 1 and not leads_elsewhere:
        return "the only node leads"
    return f"{part_of(count, count, 'node')} {verb(count, 'has')} a way to the gateway"


def _afar(elsewhere: Elsewhere) -> list[str]:
    """That what is said of nodes that do not run here is believed."""
    nodes = elsewhere.nodes
    if not nodes:
        return []
    few = f"node {nodes[0]} does" if len(nodes) == 1 else f"nodes {listed([*map(str, nodes)])} do"
    them = "it" if len(nodes) == 1 else "them"
    here = "run here" if elsewhere.surely else "run here, as far as is known"
    return [f"{few} not {here}, and what is said of {them} is believed"]


def traffic(
    found: Messages, crossings: Sequence[Crossing], doubled: int, looped: int, faults: Any,
    false: Sequence[FalseAlarm] = (),
) -> Traffic:  # fmt: skip
    """The traffic of a run, so far."""
    decided = counted(found)
    came = decided.state == DELIVERED
    closed = [crossing for crossing in crossings if not crossing.open]
    learned = [crossing for crossing in closed if crossing.accepted_us != NEVER]
    takes = [fault.at_us for fault in faults if fault.action in (KILL, CUT, JAM, RESTART)]
    late = (found.state == DELIVERED) & (found.offered_us > max(takes, default=NEVER))
    everybody = found.broadcast & ~found.young & (found.state != UNASKED)
    missing = [*decided.node[~came].tolist(), *found.node[found.partial].tolist()]
    unheard = {crossing.robot for crossing in closed if crossing.accepted_us == NEVER}
    return Traffic(
        decided=len(decided.state),
        delivered=int(np.count_nonzero(came)),
        crossings=len(closed),
        learned=len(learned),
        broadcasts=int(np.count_nonzero(everybody)),
        partial=int(np.count_nonzero(found.partial)),
        doubled=doubled,
        looped=looped,
        flows=bool(late.any()),
        about=tuple(sorted({*unheard, *missing, *(one.robot for one in false)})),
        false=len(false),
    )
