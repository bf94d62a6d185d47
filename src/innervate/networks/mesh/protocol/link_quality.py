"""How good the link to a neighbour is: what share of our transmissions to it is acknowledged.

As with ETX, a link on which a share p is acknowledged takes 1 / p transmissions a frame. A frame to
a neighbour that surely lives is sent so often that its hop fails as rarely as on a good link, and
acks that are missing because the link is as it is are not held against the channel (backoff.py).
"""

ALL_ACKED = 255
RATIO_MIN = 64  # a quarter: worse is the channel, or the neighbour
SMOOTHING = 3  # an eighth of what is new
MISSES = 7  # a seventh more is what was before a miss took an eighth
TRIES_MAX = 12
UNIT = 4  # strain is counted in quarters of an ack
SPARE = 1428  # (1.4 - p) / p: the misses that go with an ack, and 0.4 / p for chance


def learn_missed(node, k):
    """The neighbour in place k, which lives, has not acknowledged a transmission."""
    if k >= 0:
        node.ack_ratio[k] = node.ack_ratio[k] - (node.ack_ratio[k] >> SMOOTHING)


def learn_acked(node, k):
    """The neighbour in place k has acknowledged a transmission."""
    if k >= 0:
        rise = ALL_ACKED + (1 << SMOOTHING) - 1 - node.ack_ratio[k]
        node.ack_ratio[k] = node.ack_ratio[k] + (rise >> SMOOTHING)


def relief(node, k):
    """How much of the strain an ack from the neighbour in place k takes back, in quarters."""
    if k < 0:
        return UNIT
    return max(UNIT, SPARE // max(node.ack_ratio[k], RATIO_MIN) - UNIT)


def tries_for(node, params, k, tries):
    """How often a frame, sent `tries` times in vain, is sent to the neighbour in place k in all.

    More than usual only where it was heard in this tick, and by what was known of the link before
    this frame: one that has died is soon not tried so, and its silence makes no poor link. Where a
    frame is to be sent once, it is [mesh A3].
    """
    if k < 0 or node.heard[k] != node.ticks or params.transmissions == 1:
        return params.transmissions
    ratio = node.ack_ratio[k]
    for _ in range(tries):
        ratio = min(ratio + ratio // MISSES + 1, ALL_ACKED)
    wanted = params.transmissions * ALL_ACKED // max(ratio, RATIO_MIN)
    return max(params.transmissions, min(wanted, TRIES_MAX))
