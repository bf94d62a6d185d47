"""The plan of a radio run: whole numbers only. Floats end here."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple, Self

from innervate.networks.radio.scenario.baselines import NONE
from innervate.scenario.declared.channel import Fault

RadioFault = Fault  # one event of a run: what happens on any channel


@dataclass(frozen=True, slots=True)
class Pairs:
    """Who hears whom, and from how far."""

    # Pairs that do not hear each other, the smaller number first.
    hidden: tuple[tuple[int, int], ...]
    # Least and greatest delay between stations that hear each other; None = nobody.
    delay_us: tuple[int, int] | None

    @classmethod
    def of(cls, delays_us: list[list[int]]) -> Self:
        """Of the delays per sender and receiver, us; -1 = hidden."""
        stations = range(len(delays_us))
        apart = {delays_us[i][j] for i in stations for j in stations if i != j} - {-1}
        return cls(
            tuple(
                (i, j)
                for j in stations
                for i in range(j)
                if delays_us[i][j] < 0 or delays_us[j][i] < 0
            ),
            (min(apart), max(apart)) if apart else None,
        )

    def within(self, least_us: int, greatest_us: int) -> bool:
        """True if no delay lies outside these bounds."""
        return self.delay_us is None or (
            least_us <= self.delay_us[0] and self.delay_us[1] <= greatest_us
        )


@dataclass(slots=True)
class RadioPlan:
    """Everything a radio run needs, as whole numbers."""

    scenario: Any
    kind: str
    seed: int
    duration_us: int
    protocol: str  # the medium access protocol by its simulator name, like "csma-cd-r/practical"
    stations: int  # how many, 1 .. 1023
    params: dict[str, int]  # the protocol's parameters (see `protocol/fields.py`, PARAMS)
    # Per sender and receiver, us; -1 = hidden from each other. Zero on the diagonal.
    delays_us: list[list[int]]
    loss_q15: int = 0  # share of frames that a receiver cannot read, in 1/32768
    saturated: bool = False  # a new packet whenever one was delivered
    wanted: int = 0  # the run ends after so many delivered packets; 0 = runs its time
    # Per station, ascending moments at which a packet is offered, us.
    arrivals: list[list[int]] = field(default_factory=list)
    # Per station, lengths in slots of its packets in turn; at most 1,024, repeated.
    sizes: list[list[int]] = field(default_factory=list)
    absent: list[int] = field(default_factory=list)  # per station, 1 = switched off until it joins
    faults: list[RadioFault] = field(default_factory=list)  # events in order of time
    # Packets go out when offered, whatever the carrier says (paper mode's tests).
    forced: bool = False
    _pairs: Pairs | None = field(default=None, init=False, repr=False, compare=False)

    @property
    def pairs(self) -> Pairs:
        """What the delays say of who hears whom; worked out once, as pages ask at each moment."""
        if self._pairs is None:
            self._pairs = Pairs.of(self.delays_us)
        return self._pairs


class Rules(NamedTuple):
    """What the stations of CSMA/CD-R have agreed on."""

    turns: int = 20  # turns of a round between two open windows
    per_turn: int = 1  # most packets in one turn, 1 .. 8
    wait_us: int = 0  # W, bound of the random wait (paper); 0 = two packets
    tail_rule: int = 1  # T1, without which the last and the second to last both report (paper)
    overlap_rule: int = 1  # T4, without which CR-Rs that overlap count as one (paper)
    window_slots: int = 0  # window for CR-Rs in slots; 0 = T - Tc0 (paper)
    dilate: int = 1  # factor on Tc, so that CR-Rs spread over the window; 2 T - 6 fills it (paper)


def parameters(
    packet_slots: int,
    turnaround_us: int = 0,
    delay_us: tuple[int, int] = (52, 104),
    *,
    bit_us: int = 26,
    **rules: int,
) -> dict[str, int]:
    """Derived times of CSMA/CD-R; names and reasons in docs/radio.md [radio 4, radio-practical 2].

    Args:
        packet_slots: T, length of the longest packet, 3 .. 4095.
        turnaround_us: ta, from deciding to send to being on the air, and back.
        delay_us: least and greatest delay between two stations, as the stations believe.
        bit_us: time of a bit; a slot is 8.
        rules: what stations have agreed on, as in `Rules`.
    """
    agreed = Rules(**rules)
    slot_us = 8 * bit_us
    least, most = delay_us
    minislot = slot_us + 2 * (most - least) + bit_us
    retry = 6 * (turnaround_us + most) + slot_us
    return {
        "slot_us": slot_us,
        "bit_us": bit_us,
        "ta_us": turnaround_us,
        "dmin_us": least,
        "dmax_us": most,
        "packet_slots": packet_slots,
        "minislot_us": minislot,
        # Two openings must overlap at every station, whatever their delays.
        "probe_us": turnaround_us + max(2 * slot_us, 2 * most - least + slot_us),
        "retry_us": retry,
        "join_us": 2 * turnaround_us + max(retry + 2 * minislot, 33 * minislot) + 3 * slot_us,
        "dead_us": 2 * turnaround_us + 3 * most + minislot,
        **{name: int(value) for name, value in agreed._asdict().items()},
        "wait_us": agreed.wait_us or 2 * packet_slots * slot_us,
        **NONE,
    }
