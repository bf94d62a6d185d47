"""The radio's chapter of `innervate demo`: ten robots start at once, and order themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from innervate.kernel.words import number_of
from innervate.plot.words import ms_words

if TYPE_CHECKING:
    from innervate.running import Run

SCENARIO = "radio-disaster"
INTRODUCTION = (
    "A team of robots on one radio channel, without a central station. All ten of them start",
    "to send at the same moment. Whoever sends hears nothing: nobody received anything.",
)
LOOK = "Look at it in a browser"
NEXT = (("innervate run radio-disaster --set protocol.mode=paper",
         "as published: order for four"),)  # fmt: skip


def lines(run: Run) -> list[str]:
    """What happened, line by line."""
    plan, packets = run.plan, run.result.packets
    start_us = int(packets["offered"].min())
    order = ", ".join(str(i) for i in run.radio["order"])
    steps = (
        (int(packets["end"].min()), "the first packet has arrived, everybody knows the order"),
        (int(packets["end"].max()), "all ten packets have arrived"),
    )
    took_ms = (plan.params["packet_slots"] * plan.params["slot_us"] * plan.stations) / 1e3
    lost = run.radio["lost_silently"]
    return [
        *(f"{'+' + ms_words((at_us - start_us) / 1e3):>10}   {what}" for at_us, what in steps),
        "",
        f"Order: {order}. {number_of(lost, 'packet')} lost without their sender knowing.",
        f"The packets alone take {ms_words(took_ms)}.",
    ]
