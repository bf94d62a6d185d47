"""Node files of a plan whose nodes share a channel, which is a process of its own."""

from typing import Any

from innervate.live.channel import SLOT_US, SLOT_US_MIN, TURNAROUND_US
from innervate.live.deployment import Deployment, Pairs, Table
from innervate.live.errors import LiveError
from innervate.network import networks
from innervate.scenario.actions.channel import JOIN


class ChannelDeployment(Deployment):
    """Nodes without cables.

    Processes are slower than radios. A scenario with slots shorter than a PC keeps is slowed down:
    its slot is SLOT_US, and so many times as long is all that its parameters have in us.
    """

    has_channel = True

    def layout(self) -> tuple[list[str], Pairs]:
        """Nodes by number; LiveError if some do not hear each other."""
        if any(delay < 0 for row in self.plan.delays_us for delay in row):
            raise LiveError("live nodes on a channel all hear each other; leave hidden out")
        return [f"n{i}" for i in range(self.plan.nodes)], []

    def check(self, cables: str, sealed: bool) -> None:
        """Refuse cables and sealing: all share a channel."""
        if cables != "udp" or sealed:
            without = "--pty, --netns, --sealed and --identities"
            raise LiveError(f"nodes share a channel: leave {without} out")

    def slower(self) -> int:
        """How many times as long everything takes, between processes."""
        slot_us = int(self.plan.params["slot_us"])
        return 1 if slot_us >= SLOT_US_MIN else -(-SLOT_US // slot_us)

    def channel(self) -> tuple[int, int]:
        """A slot of the channel and its turnaround, us."""
        params, times = self.plan.params, self.slower()
        return params["slot_us"] * times, max(params["ta_us"] * times, TURNAROUND_US)

    def file(self, number: int, cables: list[int]) -> tuple[Table, dict[str, Table]]:
        """A node's parameters, those in us as much slower as the channel is.

        Raises:
            LiveError: one is then out of its range.
        """
        times, given = self.slower(), {}
        for name, _length, _low, high, unit, _ in networks()[self.plan.kind].fields.PARAMS:
            given[name] = self.plan.params[name] * (times if unit == "us" else 1)
            if given[name] > high:
                raise LiveError(
                    f"protocol.{name}: live slots are {times} times as long as air.slot_us, and "
                    f"{given[name]} us is beyond its range; raise its range, or give air.slot_us "
                    f"{SLOT_US_MIN} or more and times to match"
                )
        return {}, {"protocol": given}

    def word(self, fault: Any) -> str:
        """Who is switched on joins: its process is started, or started again."""
        return "join" if fault.action == JOIN else super().word(fault)

    def cable_of(self, fault: Any) -> int:
        """The cable that a fault is done to: -1, there are none."""
        return -1
