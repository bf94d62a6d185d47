"""What became of every message of a mesh run: offered, on its way, delivered, given up.

An *offer* is a message handed to a node by its user; a broadcast is one too, but is not delivered
to one node alone and therefore left out of ratios and latencies.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from innervate.analysis.ways import Flags, Numbers
from innervate.networks.mesh.analysis.broadcasts import missed
from innervate.networks.mesh.protocol import constants as const
from innervate.scenario.actions.field import CUT, KILL, RESTART, RESTORE, REVIVE

NEVER = -1
SETTLE_US = 1_000_000  # an unreliable message takes no longer
SAME_US = 60_000_000  # the same number this much later is another packet
HANDLES = 1 << 16
REASONS = {
    const.NO_ROUTE: "no_route",
    const.NO_ACK: "no_ack",
    const.PUT_OUT: "put_out",
    const.NO_ROOM: "no_room",
}

# States of a message.
DELIVERED, IN_FLIGHT, LOST, REFUSED, UNASKED = range(5)
STATE_NAMES = ("delivered", "in flight", "lost", "refused", "sender off")


class Messages(NamedTuple):
    """Every offer of a run, in order of time, one entry each."""

    offered_us: Numbers  # when it was handed down
    # node, dest: who sends, and to whom: 255 all, 254 the monitor
    node: Numbers
    dest: Numbers
    flow: Numbers  # which [[flow]] of the scenario it belongs to
    seq: Numbers  # the number of its packet, NEVER if the node took none
    delivered_us: Numbers  # when it first came to its recipient's user, NEVER if it did not
    receiver: Numbers  # who that was
    hops: Numbers  # transmissions on the way of the copy that came first
    # DELIVERED, IN_FLIGHT (nobody gave it up when the run ended), LOST, REFUSED (the node had
    # no room or nobody to send it to), UNASKED (the node was switched off)
    state: Numbers
    broadcast: Flags  # to all
    partial: Flags  # a broadcast that somebody missed who was on for as long as it could take
    young: Flags  # offered so late that it could still be on its way when the run ended

    def only(self, which: Any) -> Messages:
        """Those of them that `which` chooses."""
        return Messages(*(column[which] for column in self))


def messages(result: Any) -> Messages:
    """Every message that a run's users offered until its end."""
    offers = [offer for offer in result.plan.offers if offer.at_us < result.ended_us]
    at, node, dest, flow = (
        np.array([getattr(offer, name) for offer in offers], np.int64)
        for name in ("at_us", "node", "dest", "flow")
    )
    seq, answer = _accepted(result, at, node)
    given = np.flatnonzero(result.delivered["kind"] == const.DATA)
    of = _offers_of(result.delivered[given], at, node, seq)
    first = _first_deliveries(result, at, node, seq, given, of)
    rows = result.delivered[np.maximum(first, 0)] if len(result.delivered) else None
    came = first >= 0

    def of_first(name: str) -> Numbers:
        if rows is None:
            return np.full(len(at), NEVER, np.int64)
        found: Numbers = np.where(came, rows[name].astype(np.int64), NEVER)
        return found

    state = _states(result, at, came, answer)
    young = at + timeout_us(result.plan) > result.ended_us
    broadcast = dest == const.ALL
    judged = np.flatnonzero(broadcast & ~young & (state != UNASKED))
    partial = np.zeros(len(at), np.bool_)
    partial[judged] = missed(result, at, node, judged, of, timeout_us(result.plan))
    return Messages(
        offered_us=at,
        node=node,
        dest=dest,
        flow=flow,
        seq=seq,
        delivered_us=of_first("time"),
        receiver=of_first("node"),
        hops=of_first("path_len"),
        state=state,
        broadcast=broadcast,
        partial=partial,
        young=young,
    )


def _accepted(result: Any, at: Numbers, node: Numbers) -> tuple[Numbers, Numbers]:
    """Per offer the seq it went out as, and the code of the node's answer (0: none)."""
    rows = result.rows
    answers = rows[(rows["code"] == const.REPORT_ACCEPTED) | (rows["code"] == const.REPORT_FULL)]
    # A node answers in the handler call that hands the message down: at the very same time.
    key = _key(answers["time"], answers["node"], answers["a"])
    order = np.argsort(key, kind="stable")
    wanted = _key(at, node, np.arange(len(at)) % HANDLES)
    place = np.searchsorted(key[order], wanted)
    seq, answer = np.full(len(at), NEVER, np.int64), np.zeros(len(at), np.int64)
    if len(answers):
        found = order[np.minimum(place, len(order) - 1)]
        mine = key[found] == wanted
        answer[mine] = answers["code"][found[mine]]
        taken = mine & (answer == const.REPORT_ACCEPTED)
        seq[taken] = answers["b"][found[taken]]
    return seq, answer


