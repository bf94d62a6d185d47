"""How good the link to a neighbour is: what share of our transmissions to it is acknowledged.

As with ETX, a link on which a share p is acknowledged takes 1 / p transmissions a frame. A frame to
a neighbour that surely lives is sent so often that its hop fails as rarely as on a good link, and
acks that are missing because the link is as it is are not held against the channel (backoff.py).
"""

ALL_ACKED = 255
RATIO_MIN = 64  # a quarter: worse is the channel, or the neighbour
POOR_MIN = 32  # an eighth, of who is heard so faintly that the link itself loses much
SMOOTHING = 3  # an eighth of what is new
MISSES_MAX = 31  # so many in a row leave nothing of a ratio
TRIES_MAX = 12
UNIT = 4  # strain is counted in quarters of an ack
SPARE = 1428  # (1.4 - p) / p: the misses that go with an ack, and 0.4 / p for chance


def note_miss(node, k):
    """The neighbour in place k has not acknowledged a transmission.

    That counts as soon as it acknowledges another: one that has died does not make a poor link,
    which would be tried the more often, the longer it is silent.
    """
    if k >= 0:
        node.misses[k] = min(node.misses[k] + 1, MISSES_MAX)


def learn_misses(node, k):
    """The neighbour in place k answers again: what it did not acknowledge was lost on the link."""
    for _ in range(node.misses[k]):
        node.ack_ratio[k] = node.ack_ratio[k] - (node.ack_ratio[k] >> SMOOTHING)
    node.misses[k] = 0


def learn_ack(node, k):
    """The neighbour in place k has acknowledged a transmission."""
    rise = ALL_ACKED + (1 << SMOOTHING) - 1 - node.ack_ratio[k]
    node.ack_ratio[k] = node.ack_ratio[k] + (rise >> SMOOTHING)


def relief(node, params, k):
    """How much of the strain an ack from the neighbour in place k takes back, in quarters.

    Faint links lose frames whether others send or not; loud ones do in a full channel.
    """
    least = RATIO_MIN
    if node.rssi[k] < 4 * params.poor:
        least = POOR_MIN
    return max(UNIT, SPARE // max(node.ack_ratio[k], least) - UNIT)


def tries_for(node, params, k):
    """How often a frame is sent to the neighbour in place k before it counts as unanswered.

    More than usual only where it was heard in this tick: one that has died is soon not tried so.
    Where a frame is to be sent once, it is [mesh A3].
    """
    if k < 0 or node.heard[k] != node.ticks or params.transmissions == 1:
        return params.transmissions
    wanted = params.transmissions * ALL_ACKED // max(node.ack_ratio[k], RATIO_MIN)
    return max(params.transmissions, min(wanted, TRIES_MAX))
