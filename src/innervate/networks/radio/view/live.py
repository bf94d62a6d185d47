"""A running radio team on the page: who sends, who has a packet, who is off the channel."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from innervate.analysis.headline import Headline
from innervate.networks.radio.analysis.headline import headline
from innervate.networks.radio.analysis.live import Still, of_stations
from innervate.web.live_map import Status
from innervate.web.live_state import State
from innervate.web.live_view import LiveView

QUEUE = 16
IDLE, SENDS, WAITS = 0, 1, 4  # what a station does, as pages count it


class RadioState(State):
    """What the stations of a team do."""

    noun = "station"
    is_off_when_cut = True
    still_ms = 0.0  # for how long stations that had a packet have delivered nothing

    def look(self) -> tuple[int, int, int]:
        """Everybody hears everybody, or nobody."""
        off = int(np.count_nonzero(self.node_up == 0))
        return off, 0, len(self.node_up) - off

    def judge(self) -> Headline:
        """The headline by what the stations say of their queues and packets."""
        places = self.map.places
        told = {at: self.told[p.node] for at, p in enumerate(places) if p.node in self.told}
        off = tuple(np.flatnonzero(self.node_up == 0).tolist())
        timing = next(iter(told.values()))["timing"]
        found = of_stations(told, len(places), off, self.still_ms, timing)
        return headline(found, self.map.names.__getitem__, absent="silent")

    def more(self) -> dict[str, Any]:
        """Load, what everybody does, whose turn is which."""
        places = self.map.places
        queued = [self.word(place, "queued", 0) for place in places]
        turn = [self.word(place, "place", None) for place in places]
        return {
            "load": (np.array(queued) / QUEUE).round(3),
            "radio": {
                "now": [
                    SENDS
                    if self.word(place, "radio", "") == "sending"
                    else WAITS
                    if count
                    else IDLE
                    for place, count in zip(places, queued, strict=True)
                ],
                "turn": [-1 if at is None else at for at in turn],
            },
        }


class RadioLiveView(LiveView):
    """A running team: who sends is soon another, and nobody has a way to lose."""

    state = RadioState
    lost = ("stations off", "")
    is_quick = True
    has_ways = False

    def __init__(self) -> None:
        self._still = Still()

    def note(self, state: State, now_us: int, told: Mapping[int, Status]) -> None:
        """Note for how long no station's count of packets has changed."""
        assert isinstance(state, RadioState)
        state.still_ms = self._still.note(now_us, told.values())