def _key(time: Any, node: Any, handle: Any) -> Numbers:
    """One number of up to 2^37 us, 2^8 nodes and 2^16 handles."""
    key: Numbers = np.asarray(time, np.int64) << 24
    key = key | np.asarray(node, np.int64) << 16 | np.asarray(handle, np.int64)
    return key


def _offers_of(given: Any, at: Numbers, node: Numbers, seq: Numbers) -> Numbers:
    """Per delivery of a message the offer that it is of, NEVER if of none."""
    offered = np.flatnonzero(seq >= 0)
    names = node[offered] << 16 | seq[offered]
    mine = given["origin"].astype(np.int64) << 16 | given["seq"]
    last = newest_before(names, at[offered], mine, given["time"].astype(np.int64))
    found: Numbers = np.append(offered, NEVER)[last]  # the last place is also that of NEVER
    return found


def _first_deliveries(
    result: Any, at: Numbers, node: Numbers, seq: Numbers, rows: Any, of: Numbers
) -> Numbers:
    """Per offer the row of its first delivery, NEVER if there is none.

    `rows` are the deliveries of messages, `of` says of which offers.
    """
    found = np.full(len(at), NEVER, np.int64)
    fits = of != NEVER
    # Backwards, so that the first of several is written last.
    found[of[fits][::-1]] = rows[fits][::-1]
    # What a node sends to itself is handed back at once and has no number of its own.
    own = {
        (int(row["time"]), int(row["node"])): int(i)
        for i, row in zip(rows, result.delivered[rows], strict=True)
        if row["node"] == row["origin"]
    }
    for i in np.flatnonzero(seq < 0).tolist() if own else ():
        found[i] = own.get((int(at[i]), int(node[i])), NEVER)
    return found


def newest_before(names: Numbers, times: Numbers, name: Numbers, time: Numbers) -> Numbers:
    """For each name and time, where the newest of that name stands that was there by then.

    NEVER without one. Numbers of packets, which are part of a name, come round again.
    """
    found = np.full(len(name), NEVER, np.int64)
    if len(names):
        order = np.lexsort((times, names))
        # Both halves of a key fit into 63 bits: 24 of a name, 37 of a time.
        key = names[order] << 37 | times[order]
        last = np.searchsorted(key, name << 37 | time, "right") - 1
        fits = last >= 0
        fits[fits] = names[order[last[fits]]] == name[fits]
        found[fits] = order[last[fits]]
    return found


def _states(result: Any, at: Numbers, came: Flags, answer: Numbers) -> Numbers:
    state = np.full(len(at), LOST, np.int64)
    state[at + timeout_us(result.plan) > result.ended_us] = IN_FLIGHT
    state[_kept(result, at, answer)] = IN_FLIGHT
    rows = result.rows[result.rows["code"] == const.REPORT_EXPIRED]
    for row in rows:
        # The offer of that handle which was there last.
        newest = int(np.searchsorted(at, row["time"], "right")) - 1
        given_up = newest - (newest - int(row["a"])) % HANDLES
        if given_up >= 0:
            state[given_up] = LOST
    state[answer == const.REPORT_FULL] = REFUSED
    state[answer == 0] = UNASKED
    state[came] = DELIVERED
    return state


def _kept(result: Any, at: Numbers, answer: Numbers) -> Flags:
    """Which messages their senders still keep and try again, unless they said that they gave up.

    Where they wait as long as answers took, that can be longer than `timeout_us`.
    """
    plan = result.plan
    offers = plan.offers[: len(at)]
    if not plan.params.get("e2e_adapt"):
        return np.zeros(len(at), np.bool_)
    forgot = {node: NEVER for node in range(plan.nodes)}
    for fault in plan.faults:
        if fault.action in (KILL, RESTART) and fault.at_us < result.ended_us:
            forgot[fault.node] = max(forgot[fault.node], fault.at_us)
    safe = [
        bool(offer.flags & const.END_TO_END) and offer.at_us > forgot[offer.node]
        for offer in offers
    ]
    kept: Flags = np.array(safe, np.bool_) & (answer == const.REPORT_ACCEPTED)
    return kept


