"""Parameters of a live station; whole numbers."""

from innervate.live.channel import SLOT_US_MIN
from innervate.live.errors import LiveError
from innervate.live.parameters import check_parameters
from innervate.networks.radio.protocol.fields import PARAMS

# A channel of processes: slots of 10 ms, a turnaround of 5 ms, and stations that act up to 3 ms
# late; the rest follows as docs/radio.md says.
RADIO: dict[str, int] = {
    "slot_us": 10_000, "bit_us": 1250, "ta_us": 5000, "dmin_us": 1, "dmax_us": 3000,
    "packet_slots": 20, "minislot_us": 17_248, "probe_us": 25_000, "retry_us": 58_000,
    "join_us": 609_184, "dead_us": 36_248, "turns": 20, "per_turn": 1, "wait_us": 400_000,
    "tail_rule": 1, "overlap_rule": 1, "window_slots": 0, "dilate": 1, "mac": 0, "stations": 1,
    "oracle": 0, "full_duplex": 0, "period_us": 0, "gap_us": 0, "answer_us": 0, "backoff_us": 208,
    "cw_min": 32, "cw_max": 1024, "p_q15": 3277,
}  # fmt: skip


def radio_parameters(changes: dict[str, int], where: str = "") -> dict[str, int]:
    """A station's parameters, with what is to be different, as `check_parameters` allows it."""
    check_parameters(changes, PARAMS, where)
    return {**RADIO, **changes}


def check_slots(params: dict[str, int]) -> None:
    """Refuse what cannot work in real time; LiveError if a slot is shorter than a PC can keep."""
    if params["slot_us"] < SLOT_US_MIN:
        raise LiveError(
            f"protocol.slot_us = {params['slot_us']}: a PC keeps slots of {SLOT_US_MIN} us or more"
        )
