"""Parameters of the baselines of a shared channel [radio 9], and the devices each is granted."""

from typing import Literal, NamedTuple

# How stations know their protocol (params.mac); 0 is CSMA/CD-R.
D1, D2, D2P, DCF, ALOHA, NONPERSISTENT, P_PERSISTENT, TDMA, TREE, TOKEN_RING, POLLING = range(1, 12)
NUMBERS = {
    "csma-cd-d1": D1,
    "csma-cd-d2": D2,
    "csma-cd-d2p": D2P,
    "dcf": DCF,
    "slotted-aloha": ALOHA,
    "nonpersistent": NONPERSISTENT,
    "p-persistent": P_PERSISTENT,
    "tdma": TDMA,
    "tree": TREE,
    "token-ring": TOKEN_RING,
    "polling": POLLING,
}
NONE = {
    "mac": 0, "stations": 1, "oracle": 0, "full_duplex": 0, "period_us": 0, "gap_us": 0,
    "answer_us": 0, "backoff_us": 208, "cw_min": 32, "cw_max": 1024, "p_q15": 3277,
}  # fmt: skip
ONE_Q15 = 32_768
TOKEN_SLOTS = 2  # token ring: the token; polling: a poll
ANSWER_SLOTS = 2  # DCF: a one-byte answer and the idle slot before it
TOLD_OF = {
    "anybody": 1,
    "everybody": 2,
}  # params.oracle: who must have a packet; 0 = it is not told
ReceivedBy = Literal["anybody", "everybody"]
Answers = Literal["instant", "turnaround"]


class Draws(NamedTuple):
    """What a baseline draws from."""

    p: float = 0.1  # probability to send in a slot (ALOHA after a collision; CSMA)
    cw_min: int = 32  # DCF draws its backoff from so many values
    cw_max: int = 1024  # ... doubled at each collision up to this
    backoff_slots: int = 1  # length of a slot of the backoff


DRAWS = Draws()


class Granted(NamedTuple):
    """What a sender is told of its packets, and how long the channel is kept for that.

    In IEEE 802.11 one receiver answers; a packet for all is neither answered nor sent again (9.2.7
    of the 1999 edition). Packets of a team are for all.
    """

    received_by: ReceivedBy = "anybody"  # it is told to send again until these have it
    answers: Answers = "instant"  # DCF: radios switch in no time, or there and back


GRANTED = Granted()


def answering(granted: Granted, slot_us: int, heard_us: int) -> int:
    """How long the channel is kept for an answer, us; a carrier is heard after `heard_us`."""
    return ANSWER_SLOTS * slot_us if granted.answers == "instant" else 2 * heard_us + slot_us


def baseline(
    mac: str,
    stations: int,
    params: dict[str, int],
    draws: Draws = DRAWS,
    granted: Granted = GRANTED,
) -> dict[str, int]:
    """The parameters of a run with what a baseline needs besides.

    A cable (D1) has no turnaround. All but D1 have an oracle: the sender learns who received its
    packet as soon as all who hear it have heard its end. Everybody hears every packet to its end:
    slots are long enough, and between two packets there is a slot where there is no common clock.
    `mac` is its name in a scenario, a key of NUMBERS; `params` are those of `plan.parameters`.
    """
    number = NUMBERS[mac]
    slot, turn = params["slot_us"], 0 if number == D1 else params["ta_us"]
    heard = turn + params["dmax_us"]  # from a decision until all hear a carrier
    packet = params["packet_slots"] * slot
    period = {
        # The outcome is known to all, and the next sender hears all of the packet before.
        ALOHA: turn + packet + max(heard - turn, turn) + params["bit_us"],
        TREE: turn + packet + max(heard - turn, turn) + params["bit_us"],
        TDMA: packet + max(slot, heard),
        NONPERSISTENT: max(slot, heard),
        P_PERSISTENT: max(slot, heard),
    }
    return params | {
        "ta_us": turn,
        "mac": number,
        "stations": stations,
        "oracle": TOLD_OF[granted.received_by] if number != D1 else 0,
        "full_duplex": int(number == D1),
        "period_us": period.get(number, 0),
        "gap_us": max(slot - params["dmax_us"], params["bit_us"]),
        "answer_us": answering(granted, slot, heard) if number == DCF else 0,
        "backoff_us": draws.backoff_slots * slot,
        "cw_min": draws.cw_min,
        "cw_max": draws.cw_max,
        "p_q15": max(1, round(draws.p * ONE_Q15)),
    }
