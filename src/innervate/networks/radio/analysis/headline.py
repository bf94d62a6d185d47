"""The headline of a radio team, from facts that runs, running simulations and stations all have."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

from innervate.analysis.headline import DEGRADED, DOWN, NO_DATA, OK, Headline, every, sentence, verb
from innervate.analysis.words import figure_words
from innervate.kernel.words import number_of

NAMED = 4  # so many robots are named one by one
ROUNDS = 4  # turns of everybody that may pass before somebody's packet gets through
BACKOFF_SLOTS = 1024  # ... besides the longest backoff

Stations = tuple[int, ...]


class RadioFacts(NamedTuple):
    """What is known of a team at one moment.

    `offered` = delivered + lost_silently + pending + abandoned + dropped, where all are known.
    """

    stations: int  # how many belong to the team
    off: Stations = ()  # who was switched off, died or does not answer
    away: Stations = ()  # who left, or has not joined yet; that is no fault
    answering: bool = True  # False = nobody says anything, and nothing is known
    offered: int = 0  # packets that were to be sent
    delivered: int = 0  # packets that somebody received, as their senders know
    pending: int = 0  # packets that wait in robots that are on
    abandoned: int = 0  # packets of robots that are off or away
    dropped: int = 0  # packets that full queues refused
    lost_silently: int = 0  # packets that nobody received and their senders take for delivered
    partial: int = 0  # delivered packets that not everybody received who could hear
    # pending packets that have waited longer than `timeout_ms`, or that a run which was to
    # deliver them all did not deliver
    overdue: int = 0
    waiting: Stations = ()  # who has overdue packets
    # how long nothing has been delivered though somebody who is on had a packet
    still_ms: float = 0.0
    timeout_ms: float = 1000.0  # how long that may take, see `timeout_us`
    hidden: tuple[tuple[int, int], ...] = ()  # pairs that do not hear each other
    # where delays are not as believed, "believed_us": [least, greatest]; None = they are, as
    # far as is known
    bounds: Mapping[str, Any] | None = None
    stations_wrong: Stations = ()  # who noticed it
    ended: bool = False  # nothing more will happen
    others: bool = False  # running stations only: more than these are heard on the channel


def timeout_us(params: Mapping[str, int], stations: int) -> int:
    """How long a channel on which somebody waits may deliver nothing, us.

    Of the protocol's `params` it takes times as a plan has them, and `per_turn` if there is one.
    """
    slot_us = params["slot_us"]
    turn_slots = params["packet_slots"] * params.get("per_turn", 1) + 1
    turn_us = turn_slots * slot_us + 2 * (params["ta_us"] + params["dmax_us"])
    step_us = max(slot_us, params.get("backoff_us", 0))
    return ROUNDS * stations * turn_us + max(BACKOFF_SLOTS, params.get("cw_max", 0)) * step_us


def headline(facts: RadioFacts, label: Callable[[int], str] = str, absent: str = "off") -> Headline:
    """The state of a team; of stations that are missing it says `absent`: "off", "silent"."""
    if not facts.answering:
        return Headline(NO_DATA, "No robot answers.", tuple(range(facts.stations)))
    down, nodes = _down(facts, label, absent)
    worse, more = _degraded(facts, label, absent, told=bool(down))
    if not (down or worse or facts.offered) and facts.ended:
        return Headline(NO_DATA, "No packet was offered.")
    said = [*down, *worse, *_counts(facts)]
    if not said:  # whoever was offered packets has left with them
        was = "was" if facts.ended else "has been"
        return Headline(NO_DATA, f"No packet {was} offered to a robot that stayed.")
    level = DOWN if down else DEGRADED if worse else OK
    return Headline(level, sentence(said), tuple(sorted({*nodes, *more})))


def _down(
    facts: RadioFacts, label: Callable[[int], str], absent: str
) -> tuple[list[str], tuple[int, ...]]:
    """Why nothing gets through; who is concerned."""
    gone = {*facts.off, *facts.away}
    on = [station for station in range(facts.stations) if station not in gone]
    if not on:
        where = " the channel" if absent == "silent" else ""  # they answer, and may be without it
        return [f"no robot is on{where}"], tuple(range(facts.stations))
    if len(on) == 1 and not facts.others:
        return [f"robot {label(on[0])} is alone: nobody can receive its packets"], (on[0],)
    if facts.pending and facts.still_ms > facts.timeout_ms:
        waits = f"{number_of(facts.pending, 'packet')} {verb(facts.pending, 'waits')}"
        return [
            f"nothing has been delivered for {_time(facts.still_ms)} although {waits}"
        ], facts.waiting
    if facts.lost_silently and not facts.delivered:
        return ["not one packet was received"], tuple(on)
    if facts.ended and facts.pending and not facts.delivered:
        return ["nothing got through"], facts.waiting or tuple(on)
    return [], ()


def _degraded(
    facts: RadioFacts, label: Callable[[int], str], absent: str, told: bool
) -> tuple[list[str], tuple[int, ...]]:
    """What is lost, late or cut off, the worst first; `told`: that nothing gets through is said."""
    news: list[str] = []
    nodes: set[int] = set()
    if facts.lost_silently:
        lost = number_of(facts.lost_silently, "packet")
        was = verb(facts.lost_silently, "was")
        news.append(f"{lost} {was} lost silently, taken for delivered by the sender")
    if facts.off and len(facts.off) + len(facts.away) < facts.stations:
        left = 0 if facts.away else facts.abandoned  # else nobody can say whose they are
        with_it = f" with {number_of(left, 'packet')} not sent" if left else ""
        news.append(f"{_robots(map(label, facts.off))} {absent}{with_it}")
        nodes |= set(facts.off)
    if facts.dropped:
        news.append(f"{number_of(facts.dropped, 'packet')} found a full queue")
    if facts.overdue and not told:
        who = number_of(facts.overdue, "packet")
        news.append(f"{who} {verb(facts.overdue, 'was')} not delivered in time")
        nodes |= set(facts.waiting)
    if facts.bounds is not None and not facts.hidden:  # what hidden frames end in is no delay
        news.append(_wrong(facts.bounds))
        nodes |= set(facts.stations_wrong)
    if facts.hidden:
        count = len(facts.hidden)
        pairs = f"{number_of(count, 'pair')} of robots {verb(count, 'does')}"
        news.append(f"{pairs} not hear each other")
        nodes |= {station for pair in facts.hidden for station in pair}
    if facts.partial:
        missed = number_of(facts.partial, "delivered packet")
        news.append(f"{missed} did not reach every robot")
    return news, tuple(nodes)


def _counts(facts: RadioFacts) -> list[str]:
    """How many packets came through, of those whose robots stayed."""
    if not facts.offered:
        return [f"no packet {'was' if facts.ended else 'has been'} offered"]
    expected = facts.offered - facts.abandoned
    if not facts.delivered:
        yet = "was delivered" if facts.ended else "has been delivered yet"
        return [f"of {number_of(expected, 'packet')} none {yet}"] if expected else []
    if facts.delivered == expected:
        which = "the packet was" if expected == 1 else f"{every(expected, 'packet')} were"
        return [f"{which} delivered"] if expected else []
    share = f"{facts.delivered:,} of {number_of(expected, 'packet')} "
    share += f"{verb(facts.delivered, 'was')} delivered"
    fresh = facts.pending - facts.overdue
    if fresh > 0 and facts.pending < expected:
        share += f", {fresh:,} {'still waited' if facts.ended else verb(fresh, 'waits')}"
    return [share]


def _wrong(bounds: Mapping[str, Any]) -> str:
    """Delays that are not what stations believe.

    What a station took for the delay is not told: a CR-R that comes too early looks late in the
    minislot before its own.
    """
    believed = bounds.get("believed_us")
    if not believed:
        return "delays lie outside what stations believe"
    return f"delays lie outside the {believed[0]:g} to {believed[1]:g} us that stations believe"


def _robots(names: Iterable[str]) -> str:
    """Who is: "robot 3 is", "robots 3 and 5 are", "12 robots are"."""
    who = list(names)
    if len(who) == 1:
        return f"robot {who[0]} is"
    if len(who) > NAMED:
        return f"{len(who)} robots are"
    return f"robots {', '.join(who[:-1])} and {who[-1]} are"


def _time(value_ms: float) -> str:
    return f"{figure_words(value_ms / 1000)} s" if value_ms >= 999.5 else f"{value_ms:.3g} ms"
