"""Closed forms of the skin paper, and of what its errata make of them [skin III, E18-E28].

Times in s, frequencies in Hz, `k` in missed beacons, `h` in cells between the interface ports
(both included, E24), shares as fractions.
"""

FRAME_BITS = 240  # packet, framing and gap [skin 2]
LINK_BIT_S = 4_000_000


def convergence_s(beacon_hz: float, k: float) -> float:
    """Eq. 4, C_1: mean convergence of setup 1 after the cut of an interface port."""
    return (7 + k) / beacon_hz


def convergence_error_s(beacon_hz: float) -> float:
    """Eq. 5: half the width of Eq. 4's band, and of Eq. 7's."""
    return 3 / beacon_hz


def convergence_by_depth_s(depth: int, k: float, beacon_hz: float) -> float:
    """Eq. 7: convergence by the depth of the subnetwork that was cut off.

    Printed as a bound, but a mean with the error bar of Eq. 5 (E21).
    """
    return (depth + k) / beacon_hz


def beacon_share(beacon_hz: float) -> float:
    """Eq. 9: part of a link's capacity that beacons take: 0.06 % at 10 Hz (E28)."""
    return beacon_hz * FRAME_BITS / LINK_BIT_S


def loss_bound(cells: int, interfaces: int, rate_hz: float, beacon_hz: float) -> float:
    """Least share of samples that must be lost, cells split as evenly as can be [skin 2]."""
    room_hz = (1 - beacon_share(beacon_hz)) * LINK_BIT_S / FRAME_BITS
    least, more = divmod(cells, interfaces)
    offered = [(least + (i < more)) * rate_hz for i in range(interfaces)]
    return sum(max(0.0, hz - room_hz) for hz in offered) / (cells * rate_hz)
