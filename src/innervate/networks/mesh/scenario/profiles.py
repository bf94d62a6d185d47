"""What radios and their timers are like, by profile [mesh 5, 6]."""

from typing import NamedTuple

from innervate.networks.mesh.protocol.constants import ACK_BYTES

GOOD_CDB = 300  # a good link is so much above the 50 % point, both ways
REPORT_CDB = 200  # one that is reported to the gateway, so much
POOR_CDB = 100  # one that is less above it loses a quarter and more of its frames each way
SMALL = 15  # up to so many nodes a slow radio can afford twice the rounds
LARGE = 20  # above so many, it can only afford half the beacons
CROWD = 32  # up to so many nodes rounds take the time of the profile; beyond, see `crowded`
TRIES_IN_CROWD = 6  # of a table, more: who was given up waits for a round that is far off
COPIES_IN_CROWD = 3  # of a request, one more: who is not heard is not in the graph
TRANSMISSIONS_IN_CROWD = 5  # of a hop, two more: in a round hidden nodes meet again and again


class Profile(NamedTuple):
    """A radio and the timers that suit it; times in seconds where not said otherwise."""

    byte_ns: int  # airtime of a byte, ns
    phy_bytes: int  # preamble and the like
    turnaround_us: int  # from deciding to send to being on the air
    backoff_us: int  # unit of the random wait before a frame; 0 = no carrier sense
    rssi50_cdb: int  # 0.01 dBm at which half the frames are received
    loss_1m_cdb: int  # path loss at 1 m in free space, 0.01 dB
    mtu: int
    collisions: bool
    period: float
    period_max: float
    jitter: float
    copies: int
    listen: float
    spread: float
    collect: float
    transmissions: int
    ack_us: int  # wait for a hop's ack
    suspect: float
    e2e: float
    e2e_adapt: bool
    e2e_tries: int
    jobs: int
    job: float
    beacon: float
    dead_step: float  # more for every standby behind the first
    guard: float  # a standby waits so long for a sign of the gateway's life; 0 = for requests alone
    settled: float  # messages start then if nothing is said: the first tables are there
    flood: float  # floods are passed on within
    hop_acks: bool = True  # hops acknowledge; False where the medium access says what was received
    ack_adapt: bool = False  # a hop's ack may take its neighbour's round trip longer
    asks: bool = False  # who is named and did not respond is asked once more in a round
    job_tries: int = 3  # of a table, after the first


def _ack_us(turnaround_us: int, phy_bytes: int, byte_ns: int, backoff_us: int) -> int:
    """Turnaround, the ack, and two units [mesh 5]."""
    return turnaround_us + (phy_bytes + int(ACK_BYTES)) * byte_ns // 1000 + 2 * backoff_us


FAST = Profile(
    byte_ns=32_000, phy_bytes=6, turnaround_us=192, backoff_us=320, rssi50_cdb=-9500,
    loss_1m_cdb=4000, mtu=127, collisions=True, period=10, period_max=60, jitter=0.1, copies=2,
    listen=0.3, spread=0.4, collect=1.5, transmissions=3, ack_us=_ack_us(192, 6, 32_000, 320),
    suspect=10, e2e=0.25, e2e_adapt=True, e2e_tries=5,
    jobs=4, job=0.35, beacon=1, dead_step=5, guard=0.2, settled=8, flood=0.0125,
)  # fmt: skip
SLOW = Profile(
    byte_ns=208_333, phy_bytes=7, turnaround_us=2000, backoff_us=2000, rssi50_cdb=-10_500,
    loss_1m_cdb=3100, mtu=64, collisions=True, period=60, period_max=300, jitter=1.0, copies=2,
    listen=3, spread=4, collect=13, transmissions=3, ack_us=_ack_us(2000, 7, 208_333, 2000),
    suspect=10, e2e=1.5, e2e_adapt=False, e2e_tries=5,
    jobs=2, job=3, beacon=1, dead_step=5, guard=2, settled=45, flood=0.125,
)  # fmt: skip
# Nobody tells when a frame has left, so the wait begins when it is handed down: a whole frame more.
IDEAL = FAST._replace(
    collisions=False, backoff_us=0, ack_us=_ack_us(2 * 192, 12 + 127, 32_000, 320)
)
# Ethernet at 100 Mbit/s with UDP's headers; the turnaround stands for the operating system.
IP = Profile(
    byte_ns=80, phy_bytes=66, turnaround_us=200, backoff_us=0, rssi50_cdb=-9500, loss_1m_cdb=4000,
    mtu=127, collisions=False, period=2, period_max=2, jitter=0.005, copies=2, listen=0.05,
    spread=0.05, collect=0.2, transmissions=3, ack_us=5000, suspect=2, e2e=0.03, e2e_adapt=True,
    e2e_tries=8,
    jobs=4, job=0.1, beacon=0.25, dead_step=1, guard=0, settled=1, flood=0.000625,
)  # fmt: skip
PROFILES = {"250k": FAST, "38k4": SLOW, "ideal": IDEAL, "ip": IP}


def profile_of(name: str, nodes: int) -> Profile:
    """A profile as it suits so many nodes."""
    found = PROFILES[name]
    if name == "38k4" and nodes <= SMALL:
        found = found._replace(period=30)
    if name == "38k4" and nodes > LARGE:
        found = found._replace(beacon=2)
    return found


def crowded(profile: Profile, nodes: int, waiting: bool, again: bool) -> Profile:
    """The same with time for what many nodes say: it meets about the gateway (decision 0044).

    Twice as many nodes respond within three times the time, and rounds are as much further apart,
    for tables grow with the nodes, too; but not where a standby is `waiting` for them. Requests
    come by more ways: twice the jitter. With `again` each sends them once more, and a hop is tried
    more often (0058); not where the graph may be flooded, of which everybody sends each part so
    often, nor by the document's own rules.
    """
    if nodes <= CROWD:
        return profile
    more = 1 + 2 * (nodes - CROWD) / CROWD
    listen, spread = 2 * profile.listen, more * profile.spread
    rest = profile.collect - profile.listen - profile.spread
    period = profile.period if waiting else round(more * profile.period)
    return profile._replace(
        jitter=2 * profile.jitter,
        copies=COPIES_IN_CROWD if again else profile.copies,
        transmissions=TRANSMISSIONS_IN_CROWD if again else profile.transmissions,
        asks=again,
        listen=listen,
        spread=spread,
        collect=listen + spread + (5 + more) / 6 * rest,
        period=period,
        job_tries=TRIES_IN_CROWD,
    )
