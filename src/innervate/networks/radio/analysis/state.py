"""What is known of a simulated radio team at one moment: while it runs, and when it has ended."""

from collections.abc import Iterable
from typing import Any

from innervate.networks.radio.analysis.headline import RadioFacts, Stations, timeout_us
from innervate.scenario.actions.channel import JOIN, KILL, LEAVE
from innervate.sim.channel.world import RING
from innervate.sim.tables import get


def _overdue(plan: Any, waits: dict[int, list[int]], before_us: int, ended: bool) -> dict[int, int]:
    """Per station how many packets wait too long; of a run that had a goal and has ended, all."""
    goal = ended and not plan.saturated and plan.wanted > 0
    return {
        i: len(offers) if goal else sum(at < before_us for at in offers)
        for i, offers in waits.items()
    }


def _still_ms(waits: Iterable[list[int]], now_us: int, delivered_us: int) -> float:
    """For how long packets have waited and none was delivered."""
    oldest = min((offers[0] for offers in waits if offers), default=now_us)
    return max(0, now_us - max(oldest, delivered_us)) / 1e3


def facts(
    world: Any,
    plan: Any,
    now_us: int,
    delivered_us: int,
    *,
    faults: Iterable[Any] = (),
    ended: bool = False,
) -> RadioFacts:
    """The facts of a simulation's world; `bounds` as the plan has them, whoever noticed.

    `delivered_us`: when the newest packet was known to be delivered; 0 = none yet. `faults`: what
    was done to the team besides the plan's own. `ended`: nothing more will happen.
    """
    on, off, away = _presence(world, plan, now_us)
    since = switched_on(plan, faults, now_us)
    waits = {i: waiting(world, i, since[i]) for i in range(plan.stations)}
    timeout = timeout_us(plan.params, plan.stations)
    overdue = _overdue(plan, {i: waits[i] for i in on}, now_us - timeout, ended)
    believed_us = [plan.params["dmin_us"], plan.params["dmax_us"]]
    run = {name: int(get(world.run, 0, name)) for name in _COUNTS}
    return RadioFacts(
        stations=plan.stations,
        off=off,
        away=away,
        offered=run["offers"],
        delivered=run["completed"] - run["silent"],
        pending=sum(len(waits[i]) for i in on),
        abandoned=sum(len(waits[i]) for i in (*off, *away)),
        dropped=run["dropped"],
        lost_silently=run["silent"],
        partial=run["partial"],
        overdue=sum(overdue.values()),
        waiting=tuple(i for i in on if overdue[i]),
        still_ms=_still_ms((waits[i] for i in on), now_us, delivered_us),
        timeout_ms=timeout / 1e3,
        hidden=plan.pairs.hidden,
        bounds=None if plan.pairs.within(*believed_us) else {"believed_us": believed_us},
        ended=ended,
    )


def pending(world: Any, stations: int) -> int:
    """Packets that wait in robots that are on."""
    return sum(
        int(get(world.radios, i, "backlog"))
        for i in range(stations)
        if get(world.radios, i, "alive")
    )


_COUNTS = ("offers", "completed", "silent", "dropped", "partial")


def _presence(world: Any, plan: Any, now_us: int) -> tuple[list[int], Stations, Stations]:
    """Who is on, who was switched off, who left or has not come yet."""
    if now_us == 0:  # everybody begins at 0
        absent = {i for i, flag in enumerate(plan.absent) if flag}
        return [i for i in range(plan.stations) if i not in absent], (), tuple(sorted(absent))
    found: dict[str, list[int]] = {"on": [], "off": [], "away": []}
    for i in range(plan.stations):
        alive, leaving = (int(get(world.radios, i, name)) for name in ("alive", "leaving"))
        found["on" if alive else "away" if leaving else "off"].append(i)
    return found["on"], tuple(found["off"]), tuple(found["away"])


def switched_on(plan: Any, faults: Iterable[Any], now_us: int) -> list[int]:
    """Per robot, when it was switched on last, us; one that is on is not switched on.

    Who was told to leave is taken for gone from then on, though it stays while it has packets.
    """
    since = [0] * plan.stations
    on = [not absent for absent in plan.absent] or [True] * plan.stations
    for fault in sorted([*plan.faults, *faults], key=lambda fault: fault.at_us):
        if fault.at_us > now_us:
            break
        if fault.action == JOIN and not on[fault.node]:
            since[fault.node] = fault.at_us
        if fault.action in (JOIN, KILL, LEAVE):
            on[fault.node] = fault.action == JOIN
    return since


def waiting(world: Any, station: int, since_us: int = 0) -> list[int]:
    """Since when each packet in a robot could have been sent, us, the oldest first."""
    radio = {name: int(get(world.radios, station, name)) for name in ("backlog", "fresh")}
    first = radio["fresh"] - radio["backlog"]
    places = [station * RING + ((first + i) & (RING - 1)) for i in range(radio["backlog"])]
    return [max(int(world.offered[at]), since_us) for at in places]
