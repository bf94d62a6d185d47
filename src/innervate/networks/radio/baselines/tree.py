"""Binary splitting with gated access (Capetanakis 1979).

Whoever has a packet when a resolution begins takes part and sends. A collision splits those who
sent by a fair bit; the others wait until they are done. Everybody hears what a slot brought:
nothing, a packet, noise; a sender is told by the oracle. A station that comes later, or read a
slot otherwise than the others, believes in another stack, which puts its packets among theirs.
"""

from innervate.dialect.rng import draw
from innervate.networks.radio.baselines.common import LISTEN, TOLD, arm, arrived, collided, transmit
from innervate.networks.radio.baselines.slots import boundary, sync

NOTHING, NOISE, READ = 0, 1, 2
OUT = -1
DEPTH_MAX = 1 << 20


def begin(station, params, now, out):
    """The clock is set: no resolution is under way."""
    station.heard = NOTHING
    station.told = NOTHING
    station.depth = OUT
    station.branches = 0
    arm(station, boundary(station, params, now), out)


def fire(station, params, now, out):
    """A slot begins: go down the tree by what the slot before held, perhaps send."""
    sync(station, params, now)
    arm(station, now + params.period_us, out)
    if station.branches:
        visit(station)
    station.heard = NOISE if station.cd else NOTHING
    station.told = NOTHING
    if station.branches == 0:
        station.branches = 1
        station.depth = 0 if station.queued else OUT
    if station.depth == 0 and station.queued and station.mode == LISTEN:
        transmit(station, params, now, out)
        station.armed = 1


def visit(station):
    """What the slot that is over brought."""
    if station.heard == NOISE or station.told == NOISE:
        station.branches = min(station.branches + 1, DEPTH_MAX)
        if station.depth == 0:
            station.depth = draw(station, 2)
        elif station.depth > 0:
            station.depth = min(station.depth + 1, DEPTH_MAX)
    else:
        station.branches = station.branches - 1
        if station.depth >= 0:
            station.depth = station.depth - 1


def told(station, received, out):
    """What became of our packet."""
    station.mode = LISTEN
    if received:
        station.told = READ
        arrived(station, out)
    else:
        station.told = NOISE
        collided(station, out)


def ready(station):
    """Our radio listens again after sending."""
    station.mode = TOLD
