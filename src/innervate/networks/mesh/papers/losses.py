"""What messages were lost by, as their last transmission shows."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np

from innervate.networks.mesh.analysis.messages import DELIVERED, counted
from innervate.networks.mesh.analysis.paths import UNREACHABLE, Ground
from innervate.networks.mesh.protocol.constants import DATA, PATH_MAX
from innervate.papers.words import joined

HOW = (
    "at a dead node",
    "at a live one, which did not answer",
    f"after {PATH_MAX} nodes, going round",
    "with their sender, who never sent them",
)
DEAD, LIVE, ROUND, UNSENT = range(len(HOW))


def how(result: Any, found: Any, ground: Ground, gone: Collection[int]) -> list[int]:
    """How many messages were lost in each way, of those whose ends were connected."""
    counts = [0] * len(HOW)
    decided, data = counted(found), result.sent[result.sent["kind"] == DATA]
    for i in np.flatnonzero(decided.state != DELIVERED):
        node, since = int(decided.node[i]), int(decided.offered_us[i])
        if ground.hops(node, int(decided.dest[i]), since) != UNREACHABLE:
            mine = (data["origin"] == node) & (data["seq"] == decided.seq[i])
            counts[_one(data[mine & (data["time"] >= since)], gone)] += 1
    return counts


def _one(sent: Any, gone: Collection[int]) -> int:
    """Which of HOW a packet was lost in, by all its transmissions."""
    if not len(sent):
        return UNSENT
    if sent["path_len"].max() >= PATH_MAX:
        return ROUND
    return DEAD if int(sent["link_dst"][-1]) in gone else LIVE


def words(runs: Sequence[Sequence[int]]) -> str:
    """The counts of all runs, as a sentence's part."""
    counts = np.sum(runs, axis=0)
    parts = [f"{count} {what}" for count, what in zip(counts, HOW, strict=True) if count]
    return f"lost were {joined(parts)}" if parts else "none was lost"
