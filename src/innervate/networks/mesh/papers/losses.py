"""What messages were lost by, as their last transmission shows."""

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np

from innervate.networks.mesh.analysis.messages import DELIVERED, HANDLES, counted
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.protocol.constants import DATA, PATH_MAX, REPORT_EXPIRED
from innervate.papers.words import joined
from innervate.topology.placement import UNREACHABLE

HOW = (
    "at a dead node",
    "at a live one, of which no ack was heard",
    f"after {PATH_MAX} nodes, going round",
    "given up by their sender before they were sent",
    "waiting with their sender when the run ended",
)
DEAD, LIVE, ROUND, GIVEN_UP, WAITING = range(len(HOW))


def how(result: Any, found: Any, ground: Ground, gone: Collection[int]) -> list[int]:
    """How many messages were lost in each way, of those whose ends were connected."""
    counts = [0] * len(HOW)
    decided, data = counted(found), result.sent[result.sent["kind"] == DATA]
    expired = _expired(result)
    for i in np.flatnonzero(decided.state != DELIVERED):
        node, since = int(decided.node[i]), int(decided.offered_us[i])
        if ground.hops(node, int(decided.dest[i]), since) == UNREACHABLE:
            continue
        mine = (data["origin"] == node) & (data["seq"] == decided.seq[i])
        sent = data[mine & (data["time"] >= since)]
        if len(sent):
            counts[_on_the_way(sent, gone)] += 1
        else:
            counts[GIVEN_UP if (since, node) in expired else WAITING] += 1
    return counts


def _expired(result: Any) -> set[tuple[int, int]]:
    """(when it was offered, by whom) of every message that its sender gave up."""
    rows = result.rows[result.rows["code"] == REPORT_EXPIRED]
    handles = set(zip(rows["node"].tolist(), rows["a"].tolist(), strict=True))
    return {
        (offer.at_us, offer.node)
        for i, offer in enumerate(result.plan.offers)
        if (offer.node, i % HANDLES) in handles
    }


def _on_the_way(sent: Any, gone: Collection[int]) -> int:
    """Which of HOW a packet was lost in, by all its transmissions."""
    if sent["path_len"].max() >= PATH_MAX:
        return ROUND
    return DEAD if int(sent["link_dst"][-1]) in gone else LIVE


def words(runs: Sequence[Sequence[int]]) -> str:
    """The counts of all runs, as a sentence's part."""
    counts = np.sum(runs, axis=0)
    parts = [f"{count} {what}" for count, what in zip(counts, HOW, strict=True) if count]
    return f"lost were {joined(parts)}" if parts else "none was lost"
