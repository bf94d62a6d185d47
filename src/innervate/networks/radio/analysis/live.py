"""What is known of running stations at one moment, from what they say of themselves."""

from collections.abc import Iterable, Mapping
from typing import Any

from innervate.networks.radio.analysis.headline import RadioFacts, Stations, timeout_us


class Still:
    """Since when running stations deliver nothing though somebody has a packet."""

    def __init__(self) -> None:
        self._since_us: int | None = None
        self._delivered = -1

    def note(self, now_us: int, told: Iterable[Mapping[str, Any]]) -> float:
        """Take in what they say now; how long nothing has been delivered, ms."""
        stations = list(told)
        delivered = sum(int(one["counters"].get("packets delivered", 0)) for one in stations)
        waits = any(one.get("queued", 0) for one in stations)
        if self._since_us is None or delivered != self._delivered:
            self._since_us = now_us
        still_ms = (now_us - self._since_us) / 1e3 if waits else 0.0
        self._since_us = self._since_us if waits else None
        self._delivered = delivered
        return still_ms


def of_stations(
    told: Mapping[int, Mapping[str, Any]],
    stations: int,
    off: Stations,
    still_ms: float,
    params: Mapping[str, int],
) -> RadioFacts:
    """The facts of running stations, from what they say of themselves.

    `told`: by index what those say that answer, as `innervate live status --json` shows it; `off`:
    who does not, or is off the channel; `still_ms`: see Still. Stations that run elsewhere are
    those that the channel names; where it names none, the only one here has heard somebody.
    """
    count = {name: 0 for name in ("packets accepted", "packets delivered")}
    for one in told.values():
        for name in count:
            count[name] += int(one.get("counters", {}).get(name, 0))
    accepted, delivered = count.values()
    abandoned = sum(int(told[i].get("queued", 0)) for i in off if i in told)
    queued = {i: int(one.get("queued", 0)) for i, one in told.items() if i not in off}
    timeout_ms = timeout_us(params, stations) / 1e3
    return RadioFacts(
        stations=stations,
        off=off,
        answering=bool(told),
        offered=accepted,
        delivered=delivered,
        pending=accepted - delivered - abandoned,
        abandoned=abandoned,
        waiting=tuple(i for i in sorted(queued) if queued[i]) if still_ms > timeout_ms else (),
        still_ms=still_ms,
        timeout_ms=timeout_ms,
        others=any(_hears_others(told, i, stations == 1) for i in queued),
    )


def _hears_others(told: Mapping[int, Mapping[str, Any]], i: int, is_alone: bool) -> bool:
    """True if stations that run elsewhere are on the channel, as station i knows."""
    if "others" in told[i]:
        return not {one.get("number") for one in told.values()}.issuperset(told[i]["others"])
    paths = told[i].get("paths", ())
    return is_alone and any(path["heard_s"] is not None for path in paths)
