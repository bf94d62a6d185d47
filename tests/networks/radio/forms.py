"""Closed forms of other protocols, for many stations, that baselines are held against.

Slots; `load` is G, packets per packet time by all stations together, retransmissions included.
"""

from math import exp, log

from innervate.networks.radio.slotted.drive import Dcf

TREE_SLOTS_PER_STATION = 2 / log(2)  # 2.885; the recursion swings about it by 1e-5
# Bianchi 2000: T_s and T_c of his Table II (1 Mbit/s, 8184 bits of payload, FHSS).
BIANCHI_BASIC = Dcf(50, 8184, 8982, 8713, window=32, stages=5)
BIANCHI_RTS = Dcf(50, 8184, 9568, 417, window=32, stages=5)


def aloha_throughput(load: float) -> float:
    """Slotted ALOHA, infinite population: G e^-G, at most 1/e (Roberts 1975)."""
    return load * exp(-load)


def nonpersistent_throughput(load: float, packet_slots: float) -> float:
    """Slotted nonpersistent CSMA: a G e^-aG / (1 - e^-aG + a), a = 1 / T.

    Kleinrock and Tobagi 1975 (IEEE Trans. Commun. 23), part I.
    """
    a = 1 / packet_slots
    return a * load * exp(-a * load) / (1 - exp(-a * load) + a)


def p_persistent_throughput(load: float, packet_slots: float, p: float) -> float:
    """Slotted p-persistent CSMA, infinite population; a = 1 / T.

    Kleinrock and Tobagi 1975, part I; their sums over the slots of a wait are solved here as
    recursions over the number that waits, exactly up to a tail of about 1e-12.
    """
    a = 1 / packet_slots
    busy = (1 + a) * load
    most = int(40 + 12 * busy + 12 * a * load)
    joining = _poisson(a * load, most)
    waits, hits = _waits(joining, p, most)
    after = _poisson(busy, most)
    fresh = [x / (1 - joining[0]) for x in joining]
    idle = after[0]
    slots = hit = 0.0
    for n in range(1, most + 1):
        share = after[n] + idle * fresh[n]
        slots += share * waits[n]
        hit += share * hits[n]
    return hit / (a * slots + 1 + a + idle * a / (1 - joining[0]))


def _waits(joining: list[float], p: float, most: int) -> tuple[list[float], list[float]]:
    """By the number that waits: mean slots until somebody sends, and P(that it is one alone)."""
    waits, hits = [0.0] * (most + 1), [0.0] * (most + 1)
    for n in range(most, 0, -1):
        silent = (1 - p) ** n
        later = success = 0.0
        for more in range(1, most + 1 - n):
            later += joining[more] * waits[n + more]
            success += joining[more] * hits[n + more]
        stays = 1 - silent * joining[0]
        waits[n] = silent * (1 + later) / stays
        hits[n] = (n * p * (1 - p) ** (n - 1) + silent * success) / stays
    return waits, hits


def _poisson(mean: float, most: int) -> list[float]:
    shares = [exp(-mean)]
    for k in range(1, most + 1):
        shares.append(shares[-1] * mean / k)
    return shares
