"""Node files of a radio team's plan."""

from __future__ import annotations

from typing import Any

from innervate.live.deployment import Deployment, Pairs, Table
from innervate.live.errors import LiveError
from innervate.networks.radio.live.parameters import RADIO
from innervate.scenario.actions.channel import JOIN


class RadioDeployment(Deployment):
    """The stations of a team, on a channel that is a process of its own."""

    has_channel = True

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

    def check(self, cables: str, sealed: bool) -> None:
        """Refuse cables and sealing: stations share a channel."""
        if cables != "udp" or sealed:
            raise LiveError("stations share a channel: leave --pty, --netns and --sealed out")

    def file(self, number: int, cables: list[int]) -> tuple[Table, dict[str, Table]]:
        """The scenario's turns, in slots that a PC can keep."""
        params = self.plan.params
        given = {name: params[name] for name in ("packet_slots", "turns", "per_turn")}
        wait_us = 2 * given["packet_slots"] * RADIO["slot_us"]
        return {"role": "station"}, {"protocol": {**given, "wait_us": wait_us}}

    def word(self, fault: Any) -> str:
        """Who is switched on joins: its process is started, or started again."""
        return "join" if fault.action == JOIN else super().word(fault)

    def cable_of(self, fault: Any) -> int:
        """The cable that a fault is done to: -1, there are none."""
        return -1