def timeout_us(plan: Any) -> int:
    """How long a message can be on its way before its sender gives it up, us; see `_kept`."""
    params = plan.params
    again = params["e2e_us"] * (params["e2e_tries"] + 1) if params["reliable"] else 0
    return max(SETTLE_US, int(again))


def duplicates(result: Any) -> int:
    """Deliveries of the same packet to the same user beyond the first.

    The same: receiver, origin, type and number, while the origin was not switched on again.
    """
    rows = result.delivered
    boots = {node: [0] for node in range(result.plan.nodes)}
    for fault in result.plan.faults:
        if fault.action in (REVIVE, RESTART):
            boots[fault.node].append(fault.at_us)
    boot = np.zeros(len(rows), np.int64)
    for node, starts in boots.items():
        mine = rows["origin"] == node
        boot[mine] = np.searchsorted(np.array(starts), rows["time"][mine], "right")
    fields = [rows[name] for name in ("node", "origin", "kind", "seq")]
    _, same = repeats(rows["time"], [boot, *fields], SAME_US)
    return int(np.count_nonzero(same))


def repeats(times: Any, fields: Sequence[Any], within_us: int) -> tuple[Numbers, Flags]:
    """(rows in order of fields and time, of each but the first if it repeats the one before).

    It repeats that if all fields are the same, less than so long after.
    """
    order = np.lexsort((times, *fields))
    again = np.diff(times[order]) < within_us
    for column in fields:
        again &= column[order][1:] == column[order][:-1]
    return order, again


def give_ups(result: Any) -> dict[str, int]:
    """How many messages their senders gave up or refused, by reason."""
    rows = result.rows
    found = dict.fromkeys(REASONS.values(), 0)
    for code in (const.REPORT_EXPIRED, const.REPORT_FULL):
        for reason in rows["b"][rows["code"] == code].tolist():
            name = REASONS.get(reason, f"reason_{reason}")
            found[name] = found.get(name, 0) + 1
    return found


def ratio(part: int, whole: int) -> float | None:
    """A share; None of nothing."""
    return part / whole if whole else None


def counted(found: Messages) -> Messages:
    """What a delivery ratio is made of: to one node, by a node that was on, and decided.

    If some are still on their way at the end, all that are as young as the oldest of them are left
    out: only the fast ones among them would count.
    """
    asked = found.only(~found.broadcast & (found.state != UNASKED))
    waits = asked.offered_us[(asked.state == IN_FLIGHT) & asked.young]
    return asked.only(asked.offered_us < waits.min()) if len(waits) else asked


def delivery_ratio(found: Messages) -> float | None:
    """The share of messages that were delivered, see counted()."""
    decided = counted(found)
    return ratio(int(np.count_nonzero(decided.state == DELIVERED)), len(decided.state))


def latencies_us(found: Messages) -> Numbers:
    """From offer to first delivery, us, of every message to one node that was delivered."""
    which = (found.state == DELIVERED) & ~found.broadcast
    waited: Numbers = found.delivered_us[which] - found.offered_us[which]
    return waited


def first_after(found: Messages, since_us: int) -> Messages:
    """The first message of every sender from a time on."""
    late = counted(found.only(found.offered_us >= since_us))
    return late.only(np.sort(np.unique(late.node, return_index=True)[1]))


def took_effect(plan: Any, ended_us: int) -> list[Any]:
    """The events that happened and changed something, in order: no dead node dies again."""
    found = []
    on = [not absent for absent in plan.absent] or [True] * plan.nodes
    cut: dict[frozenset[int], bool] = {}
    for fault in plan.faults:
        if fault.at_us >= ended_us:
            break
        pair = frozenset((fault.node, fault.other))
        if fault.action in (KILL, REVIVE):
            changes = on[fault.node] == (fault.action == KILL)
        elif fault.action in (CUT, RESTORE):
            changes = cut.get(pair, False) == (fault.action == RESTORE)
            cut[pair] = fault.action == CUT
        else:
            changes = True
        if fault.action in (KILL, REVIVE, RESTART):
            on[fault.node] = fault.action != KILL
        if changes:
            found.append(fault)
    return found


def deaths_us(plan: Any, ended_us: int) -> list[int]:
    """When nodes were switched off, in order."""
    return [fault.at_us for fault in took_effect(plan, ended_us) if fault.action == KILL]
