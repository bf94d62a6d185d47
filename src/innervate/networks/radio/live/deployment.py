"""Node files of a radio team's plan."""

from innervate.live.channel import SLOT_US, TURNAROUND_US
from innervate.live.deployment import Pairs, Table
from innervate.live.errors import LiveError
from innervate.live.on_channel import ChannelDeployment
from innervate.networks.radio.live.parameters import RADIO


class RadioDeployment(ChannelDeployment):
    """The stations of a team."""

    def layout(self) -> tuple[list[str], Pairs]:
        """Stations without cables.

        Raises:
            LiveError: they have another medium access protocol than live stations speak.
        """
        plan = self.plan
        if plan.protocol != "csma-cd-r/practical":
            raise LiveError(
                f"live stations speak practical CSMA/CD-R, not {plan.protocol}; "
                'set protocol.mac = "csma-cd-r" and protocol.mode = "practical"'
            )
        return [f"s{i}" for i in range(plan.stations)], []

    def slower(self) -> int:
        """Stations have slots of their own, and events are as fast as they are."""
        return 1

    def channel(self) -> tuple[int, int]:
        """The one that live stations are made for."""
        return SLOT_US, TURNAROUND_US

    def file(self, number: int, cables: list[int]) -> tuple[Table, dict[str, Table]]:
        """The scenario's turns, in slots that a PC can keep."""
        params = self.plan.params
        given = {name: params[name] for name in ("packet_slots", "turns", "per_turn")}
        wait_us = 2 * given["packet_slots"] * RADIO["slot_us"]
        return {"role": "station"}, {"protocol": {**given, "wait_us": wait_us}}
