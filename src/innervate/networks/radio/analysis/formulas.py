"""Closed forms of the radio: CSMA/CD-R, its bounds and the protocols next to it [radio 4, 6, 9].

Times in slots unless a name ends in _us; n stations, packets of T slots; shares as fractions.
`load` is G, packets per packet time by all stations together, retransmissions included.
"""

from math import comb


def reserved_round_slots(
    stations: int, packet_slots: int, reading: str = "A", window: int | None = None
) -> int:
    """A collision of n >= 2 stations and the packets of all of them, CSMA/CD-R [radio Q1].

    Reading A: collision T + 1, first report 1, window (default T), then T + 1 a packet.
    B: collision T, n - 1 reports of a slot, window, then T a packet.
    """
    held = packet_slots if window is None else window
    if reading == "A":
        return packet_slots + 2 + held + stations * (packet_slots + 1)
    return packet_slots + stations - 1 + held + stations * packet_slots


def reserved_throughput(
    stations: int, packet_slots: int, reading: str = "A", window: int | None = None
) -> float:
    """Saturation throughput of CSMA/CD-R; A: n T / (n (T + 1) + 2 T + 2) [radio F5, 10]."""
    if stations == 1:
        return slotted_bound(packet_slots)
    whole = reserved_round_slots(stations, packet_slots, reading, window)
    return stations * packet_slots / whole


def reserved_duration_slots(stations: int, packet_slots: int, reading: str = "A") -> int:
    """T_D of a disaster with CSMA/CD-R: one round, without the idle slot that ends it in A."""
    if stations == 1:
        return packet_slots
    return reserved_round_slots(stations, packet_slots, reading) - (reading == "A")


def resolved_duration_us(
    collision_end_us: int, stations: int, packet_us: int, tau_us: int, report_us: int, tc0_us: int
) -> int:
    """T_D of a fully resolved run on the medium: ta = 0, equal delays, gaps over a slot [radio 4].

    `collision_end_us` is the end of the last colliding packet, `tc0_us` by how much it was last.
    """
    reports = 2 * tau_us + report_us + packet_us - tc0_us
    return collision_end_us + reports + stations * packet_us + (stations - 1) * tau_us


def slotted_bound(packet_slots: float) -> float:
    """T / (T + 1): TDMA, and what slotted CSMA/CD-R tends to: 0.833 and 0.9615 [radio Q1, 9]."""
    return packet_slots / (packet_slots + 1)


def handover_bound(
    packet_slots: float, turnaround_slots: float = 0.0, delay_slots: float = 0.5
) -> float:
    """T / (T + ta + d): every packet heard by all, one a turn; d = mean pair delay [radio F4, 10].

    With ta = 0 and d = tau, half a slot: 0.909 (T = 5), 0.980 (T = 25).
    """
    return packet_slots / (packet_slots + turnaround_slots + delay_slots)


def pair_duration_slots(packet_slots: int, cost_slots: int, linear: bool = False) -> float:
    """Mean T_D of two stations with 802.3 backoff, a collision costing `cost_slots`.

    After k collisions both draw from min(2^k, 1024) values (`linear`: k + 1); equal draws collide
    again, else the later one follows when the channel is idle again.
    """
    duration = 0.0
    for collisions in range(30, 0, -1):
        values = collisions + 1 if linear else 1 << min(collisions, 10)
        again = (values - 1) / 2 + cost_slots + duration
        duration = again / values
        for apart in range(1, values):
            first = (values - 1 - apart) / 2
            done = first + max(packet_slots + 1, apart) + packet_slots
            duration += 2 * (values - apart) / values**2 * done
    return cost_slots + duration


def finite_aloha_throughput(stations: int, p: float) -> float:
    """Slotted ALOHA, n saturated stations that send with probability p: n p (1 - p)^(n-1)."""
    return stations * p * (1 - p) ** (stations - 1)


def finite_csma_throughput(stations: int, packet_slots: int, p: float) -> float:
    """Slotted CSMA, n saturated stations that send in an idle slot with probability p.

    A renewal argument: idle slots of 1, packets and collisions of T + 1.
    """
    idle = (1 - p) ** stations
    busy = (1 - idle) * (packet_slots + 1)
    return finite_aloha_throughput(stations, p) * packet_slots / (idle + busy)


def dcf_attempt(stations: int, window: int, stages: int) -> tuple[float, float]:
    """(tau, p) of 802.11 DCF: a station's probability to send in a step, and to collide then.

    Bianchi 2000 (IEEE JSAC 18), eqs. 7 and 9; `window` W values, doubled at most m times.
    """
    low, high = 0.0, 1.0
    for _ in range(100):
        tau = (low + high) / 2
        collide = 1 - (1 - tau) ** (stations - 1)
        grown = sum((2 * collide) ** k for k in range(stages))
        if 2 / (1 + window + collide * window * grown) > tau:
            low = tau
        else:
            high = tau
    return tau, collide


def dcf_throughput(
    stations: int,
    window: int,
    stages: int,
    *,
    payload: float,
    success: float,
    collision: float,
) -> float:
    """Saturation throughput of 802.11 DCF (Bianchi 2000, eq. 13); all times in slots.

    `success` and `collision` are his T_s and T_c. An approximation: stations are independent.
    """
    tau, _ = dcf_attempt(stations, window, stages)
    idle = (1 - tau) ** stations
    alone = finite_aloha_throughput(stations, tau)
    return alone * payload / (idle + alone * success + (1 - idle - alone) * collision)


def tree_slots(stations: int) -> float:
    """Mean steps of a binary splitting of n stations (Capetanakis 1979), by the exact recursion.

    1 for n = 0 and 1, 5 for 2, 23/3 for 3; tends to 2.885 n.
    """
    steps = [1.0, 1.0]
    for n in range(2, stations + 1):
        parts = sum(comb(n, i) / 2**n * steps[i] for i in range(n))
        steps.append((1 + 2 * parts) / (1 - 2 / 2**n))
    return steps[stations]


def tree_throughput(stations: int) -> float:
    """Saturated stations in splittings of n, every step as long as a packet: n / tree_slots(n)."""
    return stations / tree_slots(stations)
