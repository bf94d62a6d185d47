"""Where the slots of a packet's delay go: measured from what was on the air in a run."""

from typing import Any

import numpy as np

# Parts of a mean delay; they add up to it, with the turnaround and the packet itself.
TRIES = "tries before the one received"
FRAME = "padding of its opening"  # or packets that share its frame
PACKETS = "waiting behind packets"
WORDS = "behind frames without packets"
SILENCE = "in silence"  # turnarounds, windows, random waits
PARTS = (TRIES, FRAME, PACKETS, WORDS, SILENCE)


def parts(result: Any) -> dict[str, float]:
    """Means over the delivered packets, slots.

    A packet waits from its offer until a station decides to send it for the first time, and tries
    from there until the beginning of the frame that was received.
    """
    params, packets = result.plan.params, result.packets
    first, last = _sendings(result)
    waited = packets["offered"], np.maximum(first - params["ta_us"], packets["offered"])
    carries = result.sent["count"] > 0
    busy, with_packets = (_on_air(result.sent[mask], waited)
                          for mask in (np.ones(len(carries), bool), carries))  # fmt: skip
    wait = waited[1] - waited[0]
    length = packets["slots"].astype(np.int64) * params["slot_us"]
    found = {
        TRIES: last - first,
        FRAME: packets["end"] - last - length,
        PACKETS: with_packets,
        WORDS: busy - with_packets,
        SILENCE: wait - busy,
    }
    return {name: float(np.mean(us)) / params["slot_us"] for name, us in found.items()}


def _sendings(result: Any) -> tuple[Any, Any]:
    """When each delivered packet went on the air for the first time, and when it was received."""
    starts: dict[tuple[int, int], list[int]] = {}
    for row in result.sent[result.sent["count"] > 0]:
        for i in range(int(row["count"])):
            handle = (int(row["handle"]) + i) & 0xFFFF
            starts.setdefault((int(row["node"]), handle), []).append(int(row["time"]))
    found = [starts[int(row["node"]), int(row["handle"])] for row in result.packets]
    ends = result.packets["end"]
    last = [max(t for t in one if t < end) for one, end in zip(found, ends, strict=True)]
    return np.array([one[0] for one in found]), np.array(last)


def _on_air(frames: Any, spans: tuple[Any, Any]) -> Any:
    """For how long in each span one of these frames was on the air, us."""
    order = np.argsort(frames["time"], kind="stable")
    start = frames["time"][order]
    until = np.maximum.accumulate(frames["end"][order])
    begins = np.maximum(start, np.concatenate([[0], until[:-1]]))
    gone = np.concatenate([[0], np.cumsum(np.maximum(until - begins, 0))])
    moments = np.concatenate([[0], np.column_stack([begins, until]).ravel()])
    moments = np.maximum.accumulate(moments)
    levels = np.concatenate([[0], np.column_stack([gone[:-1], gone[1:]]).ravel()])
    low, high = (np.interp(span, moments, levels) for span in spans)
    return high - low
